# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether others must handle a press of STOP because the screen hangs, by its heartbeat."""
from typing import Optional

# How often the screen beats, and after what silence it counts as hung. Drawing may hold it up for
# 0.05 s; if a busy computer does so for longer, one stop too many harms nobody.
BEAT_S = 0.1
LATE_S = 0.3
# The first beat after a press may have left before the screen handled it.
_PROOF = 2


class PressWatch:
    """Compares presses of STOP with beats of the screen; times in s, all from one clock.

    A screen that still beats has handled a press itself.

    :param now: when the watch begins
    """

    def __init__(self, now: float) -> None:
        self._beat_at = now
        self._due_at: Optional[float] = None
        self._beats = 0

    def beat(self, now: float) -> None:
        """Take note of a sign of life."""
        self._beat_at = now
        self._beats += 1
        if self._beats >= _PROOF:
            self._due_at = None

    def press(self, now: float) -> None:
        """Take note of a press of STOP; another one before the first is handled changes nothing."""
        if self._due_at is None:
            self._beats = 0
            self._due_at = max(now, self._beat_at + LATE_S)

    def wait_s(self, now: float) -> Optional[float]:
        """Return in how many seconds others must stop; None if nothing is pressed."""
        return None if self._due_at is None else max(0.0, self._due_at - now)

    def take(self, now: float) -> bool:
        """Tell whether others must stop now; the press is then theirs."""
        due = self._due_at is not None and now >= self._due_at
        if due:
            self._due_at = None
        return due
