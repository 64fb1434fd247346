# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stop that outlives the mux: what the gates say of it brings it back."""
from typing import Optional

# The gates may contradict the mux for so long: its last word may still be on its way.
DOUBT_S = 1.0


class StopEcho:
    """Follows ``stop_all`` of ``/gates/state`` and says when the mux has to stop as well.

    The mux that was stopped may have been replaced by one that knows nothing of it, together with
    the master that kept its parameters. The gates still hold the stop.
    """

    def __init__(self) -> None:
        self._heard = False
        self._since: Optional[float] = None
        self._released_at: Optional[float] = None

    def on_release(self, now: float) -> None:
        """Note that the operator has released the stop at this mux."""
        self._released_at = now

    def must_stop(self, gates_stopped: bool, stopped: bool, now: float) -> bool:
        """Take in what the gates say; tell whether the mux has to engage its stop.

        At once by their first word, since a mux that has just begun knows less than they do; later
        when they have said so for more than :data:`DOUBT_S`.

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
