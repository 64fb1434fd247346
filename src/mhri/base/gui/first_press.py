# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whose robot a series of quick clicks is for: the one under the first of them.

The first click may rearrange what is on the screen, so that the second lands on another robot. All
tiles and rows share the one memory here, as they share the pointer.
"""
from python_qt_binding.QtCore import QPoint
from python_qt_binding.QtWidgets import QApplication

_NOBODY = ''
# Qt's own distance for a double click [px].
_NEAR_PX = 5


class FirstPress:
    """Remembers the robot that had the first press of a series at one place.

    Qt calls a press the second of a double click if it follows the first at once and at the same
    place of the window, whatever is there by then.
    """

    def __init__(self):
        self._name = _NOBODY
        self._at_ms = 0
        self._place = QPoint()

    def of(self, name, event):
        """Return the robot that a press is for: its own, or that of the press before it.

        :param name: the robot that is under the pointer now, '' for none
        :param event: the ``QMouseEvent``
        """
        if not self._goes_on(event):
            self._name = name
        self._at_ms, self._place = event.timestamp(), event.globalPos()
        return self._name

    def of_double_click(self, event):
        """Return the robot that a double click is for; '' where its first press was on none."""
        return self.of(_NOBODY, event)

    def _goes_on(self, event):
        """Tell whether a press follows the one before at once, and at the same place."""
        moved = event.globalPos() - self._place
        return 0 <= event.timestamp() - self._at_ms <= QApplication.doubleClickInterval() and \
            max(abs(moved.x()), abs(moved.y())) <= _NEAR_PX


first_press = FirstPress()
