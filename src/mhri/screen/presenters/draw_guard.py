# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The guard of everything that draws: it logs failures once a second and shows them.

PyQt ends the program if an exception leaves a slot or an event handler, unless an ``excepthook``
is set (https://www.riverbankcomputing.com/static/Docs/PyQt5/incompatibilities.html).
A screen that draws badly must go on: its STOP ALL does not need the drawing.
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
    """Take note of an uncaught exception, e.g. from painting."""
    log_slips(kind, value, trace)
    for cover in list(_COVERS):
        try:
            cover.slipped('{}: {}'.format(kind.__name__, value))
        except RuntimeError:  # Qt has deleted it
            _COVERS.discard(cover)


def watch_slips():
    """Show uncaught exceptions on the screen, and log each once.

    Earlier hooks still run, except Python's own and pyqtgraph's, which print every exception:
    failing to paint would print thousands.
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
    """

    def __init__(self, window):
        self._name = window.objectName()
        self._logged_at = -math.inf
        self.cover = StaleCover(window)
        _COVERS.add(self.cover)
        watch_slips()

    def run(self, job, *args):
        """Draw; return whether it succeeded."""
        try:
            job(*args)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # the guard of this boundary: see the head of this file
            reason = '{}: {}'.format(type(error).__name__, error)
            self.cover.failed(reason)
            self._log(reason)
            return False
        self.cover.drawn()
        return True

    def _log(self, reason):
        """Log the present exception, unless one was logged just now."""
        now = time.monotonic()
        if now - self._logged_at >= LOG_EVERY_S:
            self._logged_at = now
            # Without rospy's own throttle, which needs a node: there may be none yet.
            rospy.logerr('cannot draw %s: %s\n%s', self._name, reason[:500],
                         traceback.format_exc(limit=-6)[-2000:])

    def end(self):
        """Stop drawing."""
        _COVERS.discard(self.cover)
        self.cover.end()
