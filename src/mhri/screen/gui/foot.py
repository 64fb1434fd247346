# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the foot of the screen is: STOP ALL, the worst event, the bottom line.

It is where it leaves most to the pictures: a 4:3 picture on a wide screen leaves room beside it, a
wide one leaves room below. STOP ALL is at the lower left in each of these places.
"""
from python_qt_binding.QtWidgets import QBoxLayout

from mhri.screen.arrangement import WORTH_MOVING

#: below everything; at the bottom of the open drawer; beside the pictures while it is closed
BELOW, IN_DRAWER, COLUMN = 'below', 'in the drawer', 'column'
# Its height at the bottom of the drawer, in heights of a line.
_IN_DRAWER_UNITS = 13.0
# Width of the column, the one that takes nothing from the pictures; the first is a drawer's.
_COLUMN_UNITS = (22.0, 18.0, 15.0, 13.0)
_TAKES_NOTHING = 0.985
# Height that the column needs, and what a question over it and the virtual joystick add to it.
_COLUMN_HIGH_UNITS, _BAR_UNITS, _STICK_UNITS = 24.0, 8.0, 9.0


class Foot:
    """Chooses the place of the foot, and moves it there.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, its form loaded
    """

    def __init__(self, screen):
        self._screen = screen
        self._below_px = 0
        #: what comes and goes in it, and must not move STOP ALL by that; each with show_narrow()
        self.passing = []
        self._lines = []
        #: BELOW, IN_DRAWER or COLUMN
        self.place = None
        self.move(BELOW)

    def choose(self, drawer_px):
        """Return the place that leaves most to the pictures; the one it has, where it is as good.

        :param drawer_px: width of the open drawer, 0 while it is closed
        """
        screen = self._screen
        if self.place == BELOW and all(part.isHidden() for part in self.passing):
            self._below_px = screen.foot.sizeHint().height()
        width, height = screen.width(), screen.height()
        below = screen.stage.picture_px(width - drawer_px, height - self._below_px)
        if drawer_px:
            other, taken = IN_DRAWER, drawer_px
            needed = screen.drawer.minimumSizeHint().height() + self._px(
                _IN_DRAWER_UNITS + self._line_units())
        else:
            other, taken = COLUMN, self._px(_COLUMN_UNITS[-1])
            needed = self._column_high()
        beside = screen.stage.picture_px(width - taken, height)
        share = beside / below if below else 2.0
        worth = share > (1.0 if self.place == other else WORTH_MOVING)
        return other if needed <= height and worth and (drawer_px or screen.stage.names) else BELOW

    def add_passing(self, part):
        """Take in a part that comes and goes."""
        self.passing.append(part)
        part.show_narrow(self.place == COLUMN)

    def add_line(self, line):
        """Put a line over the bottom line.

        :param line: has ``show_wrapped()``, and ``UNITS``: the height that it needs beside the
            pictures, in heights of a line of text
        """
        self._lines.append(line)
        self._screen.words_column.insertWidget(0, line)
        line.show_wrapped(self.place != BELOW)

    def move(self, place):
        """Put the foot there."""
        screen = self._screen
        self.place = place
        narrow = place != BELOW
        screen.foot_row.setDirection(QBoxLayout.BottomToTop if narrow else QBoxLayout.LeftToRight)
        screen.foot_row.setStretch(0, 0 if narrow else 2)
        screen.foot_row.setStretch(1, 0 if narrow else 1)
        screen.small_row.setDirection(
            QBoxLayout.TopToBottom if place == COLUMN else QBoxLayout.LeftToRight)
        screen.stop_bar.show_narrow(narrow, place == COLUMN)
        for bar in (screen.control_bar, screen.leave_bar, *self.passing):
            bar.show_narrow(place == COLUMN)
        for line in (screen.status_line, *self._lines):
            line.show_wrapped(narrow)
        screen.screen_layout.setDirection(
            QBoxLayout.RightToLeft if place == COLUMN else QBoxLayout.TopToBottom)
        (screen.side_column if place == IN_DRAWER else screen.screen_layout).addWidget(screen.foot)
        screen.foot.show()

    def fit(self):
        """Take the width there is: in the column, as much as takes nothing from the pictures."""
        screen = self._screen
        if self.place != COLUMN:
            screen.foot.setMinimumWidth(0)
            screen.foot.setMaximumWidth(16777215)
            return
        pictures = [(self._px(units), screen.stage.picture_px(
            screen.width() - self._px(units), screen.height())) for units in _COLUMN_UNITS]
        most = max(area for _, area in pictures)
        screen.foot.setFixedWidth(next(
            px for px, area in pictures if area >= _TAKES_NOTHING * most))

    def has_room_for_stick(self):
        """Tell whether the virtual joystick has room in the column."""
        return self.place == COLUMN and \
            self._column_high() + self._px(_STICK_UNITS) <= self._screen.height()

    def _px(self, units):
        """Return heights of a line in pixels."""
        return round(units * self._screen.fontMetrics().height())

    def _line_units(self):
        """Return what the lines over the bottom line need beside the pictures."""
        return sum(line.UNITS for line in self._lines if not line.isHidden())

    def _column_high(self):
        """Return the height [px] that the column needs."""
        asking = sum(not bar.isHidden() for bar in (
            self._screen.control_bar, self._screen.leave_bar))
        return self._px(_COLUMN_HIGH_UNITS + _BAR_UNITS * asking + self._line_units())
