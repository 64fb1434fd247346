# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The times of publishing an input device's state: on change, rate-limited, and periodically."""
from typing import Generic, Optional, TypeVar

State = TypeVar('State')

# Minimum time between two messages [s]; of changes in between only the newest state is sent.
MIN_PERIOD_S = 0.01
# Period of repetitions [s]: a stick that is held still reports nothing, and the mux treats silence
# as a loss.
REPEAT_S = 0.05


class Pacer(Generic[State]):
    """Stores the newest state of a device and determines when to publish it.

    Times are monotonic seconds. The newest state is never dropped: the first :meth:`take` at or
    after its due time returns it.
    """

    def __init__(self) -> None:
        self._newest: Optional[State] = None
        self._changed = False
        self._sent_at: Optional[float] = None

    def offer(self, state: State) -> None:
        """Handle a state (not None); it replaces one not published yet."""
        self._newest = state
        self._changed = True

    @property
    def holding_back(self) -> bool:
        """Whether a change is pending."""
        return self._changed

    def due_in(self, now: float) -> float:
        """Return the time until a state is due [s], 0.0 if it is due now.

        Without any state it is :data:`REPEAT_S`, so that a caller has a finite time to wait.
        """
        if self._newest is None:
            return REPEAT_S
        if self._sent_at is None:
            return 0.0
        period_s = MIN_PERIOD_S if self._changed else REPEAT_S
        return max(0.0, self._sent_at + period_s - now)

    def take(self, now: float) -> Optional[State]:
        """Return the state to publish now, None if none is due."""
        if self._newest is None or self.due_in(now) > 0.0:
            return None
        self._sent_at = now
        self._changed = False
        return self._newest
