# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A window around a tile that was torn off the screen, for a second monitor."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QVBoxLayout, QWidget

from mhri.base.gui.geometry import fitting
from mhri.driving.gui.drive_keys import mark_drive_area


class TornOff(QWidget):
    """Holds one tile; opening it never takes the keyboard away from what has it.

    Closing it by its frame is closing a robot's window: the owner stops driving that robot, and
    puts the tile back. Escape does not close it.

    :param tile: :class:`mhri.screen.gui.bot_window.BotWindow`
    """

    #: it was closed by its frame: name of its robot
    closed = Signal(str)

    def __init__(self, tile):
        super().__init__(None, Qt.Window)
        self.tile = tile
        self._build()

    def _build(self):
        """Take the tile in."""
        self.setObjectName('torn_off_' + self.tile.name)
        self.setWindowTitle('{} - mhri'.format(self.tile.name))
        self.setAttribute(Qt.WA_ShowWithoutActivating)
        mark_drive_area(self, self.tile.parentWidget())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        self.setPalette(self.tile.palette())
        self.setFont(self.tile.font())
        self.resize(fitting(self.tile.sizeHint()))
        column.addWidget(self.tile)
        self.tile.show_torn_off(True)
        self.tile.show_large(True)
        self.tile.show()

    def give_back(self):
        """Let the tile go; the window is of no more use."""
        self.tile.show_torn_off(False)
        self.tile.setParent(None)
        self.hide()
        self.deleteLater()

    def closeEvent(self, event):  # noqa: N802
        """Tell that the window closes."""
        event.accept()
        self.closed.emit(self.tile.name)
