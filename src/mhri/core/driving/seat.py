# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who is the operator in control: one at a time, on a lease. No ROS, no clock.

States and what leads out of them::

    EMPTY    nobody is in control            a selection -> LEASED by its publisher
    LEASED   the selection is repeated       silent for LEASE_S -> LAPSED, publisher gone -> EMPTY
    LAPSED   its publisher is there, silent  repeated -> LEASED, publisher gone -> EMPTY

Taking control is possible in every state. Only the robots of a leased seat may move.
"""
import math
from typing import Iterable, Optional, Tuple

EMPTY, LEASED, LAPSED = 'empty', 'leased', 'lapsed'

# A selection not repeated for this long no longer counts [s].
LEASE_S = 1.5
# The most that is kept: every robot costs memory.
MOST_ROBOTS = 64


class ControlSeat:
    """The operator in control and the robots it has checked.

    Operators are caller ids; time is seconds of a clock that never goes back.
    """

    def __init__(self) -> None:
        self._operator = ''
        self._chosen: Tuple[str, ...] = ()
        self._repeated_at = -math.inf
        self._lapsed = False
        self.since: Optional[float] = None

    @property
    def state(self) -> str:
        """One of EMPTY, LEASED, LAPSED."""
        if not self._operator:
            return EMPTY
        return LAPSED if self._lapsed else LEASED

    @property
    def operator(self) -> str:
        """Caller id of the operator in control, '' for nobody."""
        return self._operator

    @property
    def checked(self) -> Tuple[str, ...]:
        """Names of the robots that may be driven now."""
        return self._chosen if self.state == LEASED else ()

    def on_selection(self, caller: str, names: Iterable[str], now: float) -> bool:
        """Take in a selection; return whether it counts.

        :param names: of robots; those beyond :data:`MOST_ROBOTS` are cut off
        """
        if self._operator and caller != self._operator:
            return False
        if not self._operator:
            self.take(caller, now)
        self._chosen = tuple(names)[:MOST_ROBOTS]
        self._repeated_at, self._lapsed = now, False
        return True

    def take(self, caller: str, now: float) -> None:
        """Put the caller in control; only what it selects from now on counts."""
        self._operator, self._chosen, self._lapsed = caller, (), False
        self._repeated_at = self.since = now

    def on_gone(self, caller: str) -> None:
        """Take note that a publisher of the selection has gone."""
        if caller == self._operator:
            self._operator, self._chosen, self._lapsed, self.since = '', (), False, None

    def tick(self, now: float) -> None:
        """Let time pass: a lease that is not renewed lapses."""
        if self._operator and now - self._repeated_at >= LEASE_S:
            self._lapsed = True

    def next_tick(self) -> Optional[float]:
        """Return when to call :meth:`tick` next [s], or None for never."""
        return self._repeated_at + LEASE_S if self.state == LEASED else None
