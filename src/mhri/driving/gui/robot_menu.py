# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The menu of a robot, the same one on its row, its tile and its mark on the map."""
from functools import partial

from python_qt_binding.QtCore import QObject, Qt
from python_qt_binding.QtGui import QPalette
from python_qt_binding.QtWidgets import QMenu

from mhri.base.gui import theme
from mhri.driving.gui.stop_clear import room_px

# Groups of rows from top to bottom; the last one acts on other robots than the menu's.
SEND, DRIVE, STOP, FOLLOW, RETURN, USE, TASK, PLACE, REMOVE, OTHERS = range(10)
# A line is drawn above these.
_LINES = (USE, TASK, PLACE, REMOVE, OTHERS)


class RobotMenu(QObject):
    """Opens the menu of a robot; its rows are offered by the subjects that carry them out.

    A row is a pair (text, function without arguments); without a function (None) it is disabled,
    and its text says why.
    """

    def __init__(self, screen):
        super().__init__(screen)
        self._screen = screen
        self._robots = ()
        self._offers = []
        self._disabled = False

    def offer(self, group, rows):
        """Add rows to the menu of every robot.

        :param group: SEND, DRIVE, ... or OTHERS
        :param rows: function of (:class:`mhri.base.views.RobotView`, names of the *other* selected
            robots) that returns a list of rows, [] for none
        """
        self._offers.append((group, rows))

    def disable(self):
        """Let no row have an effect from now on: the robots are those of a recording."""
        self._disabled = True

    def show_robots(self, robots):
        """Update the robots: values of :class:`mhri.base.views.RobotView`."""
        self._robots = tuple(robots)

    def rows(self, name):
        """Return the rows of a robot's menu, None for a line; [] for an unknown robot."""
        robot = next((robot for robot in self._robots if robot.name == name), None)
        if robot is None:
            return []
        others = tuple(other.name for other in self._robots
                       if other.selected and other.name != name)
        found = []
        for group, make in sorted(self._offers, key=lambda offer: offer[0]):
            rows = make(robot, others)
            if rows and found and group in _LINES and found[-1] is not None:
                found.append(None)
            found += [(text, None) for text, _ in rows] if self._disabled else rows
        return found

    def open(self, name, where):
        """Open the menu of a robot at a :class:`QPoint` of the desktop, without blocking."""
        rows = self.rows(name)
        if rows:
            popup(self._screen, rows, where, 'robot_menu')


def clicked(robot, others):
    """Return a robot's name, with "(clicked)" where other robots are driven.

    :param others: names of the other selected robots
    """
    return robot.name + ' (clicked)' if others else robot.name


def driven(names):
    """Return the names of selected robots as text, e.g. "bot1 and bot2 (driven)"."""
    return ' and '.join(names) + ' (driven)'


def popup(parent, rows, where, name):
    """Show a menu at a :class:`QPoint` of the desktop, without blocking.

    It covers no stop button: see :mod:`mhri.driving.gui.stop_clear`.

    :param rows: pairs (text, function), as in :class:`RobotMenu`; None for a line
    :param name: name of the :class:`QMenu`
    """
    menu = QMenu(parent)
    menu.setObjectName(name)
    menu.setFont(parent.font())
    # Lower rows, so that the menu fits above STOP ALL.
    least = parent.fontMetrics().height()
    count, lines = sum(row is not None for row in rows), rows.count(None)
    room = room_px(where) - least - 10 * (1 + lines)
    high = max(least, min(theme.touch_size(parent), room // max(1, count)))
    menu.setStyleSheet(_style(parent.palette(), high))
    menu.setAttribute(Qt.WA_DeleteOnClose)
    for row in rows:
        if row is None:
            menu.addSeparator()
            continue
        text, act = row
        action = menu.addAction(text)
        action.setEnabled(act is not None)
        if act is not None:
            action.triggered.connect(partial(_run, act))
    menu.popup(where)


def _style(palette, high):
    """Return the style sheet of a menu, set apart from pictures and panels by ground and edge.

    :param high: height of a row [px]
    """
    text, ground = palette.color(QPalette.WindowText), theme.blend(
        palette.color(QPalette.Window), palette.color(QPalette.WindowText), 0.08)
    names = {'high': high, 'text': text.name(), 'ground': ground.name(),
             'line': theme.blend(ground, text, 0.35).name(),
             'muted': theme.blend(ground, text, 0.62).name(),
             'accent': palette.color(QPalette.Highlight).name(),
             'on_accent': palette.color(QPalette.HighlightedText).name()}
    return ('QMenu {{ background: {ground}; color: {text}; border: 1px solid {line};'
            ' padding: 4px 0; }}'
            'QMenu::item {{ min-height: {high}px; padding: 0 1em; }}'
            'QMenu::item:selected {{ background: {accent}; color: {on_accent}; }}'
            'QMenu::item:disabled {{ background: {ground}; color: {muted}; }}'
            'QMenu::separator {{ height: 1px; background: {line}; margin: 4px 1em; }}'
            ).format(**names)


def _run(act, *_):
    """Carry out a row; the signal's own value does not count."""
    act()
