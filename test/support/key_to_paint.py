# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""From a key of the X server to what a widget paints."""
import ctypes
import random
import time

from python_qt_binding.QtCore import QEvent, QEventLoop, QObject
from python_qt_binding.QtWidgets import QApplication

# Of keysymdef.h.
SPACE, UP, SHIFT = 0x0020, 0xff52, 0xffe1
LONG_S = 60.0


class KeyToPaint(QObject):
    """Presses keys by the XTEST extension, and notes when a widget is painted.

    :param until: function (condition, what) that runs Qt until the condition is true
    """

    def __init__(self, until):
        super().__init__()
        self._until = until
        self._painted = 0.0
        self._is_drawn = None
        self._xlib, self._xtest = ctypes.CDLL('libX11.so.6'), ctypes.CDLL('libXtst.so.6')
        self._xlib.XOpenDisplay.restype = ctypes.c_void_p
        self._display = ctypes.c_void_p(self._xlib.XOpenDisplay(None))

    def eventFilter(self, watched, event):  # noqa: N802
        """Note when it is painted as wanted."""
        if event.type() == QEvent.Paint and not self._painted and self._is_drawn():
            # It is on the screen once its painting is done and sent.
            self._painted = time.monotonic()
        return False

    def send(self, down, *keys):
        """Press or release keys, given by their keysyms."""
        for key in keys if down else reversed(keys):
            self._xtest.XTestFakeKeyEvent(
                self._display, self._xlib.XKeysymToKeycode(self._display, ctypes.c_ulong(key)),
                int(down), ctypes.c_ulong(0))
        self._xlib.XFlush(self._display)

    def times(self, count, keys, widgets, is_drawn, restore):
        """Return how long each of some presses took until it was drawn [ms], sorted.

        :param widgets: one of them is painted then
        :param is_drawn: returns whether they show the press
        :param restore: called with the keys released: makes the next press possible
        """
        found, self._is_drawn = [], is_drawn
        for widget in widgets:
            widget.installEventFilter(self)
        for _ in range(count):
            # At any moment of what the screen does by itself.
            due = time.monotonic() + random.uniform(0.1, 0.3)
            self._until(lambda: time.monotonic() > due, 'the moment')
            self._painted = 0.0
            pressed = time.monotonic()
            self.send(True, *keys)
            # As the program's own loop does, without pauses between its turns.
            while not self._painted and time.monotonic() < pressed + LONG_S:
                QApplication.processEvents(QEventLoop.WaitForMoreEvents)
            assert self._painted, 'it was never painted'
            found.append(1e3 * (self._painted - pressed))
            self.send(False, *keys)
            restore()
        for widget in widgets:
            widget.removeEventFilter(self)
        return sorted(found)
