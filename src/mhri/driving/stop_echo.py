# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stop that outlives the mux: the gates remember it and bring it back."""
from typing import Optional

# The gates may contradict the mux for this long: its last message may still be on its way.
DOUBT_S = 1.0


class StopEcho:
    """Follows ``stop_all`` of ``/gates/state`` and says when the mux has to stop as well.

    A new mux, started together with a new master, knows nothing about a stop that was in force
    before. The gates still hold it.
    """

    def __init__(self) -> None:
        self._heard = False
        self._since: Optional[float] = None
        self._released_at: Optional[float] = None

    def on_release(self, now: float) -> None:
        """Note that the operator has released the stop at this mux."""
        self._released_at = now

    def must_stop(self, gates_stopped: bool, stopped: bool, now: float) -> bool:
        """Take in what the gates say; return whether the mux must engage its stop.

        Their first message counts at once, since a mux that has just started knows less than they
        do; later they must have said so for more than :data:`DOUBT_S`.

        :param stopped: whether this mux is stopped
        """
        first, self._heard = not self._heard, True
        if not gates_stopped:
            self._since = None
            return False
        if self._since is None:
            self._since = now
        released = self._released_at is not None and now - self._released_at <= DOUBT_S
        return not stopped and not released and (first or now - self._since > DOUBT_S)
