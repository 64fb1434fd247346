# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The cell of a robot in the strip, while its tile is elsewhere: large, inset, torn off."""
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.labels import TextLine
from mhri.base.gui.layouts import in_column, in_row
from mhri.base.gui.pending import Pace
from mhri.base.gui.robot_sign import RobotNumber
from mhri.base.view_rows import RGB
from mhri.screen.arrangement import CUT_SMALL
from mhri.screen.gui.tile_layers import EDGE_PX


class TileCell(QWidget):
    """Number, name and edge of a tile with a copy of its picture, at most four times a second.

    A click on it is a click on its tile.

    :param tile: :class:`mhri.screen.gui.robot_tile.RobotTile`
    """

    def __init__(self, tile, parent=None):
        super().__init__(parent)
        self.tile = tile
        self._picture = tile.view(RGB).picture
        self._pace = Pace()
        self.setObjectName('cell_' + tile.name)
        self.setAccessibleName('{} in the strip'.format(tile.name))
        self.setAttribute(Qt.WA_OpaquePaintEvent)
        self.setFont(tile.font())
        self._name, self._number = TextLine(self), RobotNumber(self)
        self._name.show_text(tile.name, shorter=(*words.name_ends(tile.name), ''))
        self.setPalette(theme.over_picture(self.palette()))
        gap = self.fontMetrics().height() // 3
        for part in (self._name, self._number):
            part.setFont(theme.larger(theme.base_font(self.font()), theme.BODY, bold=True))
            part.setAttribute(Qt.WA_TransparentForMouseEvents)
        in_column(in_row(self._number, (self._name, 1), gap=gap), 1, of=self, margins=(
            EDGE_PX + gap, EDGE_PX + 2, EDGE_PX + gap, EDGE_PX))
        for part in (tile, self._picture):
            part.installEventFilter(self)

    def eventFilter(self, watched, event):  # noqa: N802
        """Follow what the tile shows."""
        if event.type() == QEvent.Paint and self.isVisible() and (
                watched is self.tile or self._pace.due()):
            self._show_number()
            self.update()
        return False

    def _show_number(self):
        """Show the number of the tile."""
        self._number.show_number(int(self.tile.header.number_label.text() or 0))

    def showEvent(self, event):  # noqa: N802
        """Begin with what the tile shows."""
        super().showEvent(event)
        self._show_number()

    def mousePressEvent(self, event):  # noqa: N802
        """Click the tile."""
        self.tile.mousePressEvent(event)

    def mouseDoubleClickEvent(self, event):  # noqa: N802
        """Double-click the tile."""
        self.tile.mouseDoubleClickEvent(event)

    def contextMenuEvent(self, event):  # noqa: N802
        """Open the menu of the tile."""
        self.tile.contextMenuEvent(event)

    def paintEvent(self, event):  # noqa: N802
        """Paint picture, number, name and edge."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), theme.PICTURE_GROUND)
        inside = self.rect().adjusted(EDGE_PX, EDGE_PX, -EDGE_PX, -EDGE_PX)
        self._picture.paint_copy(painter, inside, CUT_SMALL)
        head_px = self._name.sizeHint().height() + theme.GRID
        painter.fillRect(inside.adjusted(0, 0, 0, min(0, head_px - inside.height())),
                         theme.OVER_PICTURE)
        self.tile.paint_edges(painter, self.rect())
