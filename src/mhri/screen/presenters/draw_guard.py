# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A guard around all drawing: it shows failures and logs them at most once a second.

PyQt ends the program if an exception leaves a slot or an event handler, unless an ``excepthook``
is set (https://www.riverbankcomputing.com/static/Docs/PyQt5/incompatibilities.html).
A screen that fails to draw must go on, because STOP ALL works without drawing.
"""
import math
import sys
import time
import traceback
import weakref

import rospy

from mhri.screen.gui.stale_cover import StaleCover
from mhri.screen.gui.window_maker import log_slips

LOG_EVERY_S = 1.0
_COVERS = weakref.WeakSet()


def _note_slip(kind, value, trace):
    """Log an uncaught exception, e.g. from painting, and show it on all covers."""
    log_slips(kind, value, trace)
    for cover in list(_COVERS):
        try:
            cover.slipped('{}: {}'.format(kind.__name__, value))
        except RuntimeError:  # deleted by Qt
            _COVERS.discard(cover)


def watch_slips():
    """Show uncaught exceptions on the screen, and log each once.

    Earlier hooks still run, except Python's own and pyqtgraph's: they print every exception, which
    would be thousands if painting fails.
    """
    before = sys.excepthook
    if getattr(before, 'of_mhri', False):
        return
    silent = before is sys.__excepthook__ or str(before.__module__).startswith('pyqtgraph')

    def hook(kind, value, trace):
        _note_slip(kind, value, trace)
        if not silent:
            before(kind, value, trace)
    hook.of_mhri = True
    sys.excepthook = hook


class DrawGuard:
    """Draws one window, and covers it while drawing fails.

    :param window: the window or widget that is drawn
    :param clear: a widget in it that works even so: the cover leaves it out
    """

    def __init__(self, window, clear=None):
        self._name = window.objectName()
        self._logged_at = -math.inf
        self.cover = StaleCover(window, clear=clear)
        _COVERS.add(self.cover)
        watch_slips()

    def run(self, job, *args):
        """Draw; return whether it succeeded."""
        try:
            job(*args)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # see the docstring of this module
            reason = '{}: {}'.format(type(error).__name__, error)
            self.cover.failed(reason)
            self._log(reason)
            return False
        self.cover.drawn()
        return True

    def _log(self, reason):
        """Log the current exception, at most once a second."""
        now = time.monotonic()
        if now - self._logged_at >= LOG_EVERY_S:
            self._logged_at = now
            # Not with rospy's throttle, which needs an initialised node.
            rospy.logerr('cannot draw %s: %s\n%s', self._name, reason[:500],
                         traceback.format_exc(limit=-6)[-2000:])

    def end(self):
        """Stop drawing."""
        _COVERS.discard(self.cover)
        self.cover.end()
