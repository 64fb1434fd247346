# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The stage: the tiles of all robots, with pictures as large as possible."""
from collections import Counter

from python_qt_binding.QtCore import QPoint, QRect, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.driving.gui.drive_keys import mark_drive_area
from mhri.robots.gui.invitation import Invitation
from mhri.screen.arrangement import (
    arrange, AUTO, choose_inset, choose_large, MAP_TO_FILL, NO_MAP, USUAL_SHAPE, WITH_MAP)
from mhri.screen.gui.tile_cell import TileCell

# States of the map: shown on a wide screen and where the pictures leave room; hidden; beside the
# pictures; in their place.
MAP_AUTO, MAP_CLOSED, MAP_BESIDE, MAP_LARGE = 'auto', 'hidden', 'beside', 'large'
# From this width of the screen the map is beside the pictures if nothing else is chosen [px].
_MAP_FROM_PX = 1600
_GAP_PX = 4
# Comfortable size of a cell for its name and a recognisable picture [line heights].
_CELL_UNITS = (9.0, 6.5)
# Maximum share of the virtual joystick of its picture, as far as it stays usable.
_STICK_SHARE = 0.34
# Share of the width of that picture that it takes at most; else it is hidden.
_STICK_MOST = 0.67
# Share of the width of an inset picture, and its minimum size: the stick and words beside it.
_INSET_SHARE, _INSET_UNITS = 0.42, (15.0, 11.0)
# Height of the bottom line of the map [line heights].
_MAP_LINE_UNITS = 2.0


class Stage(QWidget):
    """Places tiles by :func:`mhri.screen.arrangement.arrange`; nothing on it scrolls.

    Each robot has a cell of a strip, where its tile is while it is not large; then a copy of its
    picture keeps the cell. While no driven robot is large, the tile of one is inset into the large
    picture or map, with the virtual joystick on it.

    It has the keyboard focus while the operator drives; Tab goes from picture to picture.
    """

    #: the shapes of the pictures, or the large tiles, changed
    rearranged = Signal()
    #: the map was shown, hidden, or swapped with the pictures
    map_changed = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._tiles = {}
        #: names of the robots whose tiles are large
        self.large = ()
        self._large_places = ()
        self._inset = ''
        self._cells = {}
        self._expected = ()
        self._shape = USUAL_SHAPE
        self._driven = ()
        #: name of the robot in view, '' if none
        self.looked_at = ''
        self._style = AUTO
        self._stick, self._stick_wanted = None, False
        self._map = None
        self._map_choice, self._map_large = MAP_AUTO, False
        #: whether the numbers over the pictures are shown
        self.numbers_shown = True
        self._build()

    def _build(self):
        """Set the fixed properties."""
        self.setObjectName('stage')
        self.setFocusPolicy(Qt.StrongFocus)
        self.setAccessibleName('Robots and their pictures')
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        mark_drive_area(self)
        #: shown while there are no tiles
        self.invitation = Invitation(self)

    @property
    def names(self):
        """The robots with tiles on the stage, in order."""
        return tuple(name for name, tile in self._tiles.items() if not tile.torn_off)

    def set_map(self, widget):
        """Add the map, a :class:`mhri.map.gui.map_pane.MapPane`; :meth:`show_map` shows it."""
        self._map = widget
        widget.setParent(self)
        widget.hide()
        widget.done.connect(self.setFocus)
        widget.swap_requested.connect(self.swap_map)

    @property
    def map_state(self):
        """MAP_LARGE, else what was chosen: MAP_AUTO, MAP_CLOSED or MAP_BESIDE."""
        return MAP_LARGE if self._map_large else self._map_choice

    @property
    def map_shown(self):
        """Whether the map has a place on the stage."""
        return self._map is not None and (
            self._map_large or self._arranged().the_map is not None)

    def show_map(self, state):
        """Show the map in one of its states; any other value is MAP_AUTO."""
        if self._map is None or state == self.map_state:
            return
        self._map_large = state == MAP_LARGE
        if not self._map_large:
            self._map_choice = state if state in (MAP_CLOSED, MAP_BESIDE) else MAP_AUTO
        self.refresh()
        self.map_changed.emit()

    def swap_map(self):
        """Swap map and pictures; a closed map is shown large."""
        self.show_map(self._map_choice if self._map_large else MAP_LARGE)

    def show_tiles(self, tiles, expected=None):
        """Show exactly these tiles: {name: :class:`RobotTile`}, in order.

        :param expected: names of current and upcoming tiles, in order, to reserve their places, so
            that new tiles do not move the others; None: as before
        """
        expected = self._expected if expected is None else tuple(expected)
        if list(tiles.items()) != list(self._tiles.items()) or expected != self._expected:
            self._tiles, self._expected = dict(tiles), expected
            for tile in tiles.values():
                if not tile.torn_off and tile.parentWidget() is not self:
                    tile.setParent(self)
            self.refresh()

    def show_driven(self, names):
        """Set the selected robots."""
        if tuple(names) != self._driven:
            self._driven = tuple(names)
            self.refresh()

    def look_at(self, name):
        """Show this robot large; '' shows the driven robots large."""
        if name != self.looked_at:
            self.looked_at = name
            self.refresh()

    def set_style(self, style):
        """Choose the layout of tiles: AUTO, ONE or ALIKE of the arrangement."""
        if style != self._style:
            self._style = style
            self.refresh()

    def next_name(self, steps=1):
        """Return the name of the robot after the one in view, '' without robots."""
        names = self.names
        if not names:
            return ''
        now = self.looked_at if self.looked_at in names else next(iter(self.large), names[0])
        return names[(names.index(now) + steps) % len(names)]

    def show_numbers(self, shown):
        """Show or hide the numbers over the pictures."""
        self.numbers_shown = shown
        for tile in self._tiles.values():
            tile.show_hud(shown)

    def refresh(self):
        """Rearrange the tiles after one was added, removed, torn off, or changed its shape."""
        self._large_places = choose_large(self._places(), self._driven, self.looked_at,
                                          self._style)
        self.large = tuple(name for name in self._large_places if name in self._tiles)
        self._inset = choose_inset(self.names, self._driven, () if self._map_large else self.large)
        if self._map_large and len(self._places()) == 1:
            # It has no cell.
            self._inset = next(iter(self.large), '')
        self._shape = self._shape_now()
        for name, tile in self._tiles.items():
            tile.show_hud(self.numbers_shown)
        self._mark()
        self._place()
        self.rearranged.emit()

    def _mark(self):
        """Mark the tile in view, else, with the keyboard focus, the one that Enter would drive."""
        marked = self.looked_at or (next(iter(self.large), '') if self.hasFocus() else '')
        for name, tile in self._tiles.items():
            tile.show_looked_at(name == marked)
            if name == marked:
                tile.update()
        for cell in self._cells.values():
            cell.update()

    def focusInEvent(self, event):  # noqa: N802
        """Show the keyboard focus."""
        super().focusInEvent(event)
        self._mark()

    def focusOutEvent(self, event):  # noqa: N802
        """Show the loss of the keyboard focus."""
        super().focusOutEvent(event)
        self._mark()

    def watch_shapes(self):
        """Rearrange the tiles if the shape of most pictures has changed."""
        if self._shape_now() != self._shape:
            self.refresh()

    def _shape_now(self):
        """Return the shape of most pictures."""
        shapes = Counter(round(tile.picture_shape(), 2) for tile in self._tiles.values())
        return max(shapes, key=lambda shape: (shapes[shape], shape)) if shapes else USUAL_SHAPE

    def _places(self):
        """Return the robots that may be large, in order: current and upcoming tiles."""
        names = self.names
        if not names:
            return ()
        places = [name for name in self._expected if name in names or name not in self._tiles]
        return (*places, *(name for name in names if name not in places))

    def _in_strip(self):
        """Return the robots with a cell, in order; none if all are large."""
        places = [*self._expected, *(name for name in self._tiles if name not in self._expected)]
        return places if len(places) > len(self._large_places) or (
            self._map_large and len(places) > 1) else []

    def _arranged(self):
        """Return the arrangement for the current size."""
        unit = self.fontMetrics().height()
        whole = self.parentWidget() or self
        the_map = NO_MAP if self._map is None or self._map_choice == MAP_CLOSED else \
            WITH_MAP if self._map_choice == MAP_BESIDE or whole.width() >= _MAP_FROM_PX else \
            MAP_TO_FILL
        return arrange(self.width(), self.height(), len(self._large_places),
                       len(self._in_strip()), self._shape,
                       tuple(round(units * unit) for units in _CELL_UNITS), _GAP_PX, the_map)

    def _place(self):
        """Set the geometry of each tile, cell and of the map."""
        self.invitation.setVisible(not self._tiles)
        self.invitation.setGeometry(self.rect())
        found = self._arranged()
        places = {} if self._map_large else dict(zip(self._large_places, found.large))
        large = set(places)
        the_map = found.room if self._map_large else found.the_map
        self._show_map(the_map if self._tiles else None)
        left = self._left_by_map(found)
        shown = self._inset or (next(iter(self.large), '') if left else '')
        if shown:
            places[shown] = left or self._inset_box(
                the_map if self._map_large else found.large[0] if found.large else found.room)
        if self._map is not None:
            self._map.view.keep_clear(self._over_map(places.get(shown) if not left else None))
        cells = dict(zip(self._in_strip(), found.cells))
        for name, tile in self._tiles.items():
            if not tile.torn_off:
                self._place_tile(tile, places.get(name, cells.get(name)), name in large)
        self._place_cells({name: box for name, box in cells.items() if name in self._tiles and (
            name in places or self._tiles[name].torn_off)})
        if self._inset:
            self._tiles[self._inset].raise_()
        self.place_stick()

    def _over_map(self, place):
        """Return (width, height) of the lower right of the large map from an inset on, else 0.

        Half of a robot's mark, and its name, have room beside the inset.
        """
        if not self._map_large or place is None:
            return 0, 0
        whole, place, beside = self._map.geometry(), _rect(place), 2 * self.fontMetrics().height()
        return whole.right() + beside - place.left(), whole.bottom() + beside - place.top()

    def _left_by_map(self, found):
        """Return the box at the end of the strip that a large map has left, None for none."""
        box = found.the_map
        return box if self._map_large and box and not _rect(found.room).contains(_rect(box)) \
            else None

    def _place_tile(self, tile, box, large):
        """Show a tile in a box, None for nowhere."""
        tile.full_rate = tile.name in self._large_places or tile.name == self._inset
        tile.setVisible(box is not None)
        if box is not None:
            tile.show_large(large)
            tile.setGeometry(_rect(box))

    def _show_map(self, box):
        """Show the map in a box, None for nowhere."""
        if self._map is None:
            return
        self._map.setVisible(box is not None)
        if box is not None:
            self._map.show_large(self._map_large)
            self._map.setGeometry(_rect(box))

    def _place_cells(self, boxes):
        """Show {robot: box} of the cells whose tiles are elsewhere, and no others."""
        for name in [name for name, cell in self._cells.items()
                     if cell.tile is not self._tiles.get(name)]:
            self._cells.pop(name).deleteLater()
        for name in set(boxes) - set(self._cells):
            self._cells[name] = TileCell(self._tiles[name], self)
        for name, cell in self._cells.items():
            cell.setVisible(name in boxes)
            if name in boxes:
                cell.setGeometry(_rect(boxes[name]))

    def _inset_box(self, box):
        """Return the place of the inset picture: the lower right of a large one."""
        unit, whole = self.fontMetrics().height(), _rect(box)
        width = max(_INSET_SHARE * box.width, _INSET_UNITS[0] * unit)
        width = round(min(width, box.width))
        height = min(round(max(width / self._shape, _INSET_UNITS[1] * unit)), box.height)
        place = QRect(whole.right() + 1 - width, whole.bottom() + 1 - height, width, height)
        if self._map_large:
            place.translate(0, -round(_MAP_LINE_UNITS * unit))
            place = self._map.clear_of_buttons(place.translated(-self._map.pos())).translated(
                self._map.pos())
        return place.intersected(whole)

    def set_stick(self, stick):
        """Add the virtual joystick, a :class:`VirtualJoystick`; :meth:`show_stick` shows it."""
        self._stick = stick
        stick.hide()

    def show_stick(self, wanted):
        """Show the virtual joystick on the picture of the robots that it drives, if any."""
        self._stick_wanted = wanted
        self.place_stick()

    def place_stick(self):
        """Place the stick at the lower right of a driven picture, clear of its text.

        A hidden stick returns to neutral; one that is dragged keeps its place. Beside a drawer that
        leaves no room for it, it is hidden: keys drive.
        """
        names, unit = self._driven, self.fontMetrics().height()
        under = self._under_stick()
        box = self._stick_box(under)
        room = self if under is None else under
        shown = bool(self._stick_wanted and names and self._tiles and self.rect().contains(box)
                     and box.width() <= _STICK_MOST * room.width()
                     and not (under and box.intersects(under.name_area().translated(under.pos()))))
        if not shown or not self._stick.dragging:
            self._stick.show_names(names)
            self._stick.setGeometry(box)
            self._stick.setVisible(shown)
            self._stick.raise_()
        inset = self._tiles.get(self._inset)
        for name, tile in self._tiles.items():
            beside = self._stick if shown and tile is under else inset \
                if not self._map_large and name in self.large else None
            tile.keep_clear(beside.width() + unit // 2 if beside else 0)

    def _stick_box(self, tile):
        """Return the place of the stick on a tile, None for the stage."""
        room = self.rect() if tile is None else tile.clear_area().translated(tile.pos())
        gap = self.fontMetrics().height() // 2
        least = self._stick.least_size(
            QSize(int(_STICK_MOST * room.width()), room.height() - 2 * gap))
        side = self._stick.sizeHint().boundedTo(room.size() * _STICK_SHARE).expandedTo(least)
        box = QRect(QPoint(room.right() - side.width() - gap, room.bottom() - side.height() - gap),
                    side)
        stop = tile.robot_stop.geometry().translated(tile.pos()) if tile else QRect()
        if box.intersects(stop):
            # There is no room below the header.
            box.moveRight(stop.left() - gap)
        return box

    def _under_stick(self):
        """Return the tile under the stick, the last driven one with room for it; None for none."""
        tiles = [self._tiles[name] for name in ((self._inset,) if self._inset else self.large)
                 if name in self._driven]
        needed = self._stick.minimumSizeHint().height()
        return max(tiles, default=None, key=lambda tile: (
            min(needed, tile.clear_area().height()), tiles.index(tile)))

    def resizeEvent(self, event):  # noqa: N802
        """Rearrange everything for the new size."""
        super().resizeEvent(event)
        self._place()

    def paintEvent(self, event):  # noqa: N802
        """Paint the background between the tiles, dark in every theme, as beside a picture."""
        if self._tiles:
            QPainter(self).fillRect(self.rect(), theme.PICTURE_GROUND)


def _rect(box):
    """Convert a box of the arrangement, or a :class:`QRect`, to a :class:`QRect`."""
    return box if isinstance(box, QRect) else QRect(box.x, box.y, box.width, box.height)
