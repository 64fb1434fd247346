# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which window of mhri a robot gets: the ``window`` key of its type, looked up in one table."""
from python_qt_binding.QtCore import QPoint, QRect

from mhri.gui.bot_window import BotWindow
from mhri.gui.motion_dial import MotionDial


class TurtleBotWindow(BotWindow):
    """A robot with a differential drive: the base window with a picture of its motion."""

    def _build(self, ui_dir, type_label):
        """Add the dial."""
        super()._build(ui_dir, type_label)
        self.dial = MotionDial(self)
        self.motion_place.layout().addWidget(self.dial)
        self.motion_place.show()

    def _show_numbers(self, view):
        """Show the dial's part, too."""
        super()._show_numbers(view)
        self.dial.show_view(view)


STANDARD = 'turtlebot'
# A further type of window is a further row.
_WINDOWS = {STANDARD: TurtleBotWindow}


def window_class(key):
    """Return the class of a type's ``window`` key; an unknown key gets the window all have.

    Classes of a lab's own packages (``package.module.Class``): see ``window_maker``.
    """
    return _WINDOWS.get(key, BotWindow)


def free_corner(screen, size, panel, others, step=96):
    """Return the place on a screen where a new window covers the least of what is there.

    The panel counts twenty times: its stop bar and its bottom line stay in sight.
    Of places that are equally good the first in reading order is taken, so that windows tile.

    :param screen: the area there is (``QRect``)
    :param size: of the new window (``QSize``)
    :param panel: the rectangle of the panel's window (``QRect``)
    :param others: those of the robots' windows that are there
    """
    right = max(screen.left(), screen.right() - size.width())
    bottom = max(screen.top(), screen.bottom() - size.height())
    taken = [panel] + list(others)
    # Beside the edges of what is there, and on a grid for when nothing is left free.
    across = sorted({min(x, right) for x in [screen.left()] + [
        rect.right() + 8 for rect in taken] + list(range(screen.left(), right + 1, step))})
    down = sorted({min(y, bottom) for y in [screen.top()] + [
        rect.bottom() + 8 for rect in taken] + list(range(screen.top(), bottom + 1, step))})

    def covered(place):
        """Return the area that a window at a place would cover of the others."""
        cuts = [QRect(place, size).intersected(rect) for rect in taken]
        areas = [0 if cut.isEmpty() else cut.width() * cut.height() for cut in cuts]
        return 20 * areas[0] + sum(areas[1:])

    return min((QPoint(x, y) for y in down for x in across), key=covered)
