# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A window around a torn-off tile, for a second monitor."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui.geometry import fitting
from mhri.base.gui.layouts import in_column, TIGHT
from mhri.driving.gui.drive_keys import mark_drive_area


class TornOff(QWidget):
    """The window of one tile; opening it never takes the keyboard focus.

    If the user closes it, the owner stops driving that robot and puts the tile back. Escape does
    not close it.

    :param tile: :class:`mhri.screen.gui.robot_tile.RobotTile`
    """

    #: the user closed the window: name of its robot
    closed = Signal(str)

    def __init__(self, tile):
        super().__init__(None, Qt.Window)
        self.tile = tile
        self._build()

    def _build(self):
        """Move the tile into the window."""
        self.setObjectName('torn_off_' + self.tile.name)
        self.setWindowTitle('{} - mhri'.format(self.tile.name))
        self.setAttribute(Qt.WA_ShowWithoutActivating)
        mark_drive_area(self, self.tile.parentWidget())
        self.setPalette(self.tile.palette())
        self.setFont(self.tile.font())
        self.resize(fitting(self.tile.sizeHint()))
        in_column(self.tile, of=self, margins=TIGHT)
        self.tile.show_torn_off(True)
        self.tile.show_large(True)
        self.tile.show()

    def give_back(self):
        """Release the tile and delete the window."""
        self.tile.show_torn_off(False)
        self.tile.setParent(None)
        self.hide()
        self.deleteLater()

    def closeEvent(self, event):  # noqa: N802
        """Emit ``closed``."""
        event.accept()
        self.closed.emit(self.tile.name)
