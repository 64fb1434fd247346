# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The guard of everything that draws: what fails is logged once a second, and said on the screen.

PyQt ends the program at an exception that leaves a slot or an event handler, unless somebody has
set an ``excepthook`` (https://www.riverbankcomputing.com/static/Docs/PyQt5/incompatibilities.html).
A screen that draws badly must go on: its STOP ALL does not need the drawing.
"""
import math
import sys
import time
import traceback
import weakref

import rospy

from mhri.gui.screen.stale_cover import StaleCover
from mhri.gui.screen.window_maker import log_slips

LOG_EVERY_S = 1.0
_COVERS = weakref.WeakSet()


def _note_slip(kind, value, trace):
    """Take note of an exception that nobody caught, as in a painting."""
    log_slips(kind, value, trace)
    for cover in list(_COVERS):
        try:
            cover.slipped('{}: {}'.format(kind.__name__, value))
        except RuntimeError:  # Qt has deleted it
            _COVERS.discard(cover)


def watch_slips():
    """Let exceptions that nobody caught be said on the screen, and logged once each.

    What was there before goes on, but for Python's own hook and pyqtgraph's, which print each one:
    a painting that fails would print thousands.
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
    """Draws one window, and covers it while that fails.

    :param window: the window or widget that is drawn
    """

    def __init__(self, window):
        self._name = window.objectName()
        self._logged_at = -math.inf
        self.cover = StaleCover(window)
        _COVERS.add(self.cover)
        watch_slips()

    def run(self, job, *args):
        """Draw; return whether that went well."""
        try:
            job(*args)
        except Exception as error:  # the guard of this boundary: see the head of this file
            reason = '{}: {}'.format(type(error).__name__, error)
            self.cover.failed(reason)
            self._log(reason)
            return False
        self.cover.drawn()
        return True

    def _log(self, reason):
        """Log the exception at hand, unless one has just been."""
        now = time.monotonic()
        if now - self._logged_at >= LOG_EVERY_S:
            self._logged_at = now
            # Without rospy's own throttle, which needs a node: there may be none yet.
            rospy.logerr('%s cannot be drawn: %s\n%s', self._name, reason[:500],
                         traceback.format_exc(limit=-6)[-2000:])

    def end(self):
        """Draw no more."""
        _COVERS.discard(self.cover)
        self.cover.end()
