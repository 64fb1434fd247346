# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated mouse, keyboard and stick of a scripted drive, with retries."""
import math
import time

from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QKeyEvent, QMouseEvent
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.reasons import JOINING, Reason

# Endings of the status line.
CENTRE, READY = Reason(JOINING).what, 'ready'
# After how long an operator grabs again what has no effect [s].
AGAIN_S = 1.0


class DemoFailed(Exception):
    """A step did not succeed in time; the text names it."""


class Hands:
    """A simulated mouse and keyboard: events as the window system sends them.

    :param panel: :class:`mhri.screen.gui.screen.ScreenWidget`
    """

    def __init__(self, panel):
        self._panel = panel

    def widget(self, name, window=None):
        """Return a widget of the panel, or of another window, by its object name.

        :raises DemoFailed: no widget has this name
        """
        found = (window or self._panel).findChild(QWidget, name)
        if found is None:
            raise DemoFailed('there is no visible {}'.format(name))
        return found

    def click(self, name, window=None):
        """Press and release the left button in the middle of a widget."""
        widget = self.widget(name, window)
        point = widget.rect().center()
        self._mouse(widget, QEvent.MouseButtonPress, point, Qt.LeftButton)
        self._mouse(widget, QEvent.MouseButtonRelease, point, Qt.NoButton)

    def hold_stick(self, forward, turn):
        """Grab the virtual joystick and hold it at fractions in [-1, 1]."""
        stick = self.widget('joystick')
        centre = stick.pad().center().toPoint()
        travel = stick.travel()
        target = centre + QPoint(round(-turn * travel), round(-forward * travel))
        self._mouse(stick, QEvent.MouseButtonPress, centre, Qt.LeftButton)
        self._mouse(stick, QEvent.MouseMove, target, Qt.LeftButton)

    def let_go(self):
        """Release the virtual joystick."""
        stick = self.widget('joystick')
        self._mouse(stick, QEvent.MouseButtonRelease, stick.rect().center(), Qt.NoButton)

    def press_stop_keys(self):
        """Press Shift and the space bar."""
        self.press(Qt.Key_Space, ' ', Qt.ShiftModifier)

    def press(self, key, text, modifiers=Qt.NoModifier):
        """Press and release a key."""
        for kind in (QEvent.KeyPress, QEvent.KeyRelease):
            QApplication.sendEvent(self._panel, QKeyEvent(kind, key, modifiers, text))

    def tap(self, view, x_m, y_m):
        """Click at a position of the map.

        :param view: :class:`mhri.map.gui.map_canvas.MapCanvas`
        """
        point = QPoint(*map(round, view.canvas.pixel(x_m, y_m)))
        self._mouse(view, QEvent.MouseButtonPress, point, Qt.LeftButton)
        self._mouse(view, QEvent.MouseButtonRelease, point, Qt.NoButton)

    @staticmethod
    def _mouse(widget, kind, point, buttons):
        button = Qt.NoButton if kind == QEvent.MouseMove else Qt.LeftButton
        where = QPointF(point)
        QApplication.sendEvent(widget, QMouseEvent(
            kind, where, QPointF(widget.mapToGlobal(point)), button, buttons, Qt.NoModifier))


class Grip:
    """Holds something (stick or key) until a condition is true.

    If the mux requires a centred stick meanwhile (a computer that stalled for half a second looks
    like a silent source), it releases the stick and grabs it again, as an operator would. It also
    does so if the mux has been ready for a second and nothing has come of it: the screen centres
    the stick when the drive has been restarted.

    :param take: function that grabs it
    :param let_go: function that releases it
    :param status: function that returns the panel's status line
    :param condition: function that returns whether to stop waiting
    :param clock: seconds, monotonic
    """

    def __init__(self, take, let_go, status, condition, clock=time.monotonic):
        self._take = take
        self._let_go = let_go
        self._status = status
        self._condition = condition
        self._clock = clock
        self._held = None
        # When it was grabbed, or the mux was last not ready.
        self._since_s = -math.inf
        #: how often it was grabbed
        self.times = 0

    def __call__(self):
        """Look, and return whether the condition is true."""
        if self._held is None:
            self._grab()
        if self._condition():
            return True
        status = self._status()
        if not status.endswith(READY):
            self._since_s = self._clock()
        if self._held and (status.endswith(CENTRE) or self._clock() - self._since_s > AGAIN_S):
            self._held = False
            self._let_go()
        elif not self._held and status.endswith(READY):
            self._grab()
        return False

    def _grab(self):
        self._held = True
        self._since_s = self._clock()
        self.times += 1
        self._take()


class Errand:
    """Repeats an action at intervals until a condition is true.

    :param act: function that performs the action
    :param condition: function that returns whether to stop
    :param again_s: interval after which an operator would try again [s]
    :param ready: function that returns whether the action can be performed now
    """

    def __init__(self, act, condition, again_s=5.0, ready=lambda: True):
        self._act = act
        self._condition = condition
        self._again_s = again_s
        self._ready = ready
        self._done_s = -math.inf
        #: how often it was performed
        self.times = 0

    def __call__(self):
        """Look, and return whether the condition is true."""
        if self._condition():
            return True
        if time.monotonic() - self._done_s > self._again_s and self._ready():
            self._done_s = time.monotonic()
            self.times += 1
            self._act()
        return False
