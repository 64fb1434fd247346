# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""When an input device's state is published: on change, but not too often, and again while held."""
from typing import Generic, Optional, TypeVar

State = TypeVar('State')

# Shortest time between two messages [s]; of changes in between only the newest state is sent.
MIN_PERIOD_S = 0.01
# A stick held still sends nothing by itself, and the mux takes silence for a loss.
REPEAT_S = 0.05


class Pacer(Generic[State]):
    """Holds the newest state of a device and says when to publish it.

    Times are seconds of a clock that never goes back. The newest state is never dropped: it is
    returned by the first :meth:`take` at or after its time.
    """

    def __init__(self) -> None:
        self._newest: Optional[State] = None
        self._changed = False
        self._sent_at: Optional[float] = None

    def offer(self, state: State) -> None:
        """Take in a state (anything but None); it replaces one not published yet."""
        self._newest = state
        self._changed = True

    @property
    def holding_back(self) -> bool:
        """Whether a change waits for its time."""
        return self._changed

    def due_in(self, now: float) -> float:
        """Return the time until something is due [s], 0.0: now.

        Without any state it is the time of a repetition, so that a caller has a time to wait.
        """
        if self._newest is None:
            return REPEAT_S
        if self._sent_at is None:
            return 0.0
        period_s = MIN_PERIOD_S if self._changed else REPEAT_S
        return max(0.0, self._sent_at + period_s - now)

    def take(self, now: float) -> Optional[State]:
        """Return the state to publish now, or None if it is not time for one."""
        if self._newest is None or self.due_in(now) > 0.0:
            return None
        self._sent_at = now
        self._changed = False
        return self._newest
