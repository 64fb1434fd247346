# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The stage: the tiles of all robots, the pictures as large as they can be."""
from python_qt_binding.QtCore import QRect, Qt, Signal
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.driving.gui.drive_keys import mark_drive_area
from mhri.robots.gui.invitation import Invitation
from mhri.screen.arrangement import arrange, AUTO, choose_large, USUAL_SHAPE

# The map is not on show; is a small tile where there is room for one; is the large tile.
MAP_CLOSED, MAP_BESIDE, MAP_LARGE = 'closed', 'beside', 'large'
# Beside the pictures it has room on a stage of this size [heights of a line]; else it is behind M.
_MAP_UNITS = (78.0, 38.0)
# Large on a stage that is lower than this it is there alone: beside its buttons, tiles would leave
# nothing of it. M brings the pictures.
_MAP_ALONE_UNITS = 16.0
_GAP_PX = 4
# Least size of a small tile, in heights of a line: its name and a picture that can be made out.
_LEAST_UNITS = (9.0, 6.5)
# Size of what floats over a picture, in heights of a line, and the part of the picture it may take.
_FLOAT_UNITS, _FLOAT_SHARE = 9.0, 0.34


class Stage(QWidget):
    """Places tiles by :func:`mhri.screen.arrangement.arrange`; nothing on it scrolls.

    The keyboard is here while the operator drives: Tab goes from picture to picture.
    """

    #: the shapes of the pictures, or which are large, have changed
    rearranged = Signal()
    #: "Look for Connected Bots", where there is no robot yet
    look_requested = Signal()
    #: the map has come, gone, or changed places with the pictures
    map_changed = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._tiles = {}
        self._large = self._large_places = ()
        self._expected = ()
        self._shapes = ()
        self._driven = self._awaited = ()
        self._looked_at = ''
        self._style = AUTO
        self._float = None
        self._map = None
        self._map_state = MAP_CLOSED
        self._numbers_shown = True
        self._build()
        self._connect()

    def _build(self):
        """Set what never changes."""
        self.setObjectName('stage')
        self.setFocusPolicy(Qt.StrongFocus)
        self.setAccessibleName('Robots and their pictures')
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        mark_drive_area(self)
        self._invitation = Invitation(self)

    def _connect(self):
        """Hand on what is asked for while it is empty."""
        self._invitation.look_requested.connect(self.look_requested)

    def show_awaited(self, names):
        """Say, where there is no tile yet, whose ones will come: names of robots in the list."""
        if tuple(names) != self._awaited:
            self._awaited = tuple(names)
            self._invitation.show_awaited(self._awaited)

    def show_look_result(self, text, busy=False):
        """Say what came of looking for robots, where there is none yet."""
        self._invitation.show_result(text, busy)

    @property
    def large(self):
        """Names of the robots whose tiles are large."""
        return self._large

    @property
    def looked_at(self):
        """Name of the robot that was looked at last, '' for none."""
        return self._looked_at

    @property
    def names(self):
        """Names of the robots whose tiles are on the stage, in order."""
        return tuple(name for name, tile in self._tiles.items() if not tile.torn_off)

    def set_map(self, widget):
        """Have a map, a :class:`mhri.map.gui.map_pane.MapPane`; :meth:`show_map` shows it."""
        self._map = widget
        widget.setParent(self)
        widget.hide()
        widget.done.connect(self.setFocus)
        widget.swap_requested.connect(self.swap_map)

    @property
    def map_state(self):
        """MAP_CLOSED, MAP_BESIDE or MAP_LARGE."""
        return self._map_state

    def show_map(self, state):
        """Show the map large or beside the pictures, or close it."""
        if state != self._map_state and self._map is not None:
            self._map_state = state
            self.refresh()
            self.map_changed.emit()

    def swap_map(self):
        """Let map and pictures change places; one that is closed comes large."""
        self.show_map(MAP_BESIDE if self._map_state == MAP_LARGE else MAP_LARGE)

    def show_tiles(self, tiles, expected=None):
        """Have just these tiles: {name: :class:`BotWindow`}, in order.

        :param expected: names of these and of those that come next, in order: they have their
            places already, so that no tile is moved by each one that comes; None: as before
        """
        expected = self._expected if expected is None else tuple(expected)
        if list(tiles.items()) != list(self._tiles.items()) or expected != self._expected:
            self._tiles, self._expected = dict(tiles), expected
            for tile in tiles.values():
                if not tile.torn_off and tile.parentWidget() is not self:
                    tile.setParent(self)
            self.refresh()

    def show_driven(self, names):
        """Take note of the robots that are checked."""
        if tuple(names) != self._driven:
            self._driven = tuple(names)
            self.refresh()

    def look_at(self, name):
        """Show this robot large; '' leaves it to those that are driven."""
        if name != self._looked_at:
            self._looked_at = name
            self.refresh()

    def set_style(self, style):
        """Choose how tiles are laid out: AUTO, ONE or ALIKE of the arrangement."""
        if style != self._style:
            self._style = style
            self.refresh()

    def next_name(self, steps=1):
        """Return the name of the robot after the one that is looked at, '' without robots."""
        names = self.names
        if not names:
            return ''
        now = self._looked_at if self._looked_at in names else next(iter(self._large), names[0])
        return names[(names.index(now) + steps) % len(names)]

    @property
    def numbers_shown(self):
        """Whether the numbers over the pictures are shown."""
        return self._numbers_shown

    def show_numbers(self, shown):
        """Show the numbers over the pictures, or the pictures alone."""
        self._numbers_shown = shown
        for tile in self._tiles.values():
            tile.show_hud(shown)

    def refresh(self):
        """Place the tiles anew: a tile came, went, was torn off, or has another shape."""
        self._large_places = choose_large(self._places(), self._driven, self._looked_at,
                                          self._style)
        self._large = tuple(name for name in self._large_places if name in self._tiles)
        self._shapes = self._shapes_now()
        for name, tile in self._tiles.items():
            tile.show_hud(self._numbers_shown)
        self._mark()
        self._place()
        self.rearranged.emit()

    def _mark(self):
        """Mark the tile that is looked at; with the keyboard here, the one that Enter drives."""
        marked = self._looked_at or (next(iter(self._large), '') if self.hasFocus() else '')
        for name, tile in self._tiles.items():
            tile.show_looked_at(name == marked)
            if name == marked:
                tile.update()

    def focusInEvent(self, event):  # noqa: N802
        """Show that the keys go to the pictures."""
        super().focusInEvent(event)
        self._mark()

    def focusOutEvent(self, event):  # noqa: N802
        """Show that the keys go elsewhere."""
        super().focusOutEvent(event)
        self._mark()

    def watch_shapes(self):
        """Place the tiles anew where a picture has another shape than before."""
        if self._shapes_now() != self._shapes:
            self.refresh()

    def _shapes_now(self):
        """Return the shape of each tile's picture, those of the large tiles first."""
        return tuple(round(self._tiles[name].picture_shape() if name in self._tiles
                           else USUAL_SHAPE, 2) for name in self._in_order())

    def _places(self):
        """Return whose tiles have a place on the stage, in order: those on it and those to come."""
        names = self.names
        if not names:
            return ()
        places = [name for name in self._expected if name in names or name not in self._tiles]
        return (*places, *(name for name in names if name not in places))

    def _in_order(self):
        """Return whose tiles have a place, those of the large ones first."""
        return self._large_places + tuple(name for name in self._places()
                                          if name not in self._large_places)

    def picture_px(self, width, height):
        """Return the area that would be picture in a room of this size [px²]."""
        return self._arranged(width, height).picture_px

    def has_room_beside(self, width=None, height=None):
        """Tell whether the map has room beside the pictures, on a stage of this size [px]."""
        unit = self.fontMetrics().height()
        return (width or self.width()) >= _MAP_UNITS[0] * unit and \
            (height or self.height()) >= _MAP_UNITS[1] * unit

    def _with_map(self, large, small, the_map, width, height):
        """Return what is large and what is small on a stage of this size, the map among it."""
        if self._map_state == MAP_LARGE:
            alone = height < _MAP_ALONE_UNITS * self.fontMetrics().height()
            return (the_map,), () if alone else large + small
        if self._map_state == MAP_BESIDE and self.has_room_beside(width, height):
            return large, small + (the_map,)
        return large, small

    def _arranged(self, width, height):
        count = max(1, len(self._large_places))
        unit = self.fontMetrics().height()
        shapes = self._shapes or (USUAL_SHAPE,)
        large, small = self._with_map(shapes[:count], shapes[count:], USUAL_SHAPE, width, height)
        return arrange(width, height, large, small,
                       tuple(round(units * unit) for units in _LEAST_UNITS), _GAP_PX)

    def _place(self):
        """Give each tile its rectangle."""
        tiles = tuple(map(self._tiles.get, self._in_order()))
        self._invitation.setVisible(not self._tiles)
        self._invitation.setGeometry(self.rect())
        count = len(self._large_places)
        for index, tile in enumerate(tiles):
            if tile is not None:
                tile.full_rate = index < count
        large, small = self._with_map(tiles[:count], tiles[count:], self._map, self.width(),
                                      self.height()) if tiles else ((), ())
        for part in (self._map, *tiles):
            if part is not None and part not in large + small:
                part.hide()
        if not tiles:
            return
        found = self._arranged(self.width(), self.height())
        for index, (tile, box) in enumerate(zip(large + small, found.large + found.small)):
            if tile is not None:
                tile.show_large(index < len(large))
                tile.setGeometry(QRect(box.x, box.y, box.width, box.height))
                tile.show()
        self.place_float()

    def show_float(self, widget):
        """Let a widget float over the pictures at the lower right, None for none.

        :returns: the one that floated before, or None
        """
        before, self._float = self._float, widget
        if widget is not None and widget.parentWidget() is not self:
            widget.setParent(self)
            widget.show()
        self.place_float()
        return before

    def place_float(self):
        """Place what floats at the lower right of the large picture, clear of its words."""
        under, side, unit = None, 0, self.fontMetrics().height()
        if self._float is not None:
            tile = under = self._tiles.get(next(iter(self._large), ''))
            if self._map_state == MAP_LARGE and self._map is not None:
                # Above the line at its foot.
                under, room = None, self._map.geometry().adjusted(0, 0, 0, -2 * unit)
            else:
                room = self.rect() if tile is None else \
                    tile.picture_area().translated(tile.pos())
            side = round(min(_FLOAT_UNITS * unit, _FLOAT_SHARE * min(room.width(), room.height())))
            place = QRect(room.right() - side - unit // 2, room.bottom() - side - unit // 2,
                          side, side)
            if under is None and self._map_state == MAP_LARGE and self._map is not None:
                place = self._map.clear_of_buttons(place.translated(-self._map.pos())).translated(
                    self._map.pos())
            self._float.setGeometry(place)
            self._float.raise_()
        for tile in self._tiles.values():
            tile.hud.keep_clear(side + unit // 2 if tile is under else 0)

    def resizeEvent(self, event):  # noqa: N802
        """Fill the room there is now."""
        super().resizeEvent(event)
        self._place()

    def paintEvent(self, event):  # noqa: N802
        """Paint the ground between the tiles: dark in every theme, as it is beside a picture."""
        if self._tiles:
            QPainter(self).fillRect(self.rect(), theme.PICTURE_GROUND)
