# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What lies over the picture of a tile, and where: header, numbers, a small view in a corner."""
from python_qt_binding.QtCore import QPoint, QRect

from mhri.base.gui.wide_scroll_bar import WideScrollBar
from mhri.base.view_rows import PICTURES, SCAN

EDGE_PX = 4
# Heights of a line that the numbers may take, in a large tile and in a small one.
_HUD_UNITS = (7.0, 4.0)
# The small view takes this part of the picture, but never less than so many heights of a line.
_INSET_SHARE, _INSET_UNITS = 0.36, 9.0
# Where the switches leave less than this for the views [heights of a line], they have all of it.
_LEAST_VIEW_UNITS = 7.0


def wants_inset(shown):
    """Tell whether the scan lies in a corner of the picture: where that is all there is beside it.

    :param shown: set of the views on show
    """
    return SCAN in shown and bool(shown & PICTURES) and shown <= PICTURES | {SCAN}


class TileLayers:
    """Places them; the tile asks for it whenever it has another size or shows something else.

    :param tile: :class:`mhri.screen.gui.bot_window.BotWindow`
    """

    def __init__(self, tile):
        self._tile = tile
        self._inset = None
        tile.tools.setVerticalScrollBar(WideScrollBar(tile.tools))

    def take_inset(self, widget, wanted):
        """Have a view in the corner, or give it back to its place among the others.

        :returns: whether the tile has to put it back there
        """
        if wanted and self._inset is None:
            widget.setParent(self._tile)
            # Over the picture, and under what says that it is old.
            widget.stackUnder(self._tile.header)
            widget.show()
            self._inset = widget
        elif not wanted and self._inset is not None:
            self._inset = None
            return True
        return False

    def picture_area(self):
        """Return where the picture is in the tile, a :class:`QRect`; without one, its inside."""
        tile, shown = self._tile, self._tile.shown() & PICTURES
        if not shown:
            foot = tile.stop_button.height() if tile.stop_button.isVisibleTo(tile) else 0
            return tile.rect().adjusted(EDGE_PX, EDGE_PX, -EDGE_PX, -EDGE_PX - foot)
        picture = tile.view(next(iter(shown))).picture
        return QRect(picture.mapTo(tile, QPoint(0, 0)), picture.size())

    def _covers_picture(self):
        """Tell whether the header lies on the picture: where that is all there is."""
        tile, shown = self._tile, self._tile.shown()
        return bool(shown & PICTURES) and (shown <= PICTURES or wants_inset(shown)) and not (
            tile.tools.isVisibleTo(tile) or tile.motion_place.isVisibleTo(tile))

    def place(self):
        """Place everything anew."""
        tile, unit = self._tile, self._tile.fontMetrics().height()
        large, picture = tile.header.large, bool(tile.shown() & PICTURES)
        inside = tile.rect().adjusted(EDGE_PX, EDGE_PX, -EDGE_PX, -EDGE_PX)
        height = tile.header.sizeHint().height()
        tile.header.setGeometry(inside.x(), inside.y(), inside.width(), height)
        on_picture = self._covers_picture()
        tile.header_space.setFixedHeight(0 if on_picture else height)
        for key in tile.shown() & PICTURES:
            tile.view(key).picture.keep_clear(height if on_picture else 0)
        covered = self._fit_tools(inside.height() - height, unit)
        tile.views_splitter.setVisible(bool(tile.shown()) and not covered)
        tile.motion_page.setVisible(not tile.shown() and tile.has_room() and not covered)
        tile.hud.setVisible(tile.has_room() and not covered and (
            picture or bool(tile.hud.sentence) or not large))
        room = self.picture_area()
        top = inside.top() + height + (tile.tools.height() if tile.tools.isVisibleTo(tile) else 0)
        high = min(room.bottom() - top + 1, round(_HUD_UNITS[0 if large else 1] * unit))
        tile.hud.setGeometry(room.x(), room.bottom() + 1 - high, room.width(), max(1, high))
        if self._inset is not None and wants_inset(tile.shown()):
            self._inset.setVisible(not covered)
            self._place_inset(room, max(room.top(), top), unit)

    def _fit_tools(self, body, unit):
        """Give the switches the height they need, of that [px] below the header.

        :returns: whether they have all of it, and scroll
        """
        tile = self._tile
        if not tile.tools.isVisibleTo(tile):
            return False
        body -= sum(part.sizeHint().height() for part in (tile.stop_button, tile.motion_place)
                    if part.isVisibleTo(tile))
        needed = tile.tools_page.heightForWidth(tile.width() - 2 * EDGE_PX)
        covered = body - needed < _LEAST_VIEW_UNITS * unit
        tile.tools.setFixedHeight(max(1, body if covered else needed))
        return covered

    def _place_inset(self, room, top, unit):
        """Place the small view at the upper right: numbers and stick are at the lower end."""
        side = round(max(_INSET_SHARE * min(room.width(), room.height()), _INSET_UNITS * unit))
        self._inset.setGeometry(room.right() - side - unit // 2, top + unit // 2, side, side)
