# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Turns a robot's head: a drag in its picture with the middle button."""
from python_qt_binding.QtCore import QEvent, QObject, Qt, Signal

from mhri.accessories.controls import drag_share
from mhri.driving.gui.hold_limit import HoldLimit
from mhri.driving.gui.spring_pad import is_lost


class LookDrag(QObject):
    """Follows the middle button in the picture of a tile, without taking any event.

    :param tile: :class:`mhri.screen.gui.robot_tile.RobotTile`
    """

    #: the head is held: (left +, up +) from -1 to 1; zeros once it is released
    held = Signal(tuple)
    #: it was released since no events came from the remote display
    ran_out = Signal()

    def __init__(self, tile):
        super().__init__(tile)
        self._tile = tile
        self._start = self._view = None
        self._next = None
        self.limit = HoldLimit(self)
        self.limit.ran_out.connect(self._run_out)
        tile.installEventFilter(self)

    def show_head(self, view):
        """Set the :class:`AccessoryView` of the head, None without one that obeys."""
        self._next = view
        if view is None:
            self.release()

    def _run_out(self):
        self.release()
        self.ran_out.emit()

    def release(self):
        """Release the head; the button has to be pressed again."""
        self.limit.end()
        if self._start is not None:
            self._start = None
            self.held.emit((0.0, 0.0))

    def eventFilter(self, watched, event):  # noqa: N802
        """Follow the pointer."""
        kind = event.type()
        if kind == QEvent.MouseButtonPress and event.button() == Qt.MiddleButton:
            if self._next is not None and self._tile.picture_area().contains(event.pos()):
                self._start, self._view = event.pos(), self._next
        elif kind == QEvent.MouseButtonRelease and event.button() == Qt.MiddleButton \
                or is_lost(watched, event):
            self.release()
        elif kind == QEvent.MouseMove and self._start is not None:
            self._follow(event)
        return False

    def _follow(self, event):
        """Hold the head where the pointer is."""
        self.limit.renew()
        moved, room = event.pos() - self._start, self._tile.picture_area()
        self.held.emit(drag_share(self._view, -2.0 * moved.x() / max(1, room.width()),
                                  -2.0 * moved.y() / max(1, room.height())))
