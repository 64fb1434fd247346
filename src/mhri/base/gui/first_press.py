# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The target robot of a series of quick clicks: the one under the first click.

The first click may rearrange the screen, so that the second lands on another robot. All tiles and
rows share one memory here, as they share the pointer.
"""
from python_qt_binding.QtCore import QPoint
from python_qt_binding.QtWidgets import QApplication

_NOBODY = ''
# Qt's own distance for a double click [px].
_NEAR_PX = 5


class FirstPress:
    """Stores the robot that received the first press of a series at one position.

    Qt treats a press as the second of a double click if it quickly follows the first at the same
    position of the window, whichever widget is there by then.
    """

    def __init__(self):
        self._name = _NOBODY
        self._at_ms = 0
        self._place = QPoint()

    def of(self, name, event):
        """Return the target robot of a press: its own, or that of the previous press.

        :param name: the robot under the pointer now, '' for none
        :param event: the ``QMouseEvent``
        """
        if not self._goes_on(event):
            self._name = name
        self._at_ms, self._place = event.timestamp(), event.globalPos()
        return self._name

    def of_double_click(self, event):
        """Return the target robot of a double click, '' if its first press was on none."""
        return self.of(_NOBODY, event)

    def _goes_on(self, event):
        """Return whether a press quickly follows the previous one at the same position."""
        moved = event.globalPos() - self._place
        return 0 <= event.timestamp() - self._at_ms <= QApplication.doubleClickInterval() and \
            max(abs(moved.x()), abs(moved.y())) <= _NEAR_PX


first_press = FirstPress()
