# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detects goals of a robot's own navigation that nobody supervises any more."""
from typing import Dict, List, Optional, Tuple

# A sender silent for this long hangs, and so does what would replace it [s].
SILENT_S = 2.5
# Commands that name the robot so soon after a goal may be of the task before [s].
OVERLAP_S = 0.3


class GoalWatch:
    """Knows the last goal of each program of tasks; times are [s] of a monotonic clock.

    While such a program supervises a goal it sends commands, without this robot. After the goal
    they name the robot once more, for its zeros.
    """

    def __init__(self) -> None:
        # {sender: (goal, when it was sent)}; {sender: when it last sent anything}.
        self._goals: Dict[str, Tuple[str, float]] = {}
        self._heard: Dict[str, float] = {}

    def on_goal(self, sender: str, goal: str, now: float) -> None:
        """Handle a new goal."""
        self._heard[sender] = now
        self._goals[sender] = goal, now

    def on_command(self, sender: str, named: bool, now: float) -> None:
        """Handle the commands of a program; if they name this robot, its goal has ended."""
        _, sent = self._goals.get(sender, ('', now))
        if sender in self._heard:
            self._heard[sender] = now
        if named and now - sent >= OVERLAP_S:
            self._goals.pop(sender, None)

    def on_gone(self, sender: str) -> Optional[str]:
        """Return the goal of a program that has ended, None if it has none."""
        self._heard.pop(sender, None)
        return self._goals.pop(sender, (None, 0.0))[0]

    def overdue(self, now: float) -> List[str]:
        """Return the goals of programs that have fallen silent, each once."""
        silent = [sender for sender, at in list(self._heard.items()) if now - at >= SILENT_S]
        return [goal for goal in map(self.on_gone, silent) if goal is not None]
