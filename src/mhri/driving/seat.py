# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who is the operator in control: one at a time, on a lease. No ROS, no clock.

States and what leads out of them::

    EMPTY    nobody is in control            a selection -> LEASED by its publisher
    LEASED   the selection is repeated       silent for LEASE_S, publisher gone -> LAPSED
    LAPSED   the operator is silent, or      repeated -> LEASED, publisher gone for RETURN_S
             has gone a moment ago           -> EMPTY

Taking control is possible in every state. Only the robots of a leased seat may move. An empty seat
goes to nobody who was refused before: a script that repeats its selection must not become the
operator by waiting.
"""
import math
from typing import Any, Dict, Iterable, NamedTuple, Optional, Tuple

EMPTY, LEASED, LAPSED = 'empty', 'leased', 'lapsed'

# A selection not repeated for this long no longer counts [s].
LEASE_S = 1.5
# An operator that has gone may come back within this time [s].
RETURN_S = 3.0
# The most that is kept: every robot costs memory, and so does everybody who was refused.
MOST_ROBOTS = 64
MAX_REFUSED = 64
_LONGEST = 200


class Caller(NamedTuple):
    """A node: its name, the address of its process (XML-RPC URI), and the host in that address."""

    name: str
    uri: str = ''
    computer: str = ''

    def is_successor_of(self, other: 'Caller') -> bool:
        """Tell whether this is that node, or the same one started again on the same computer."""
        return self == other or (self.name, self.computer) == (other.name, other.computer)


def _caller(value: Any) -> Caller:
    """Return a :class:`Caller` from its kept form, or any other three texts."""
    return Caller(*(str(text)[:_LONGEST] for text in value))


class ControlSeat:
    """The operator in control and the robots it has checked.

    Time is seconds of a clock that never goes back. ``changes`` counts what :meth:`kept` would
    tell the next process.
    """

    def __init__(self) -> None:
        self._holder: Optional[Caller] = None
        self._chosen: Tuple[str, ...] = ()
        self._repeated_at = -math.inf
        self._lapsed = False
        self._empty_at: Optional[float] = None
        self._refused: Dict[Caller, None] = {}
        self.since: Optional[float] = None
        self.changes = 0

    @property
    def state(self) -> str:
        """One of EMPTY, LEASED, LAPSED."""
        if self._holder is None:
            return EMPTY
        return LAPSED if self._lapsed else LEASED

    @property
    def holder(self) -> Optional[Caller]:
        """The :class:`Caller` in control, None for nobody."""
        return self._holder

    @property
    def operator(self) -> str:
        """Caller id of the operator in control, '' for nobody."""
        return self._holder.name if self._holder else ''

    @property
    def checked(self) -> Tuple[str, ...]:
        """Names of the robots that may be driven now."""
        return self._chosen if self.state == LEASED else ()

    def on_selection(self, caller: Caller, names: Iterable[str], now: float) -> bool:
        """Take in a selection; return whether it counts.

        :param names: of robots; those beyond :data:`MOST_ROBOTS` are cut off
        """
        caller = _caller(caller)
        if caller != self._holder:
            if caller in self._refused or \
                    self._holder is not None and not caller.is_successor_of(self._holder):
                self._refuse(caller)
                return False
            replaced = self._holder
            self.take(caller, now)
            if replaced is not None:
                # Its own last process, should that still speak.
                self._refuse(replaced)
        self._chosen = tuple(names)[:MOST_ROBOTS]
        self._repeated_at, self._lapsed, self._empty_at = now, False, None
        return True

    def _refuse(self, caller: Caller) -> None:
        if caller not in self._refused:
            self.changes += 1
            self._refused[caller] = None
            while len(self._refused) > MAX_REFUSED:
                del self._refused[next(iter(self._refused))]

    def take(self, caller: Caller, now: float) -> None:
        """Put the caller in control; only what it selects from now on counts."""
        caller = _caller(caller)
        self._refused.pop(caller, None)
        self._holder, self._chosen, self._lapsed, self._empty_at = caller, (), False, None
        self._repeated_at = self.since = now
        self.changes += 1

    def on_gone(self, caller: Caller, now: float) -> bool:
        """Take note that a publisher of the selection has gone; return whether it was in control.

        Its robots stand from now on; the seat stays its own for :data:`RETURN_S`.
        """
        if self._holder is None or _caller(caller) != self._holder:
            return False
        self._wait_for_holder(now)
        return True

    def _wait_for_holder(self, now: float) -> None:
        self._chosen, self._lapsed, self._empty_at = (), True, now + RETURN_S

    def tick(self, now: float, there: Iterable[Caller] = ()) -> None:
        """Let time pass: a lease that is not renewed lapses, and a seat that is left gets empty.

        :param there: who is connected as a publisher of the selection
        """
        if self._holder is None:
            return
        if now - self._repeated_at >= LEASE_S:
            self._lapsed = True
        if self._empty_at is None:
            return
        if any(_caller(caller).is_successor_of(self._holder) for caller in there):
            self._empty_at = None
        elif now >= self._empty_at:
            self._holder = self.since = self._empty_at = None
            self._chosen, self._lapsed = (), False
            self.changes += 1

    def next_tick(self) -> Optional[float]:
        """Return when to call :meth:`tick` next [s], or None for never."""
        return self._repeated_at + LEASE_S if self.state == LEASED else self._empty_at

    def kept(self) -> Dict[str, Any]:
        """Return what the next process has to know, as JSON values."""
        return {'holder': self._holder and list(self._holder), 'since': self.since,
                'refused': [list(caller) for caller in self._refused]}

    def restore(self, kept: Dict[str, Any], now: float) -> None:
        """Take back what another process has kept: nothing is selected, and its holder may return.

        :param kept: of :meth:`kept`
        """
        self._refused = {_caller(caller): None for caller in kept['refused']}
        if kept['holder']:
            self._holder, self.since = _caller(kept['holder']), kept['since']
            self._wait_for_holder(now)
