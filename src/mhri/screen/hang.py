# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Decides by heartbeats whether the screen hangs, so that others must handle a press of STOP."""
from typing import Optional

# Interval of the heartbeats, and silence after which the screen counts as hung [s]. Drawing may
# block for 0.05 s; if a busy computer blocks for longer, an unnecessary stop does no harm.
BEAT_S = 0.1
LATE_S = 0.3
# Beats that prove a press handled; the first one may have been sent before the press.
_PROOF = 2


class PressWatch:
    """Compares presses of STOP with heartbeats of the screen; all times in s, of one clock.

    A screen that still sends heartbeats has handled a press itself.

    :param now: start time
    """

    def __init__(self, now: float) -> None:
        self._beat_at = now
        self._due_at: Optional[float] = None
        self._beats = 0

    def beat(self, now: float) -> None:
        """Handle a heartbeat."""
        self._beat_at = now
        self._beats += 1
        if self._beats >= _PROOF:
            self._due_at = None

    def press(self, now: float) -> None:
        """Handle a press of STOP; ignore it while an earlier one is pending."""
        if self._due_at is None:
            self._beats = 0
            self._due_at = max(now, self._beat_at + LATE_S)

    def wait_s(self, now: float) -> Optional[float]:
        """Return the time until others must stop [s], None if no press is pending."""
        return None if self._due_at is None else max(0.0, self._due_at - now)

    def take(self, now: float) -> bool:
        """Return whether others must stop now; the press then no longer is pending."""
        due = self._due_at is not None and now >= self._due_at
        if due:
            self._due_at = None
        return due
