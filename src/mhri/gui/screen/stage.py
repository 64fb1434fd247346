# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The stage: the tiles of all robots, the pictures as large as they can be."""
from python_qt_binding.QtCore import QRect, Qt, Signal
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.core.screen.arrangement import arrange, AUTO, choose_large, USUAL_SHAPE
from mhri.gui.driving.drive_keys import mark_drive_area
from mhri.gui.screen import theme

_GAP_PX = 4
# Least size of a small tile, in heights of a line: its name and a picture that can be made out.
_LEAST_UNITS = (9.0, 6.5)
_FLOAT_UNITS = 9.0
_EMPTY = ('No robots yet.\n\nPress "Look for Connected Bots",\n'
          'or type the name of one and press "Add Bot".')


class Stage(QWidget):
    """Places tiles by :func:`mhri.core.screen.arrangement.arrange`; nothing on it scrolls.

    The keyboard is here while the operator drives: Tab goes from picture to picture.
    """

    #: the shapes of the pictures, or which are large, have changed
    rearranged = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._tiles = {}
        self._large = ()
        self._shapes = ()
        self._driven = ()
        self._looked_at = ''
        self._style = AUTO
        self._float = None
        self._numbers_shown = True
        self._build()

    def _build(self):
        """Set what never changes."""
        self.setObjectName('stage')
        self.setFocusPolicy(Qt.StrongFocus)
        self.setAccessibleName('Robots and their pictures')
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        mark_drive_area(self)

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

    def show_tiles(self, tiles):
        """Have just these tiles: {name: :class:`BotWindow`}, in order."""
        if list(tiles.items()) != list(self._tiles.items()):
            self._tiles = dict(tiles)
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
        names = self.names
        self._large = choose_large(names, self._driven, self._looked_at, self._style)
        self._shapes = self._shapes_now()
        for name, tile in self._tiles.items():
            tile.show_looked_at(name == self._looked_at)
            tile.show_hud(self._numbers_shown)
        self._place()
        self.rearranged.emit()

    def watch_shapes(self):
        """Place the tiles anew where a picture has another shape than before."""
        if self._shapes_now() != self._shapes:
            self.refresh()

    def _shapes_now(self):
        """Return the shape of each tile's picture, those of the large tiles first."""
        return tuple(round(self._tiles[name].picture_shape(), 2) for name in self._in_order())

    def _in_order(self):
        """Return the names, those of the large tiles first."""
        return self._large + tuple(name for name in self.names if name not in self._large)

    def picture_px(self, width, height):
        """Return the area that would be picture in a room of this size [px²]."""
        return self._arranged(width, height).picture_px

    def _arranged(self, width, height):
        count = len(self._large)
        unit = self.fontMetrics().height()
        shapes = self._shapes or (USUAL_SHAPE,)
        return arrange(width, height, shapes[:max(1, count)], shapes[max(1, count):],
                       tuple(round(units * unit) for units in _LEAST_UNITS), _GAP_PX)

    def _place(self):
        """Give each tile its rectangle."""
        names = self._in_order()
        self.update()
        if not names:
            return
        found = self._arranged(self.width(), self.height())
        for index, (name, box) in enumerate(zip(names, found.large + found.small)):
            tile = self._tiles[name]
            tile.show_large(index < len(self._large))
            tile.setGeometry(QRect(box.x, box.y, box.width, box.height))
            tile.show()
        self._place_float()

    def show_float(self, widget):
        """Let a widget float over the pictures at the lower right, None for none.

        :returns: the one that floated before, or None
        """
        before, self._float = self._float, widget
        if widget is not None and widget.parentWidget() is not self:
            widget.setParent(self)
            widget.show()
        self._place_float()
        return before

    def _place_float(self):
        if self._float is not None:
            side = round(_FLOAT_UNITS * self.fontMetrics().height())
            unit = self.fontMetrics().height()
            self._float.setGeometry(self.width() - side - unit, self.height() - side - unit,
                                    side, side)
            self._float.raise_()

    def resizeEvent(self, event):  # noqa: N802
        """Fill the room there is now."""
        super().resizeEvent(event)
        self._place()

    def paintEvent(self, event):  # noqa: N802
        """Say what to do where there is no robot, and paint the frame of the keyboard focus."""
        painter = QPainter(self)
        if not self._tiles:
            painter.setPen(theme.colour(theme.MUTED, self.palette()))
            painter.setFont(theme.larger(self.font(), 1.2))
            painter.drawText(self.rect(), int(Qt.AlignCenter), _EMPTY)
