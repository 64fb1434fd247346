# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which window of mhri a robot gets: the ``window`` key of its type, looked up in one table."""
from mhri.driving.gui.motion_dial import MotionDial
from mhri.screen.gui.bot_window import BotWindow


class TurtleBotWindow(BotWindow):
    """A robot with a differential drive: the base window with a picture of its motion."""

    def _build(self, ui_dir, type_label):
        """Add the dial."""
        super()._build(ui_dir, type_label)
        self.dial = MotionDial(self)
        self.dial_place.layout().addWidget(self.dial)

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
