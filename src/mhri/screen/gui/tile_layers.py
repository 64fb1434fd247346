# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The layers of a tile: the view that fills it, and header, switches, numbers, views over it."""
from python_qt_binding.QtCore import QPoint, QRect

from mhri.base.gui.page import WideScrollBar
from mhri.base.view_rows import CAMERAS, CORNER, PICTURES, STRIP
from mhri.screen import overlays
from mhri.screen.arrangement import CUT_LARGE, CUT_SMALL

EDGE_PX = 4
# Height of the numbers in a large and in a small tile [line heights].
_HUD_UNITS = (7.0, 4.0)
# If the switches leave less than this for the views [line heights], they take all the room.
_MIN_VIEW_UNITS = 7.0
# Share of the picture's height for the bar, and what it may have in any case [line heights].
_BAR_SHARE, _BAR_UNITS = 0.4, 2
# In narrower large tiles the robot's stop has no word [heights of the header].
_WORD_UNITS = 10.0


class TileLayers:
    """Places the layers; the tile calls it whenever its size or its views change.

    :param tile: :class:`mhri.screen.gui.robot_tile.RobotTile`
    """

    def __init__(self, tile):
        self._tile = tile
        # {view: place} of the visible views, '' for the one that fills the tile.
        self._places = {}
        tile.tools.setVerticalScrollBar(WideScrollBar(tile.tools))

    def fitting(self, chosen):
        """Return {view: place} of the chosen views that a large tile has room for."""
        tile = self._tile
        return overlays.fitting(chosen, (tile.width(), tile.height()),
                                tile.header.sizeHint().height(), EDGE_PX,
                                tile.fontMetrics().height())

    def show_views(self, places):
        """Show views at their places, as :meth:`fitting` returns them."""
        self._places = dict(places)
        for key, place in places.items():
            view = self._tile.view(key)
            if hasattr(view, 'show_strip'):
                view.show_strip(place == STRIP)
            if not place:
                view.lower()
        self.place()

    def _picture(self):
        """Return the widget with the picture that fills the tile, None without one."""
        key = overlays.filling(self._places)
        return self._tile.view(key).canvas if key in PICTURES else None

    def picture_area(self):
        """Return the :class:`QRect` of the picture in the tile; without one, the tile's inside."""
        tile, picture = self._tile, self._picture()
        if picture is None:
            foot = tile.stop_button.height() if tile.stop_button.isVisibleTo(tile) else 0
            return tile.rect().adjusted(EDGE_PX, EDGE_PX, -EDGE_PX, -EDGE_PX - foot)
        return picture.room().translated(picture.mapTo(tile, QPoint(0, 0)))

    def clear_area(self):
        """Return the :class:`QRect` over whose lower right something may lie.

        That is the picture below header and switches, beside the stop of a small tile. The strip
        leaves it free.
        """
        area, stop, header = self.picture_area(), self._tile.robot_stop, self._tile.header
        tools = self._tile.tools
        above = tools if tools.isVisibleTo(self._tile) else header
        area.setTop(max(area.top(), min(area.bottom(), above.geometry().bottom() + 1)))
        if not header.large and stop.isVisibleTo(self._tile):
            area.setRight(min(area.right(), stop.x() - 1))
        return area

    def place(self):
        """Reposition all layers."""
        tile, unit = self._tile, self._tile.fontMetrics().height()
        inside = tile.rect().adjusted(EDGE_PX, EDGE_PX, -EDGE_PX, -EDGE_PX)
        height = tile.header.sizeHint().height()
        stop = self._place_stop(inside, height)
        tile.header.setGeometry(inside.x(), inside.y(),
                                inside.width() - (stop if tile.header.large else 0), height)
        covered = self._fit_tools(inside.height() - height, unit)
        top = self._place_tools(inside, height)
        over = self._picture() is not None
        bar = self._place_bar(top, unit, covered)
        # Set once, as each change asks for a new layout.
        tile.tools_space.setFixedHeight(0 if over else bar + (
            tile.tools.height() if tile.tools.isVisibleTo(tile) else 0))
        shown = bool(self._places)
        tile.views_place.setVisible(shown and not covered)
        tile.motion_page.setVisible(not shown and tile.has_room() and not covered)
        tile.hud.setVisible(tile.has_room() and not covered and (
            self._picture() is not None or bool(tile.hud.sentence) or not tile.header.large))
        strip = self._place_filling(top)
        # Words end a line's height before their right end; what else lies there needs all of it.
        beside = 0 if tile.hud.clear_px else unit
        self._place_hud(top, unit, strip, 0 if tile.header.large else max(0, stop - beside))
        self._place_overlays(top, unit, strip)

    def _place_stop(self, inside, header_px):
        """Place the robot's stop: at the end of a large header, else in the lower right corner.

        :returns: its width, 0 if there is no room for it or nothing to stop
        """
        tile, stop = self._tile, self._tile.robot_stop
        large = tile.header.large
        stop.show_place(large, large and inside.width() > _WORD_UNITS * header_px)
        size = stop.sizeHint()
        if large:
            stop.setGeometry(inside.right() + 1 - size.width(), inside.y(), size.width(), header_px)
        else:
            stop.setGeometry(QRect(inside.bottomRight() - QPoint(size.width(), size.height())
                                   + QPoint(1, 1), size))
        fits = not stop.is_idle and (large or tile.has_room() and
                                     inside.width() >= 3 * size.width() and
                                     inside.height() - header_px >= size.height())
        stop.setVisible(fits)
        return size.width() if fits else 0

    def _fit_tools(self, body, unit):
        """Set the height of the switches, out of the height below the header [px].

        :returns: whether they take all of it, and scroll
        """
        tile = self._tile
        if not tile.tools.isVisibleTo(tile):
            return False
        body -= sum(part.sizeHint().height() for part in (tile.stop_button, tile.motion_place)
                    if part.isVisibleTo(tile))
        needed = tile.tools_page.heightForWidth(tile.width() - 2 * EDGE_PX)
        covered = body - needed < _MIN_VIEW_UNITS * unit
        tile.tools.setFixedHeight(max(1, body if covered else needed))
        return covered

    def _place_tools(self, inside, height):
        """Place the switches below the header; they lie over a picture, and move any other view.

        :param inside: :class:`QRect` of the tile inside its edge
        :param height: of the header [px]
        :returns: y of the highest uncovered line of the tile
        """
        tile, over = self._tile, self._picture() is not None
        lines = tile.motion_place.isVisibleTo(tile)
        tile.header_space.setFixedHeight(0 if over and not lines else height)
        tools = tile.tools.height() if tile.tools.isVisibleTo(tile) else 0
        top = inside.top() + height + (tile.motion_place.height() if lines else 0)
        tile.tools.setGeometry(inside.x(), top, inside.width(), max(1, tools))
        return top + tools

    def _place_bar(self, top, unit, covered):
        """Place the bar below header and switches; it moves any view but a picture.

        It covers neither the numbers, nor what lies at the right: stick, inset picture, corner.

        :param covered: whether the switches take all the room
        :returns: its height with a gap above and below it [px], 0 if it is hidden
        """
        tile, bar = self._tile, self._tile.bar
        if bar is None:
            return 0
        gap, room = unit // 2, self.picture_area()
        corner = self._sizes().get(CORNER, (0, 0))[0]
        right = max(tile.hud.clear_px, corner + gap if corner else 0)
        foot = tile.hud.numbers_height() + 2 * unit if self._picture() is not None else 0
        below = room.bottom() - top - 2 * gap
        high = bar.fit(QPoint(room.x() + gap, top + gap), room.width() - 2 * gap - right, min(
            below - foot, max(_BAR_UNITS * unit, round(_BAR_SHARE * below)))) \
            if tile.header.large and not covered else 0
        bar.setVisible(bool(high))
        bar.raise_()
        return high + 2 * gap if high else 0

    def _place_filling(self, top):
        """Place the view that fills the tile.

        :returns: height of the strip over its picture; 0 without one
        """
        tile, full = self._tile, overlays.filling(self._places)
        if full is None:
            return 0
        room, strip = tile.views_place.rect(), self._overlay(STRIP)
        if full not in PICTURES:
            if strip is not None:
                high = overlays.stacked(room.height())
                strip.setGeometry(room.adjusted(0, room.height() - high, 0, 0))
                room.adjust(0, 0, 0, -high)
            tile.view(full).setGeometry(room)
            return 0
        tile.view(full).setGeometry(room)
        # A hidden widget has not placed its parts yet.
        tile.view(full).layout().activate()
        if full in CAMERAS:
            self._picture().show_cut(CUT_LARGE if tile.header.large else CUT_SMALL)
        self._picture().keep_clear(max(0, top - tile.views_place.y()))
        return self._sizes().get(STRIP, (0, 0))[1] if strip is not None else 0

    def _overlay(self, place):
        """Return the view at a place, None without one."""
        return next((self._tile.view(key) for key, where in self._places.items()
                     if where == place), None)

    def _sizes(self):
        """Return {place: (width, height)} of the overlays.

        While the tile is being resized, one of them may be too large; it is hidden at once.
        """
        tile = self._tile
        return overlays.overlay_sizes(
            {place for place in self._places.values() if place}, (tile.width(), tile.height()),
            tile.header.sizeHint().height(), EDGE_PX, tile.fontMetrics().height())

    def _place_hud(self, top, unit, strip, clear):
        """Place numbers and sentence, with the strip between them.

        :param clear: width to leave free at the right [px]
        """
        tile, room = self._tile, self.picture_area()
        gap = strip + unit // 2 if strip else 0
        high = min(room.bottom() - top + 1,
                   round(_HUD_UNITS[0 if tile.header.large else 1] * unit) + gap)
        tile.hud.setGeometry(room.x(), room.bottom() + 1 - high,
                             room.width() - clear, max(1, high))
        tile.hud.show_strip(gap)

    def _place_overlays(self, top, unit, strip):
        """Place the views over the picture: the corner at the upper right, the strip below."""
        if self._picture() is None:
            return
        room = self.picture_area().translated(-self._tile.views_place.pos())
        top, sizes = top - self._tile.views_place.y(), self._sizes()
        if CORNER in sizes:
            wide, high = sizes[CORNER]
            self._overlay(CORNER).setGeometry(QRect(
                room.right() - wide - unit // 2, max(top, room.top()) + unit // 2, wide, high))
        if strip:
            wide, high = sizes[STRIP]
            # The scale of a depth picture is beside its room.
            wide -= self._tile.width() - 2 * EDGE_PX - room.width()
            wide = min(wide, room.width() - self._tile.hud.clear_px - unit)
            foot = room.bottom() + 1 - self._tile.hud.numbers_height()
            self._overlay(STRIP).setGeometry(room.left() + unit // 2, foot - high,
                                             max(1, wide), high)
