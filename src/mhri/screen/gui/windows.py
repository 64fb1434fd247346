# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The classes of tiles, by the ``window`` key of a robot's type."""
from mhri.driving.gui.motion_dial import MotionDial
from mhri.screen.gui.robot_tile import RobotTile


class TurtleBotWindow(RobotTile):
    """The tile of a robot with a differential drive, with a dial of its motion."""

    def _build(self, ui_dir, type_label):
        """Add the dial."""
        super()._build(ui_dir, type_label)
        self.dial = MotionDial(self)
        self.dial_place.layout().addWidget(self.dial)

    def _show_numbers(self, view):
        """Update the dial, too."""
        super()._show_numbers(view)
        self.dial.show_view(view)


STANDARD = 'turtlebot'
# One row per tile class.
_WINDOWS = {STANDARD: TurtleBotWindow}


def window_class(key):
    """Return the class of a type's ``window`` key, the base class for an unknown key.

    For classes of a lab's own packages (``package.module.Class``) see ``window_maker``.
    """
    return _WINDOWS.get(key, RobotTile)
