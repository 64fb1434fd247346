# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The operator in control: one at a time, on a lease. No ROS, no clock.

States and transitions::

    EMPTY    nobody is in control            a selection -> LEASED by its publisher
    LEASED   the selection is repeated       silent for LEASE_S, publisher gone -> LAPSED
    LAPSED   the operator is silent, or      repeated -> LEASED, publisher gone for RETURN_S
             its publisher has just gone     -> EMPTY

Taking control is possible in every state. Only the robots of a valid lease may move. A caller that
was refused before does not get an empty lease: a script that repeats its selection must not become
the operator by waiting. If it was forgotten who that was (:meth:`OperatorLease.forget`), nobody
gets the lease for RETURN_S, and then only a caller that is alone, or that takes control.
"""
import math
from typing import Any, Dict, Iterable, NamedTuple, Optional, Tuple

EMPTY, LEASED, LAPSED = 'empty', 'leased', 'lapsed'

# A selection not repeated for this long no longer counts [s].
LEASE_S = 1.5
# An operator that has disconnected may come back within this time [s].
RETURN_S = 3.0
# Maximum numbers of robots and of refused callers: each costs memory.
MAX_ROBOTS = 64
MAX_REFUSED = 64
_LONGEST = 200


class Caller(NamedTuple):
    """A node: its name, the XML-RPC URI of its process, and the host in that URI."""

    name: str
    uri: str = ''
    computer: str = ''

    def is_successor_of(self, other: 'Caller') -> bool:
        """Return whether this is the same node, possibly restarted on the same computer."""
        return self == other or (self.name, self.computer) == (other.name, other.computer)


def _caller(value: Any) -> Caller:
    """Return a :class:`Caller` from its stored form or any three texts."""
    return Caller(*(str(text)[:_LONGEST] for text in value))


class OperatorLease:
    """The operator in control and its selected robots.

    Time is seconds of a monotonic clock.
    """

    def __init__(self) -> None:
        self._holder: Optional[Caller] = None
        self._chosen: Tuple[str, ...] = ()
        self._repeated_at = -math.inf
        self._lapsed = False
        self._empty_at: Optional[float] = None
        self._refused: Dict[Caller, None] = {}
        # When the lease may be given again, None unless its past was forgotten; who was heard.
        self._unsure_until: Optional[float] = None
        self._heard: Dict[Caller, float] = {}
        self.since: Optional[float] = None

    @property
    def state(self) -> str:
        """One of EMPTY, LEASED, LAPSED."""
        if self._holder is None:
            return EMPTY
        return LAPSED if self._lapsed else LEASED

    @property
    def holder(self) -> Optional[Caller]:
        """The :class:`Caller` in control, None if there is none."""
        return self._holder

    @property
    def operator(self) -> str:
        """Caller id of the operator in control, '' if there is none."""
        return self._holder.name if self._holder else ''

    @property
    def chosen(self) -> Tuple[str, ...]:
        """Names of the robots in the last wish of the operator in control, leased or not."""
        return self._chosen

    @property
    def selected(self) -> Tuple[str, ...]:
        """Names of the robots that may be driven now."""
        return self._chosen if self.state == LEASED else ()

    def on_selection(self, caller: Caller, names: Iterable[str], now: float) -> bool:
        """Handle a selection; return whether it counts.

        :param names: names of robots; beyond :data:`MAX_ROBOTS` they are cut off
        """
        caller = _caller(caller)
        if caller != self._holder:
            if caller in self._refused or \
                    self._holder is not None and not caller.is_successor_of(self._holder):
                self._refuse(caller)
                return False
            if self._holder is None and self._is_unsure(caller, now):
                return False
            replaced = self._holder
            self.take(caller, now)
            if replaced is not None:
                # The operator's previous process, which may still be publishing.
                self._refuse(replaced)
        self._chosen = tuple(names)[:MAX_ROBOTS]
        self._repeated_at, self._lapsed, self._empty_at = now, False, None
        return True

    def _is_unsure(self, caller: Caller, now: float) -> bool:
        """Return whether a caller may be one that was refused before that was forgotten."""
        if self._unsure_until is None:
            return False
        self._heard = {one: at for one, at in self._heard.items() if now - at < LEASE_S}
        if len(self._heard) < MAX_REFUSED:
            self._heard[caller] = now
        return now < self._unsure_until or set(self._heard) != {caller}

    def _refuse(self, caller: Caller) -> None:
        if caller not in self._refused:
            self._refused[caller] = None
            while len(self._refused) > MAX_REFUSED:
                del self._refused[next(iter(self._refused))]

    def take(self, caller: Caller, now: float) -> None:
        """Put the caller in control; only its selections from now on count."""
        caller = _caller(caller)
        self._refused.pop(caller, None)
        self._holder, self._chosen, self._lapsed, self._empty_at = caller, (), False, None
        self._repeated_at = self.since = now
        self._unsure_until = None

    def on_gone(self, caller: Caller, now: float) -> bool:
        """Handle the loss of a publisher of the selection; return whether it was in control.

        Its robots stop; the lease stays reserved for it for :data:`RETURN_S`.
        """
        if self._holder is None or _caller(caller) != self._holder:
            return False
        self._wait_for_holder(now)
        return True

    def _wait_for_holder(self, now: float) -> None:
        self._chosen, self._lapsed, self._empty_at = (), True, now + RETURN_S

    def tick(self, now: float, there: Iterable[Caller] = ()) -> None:
        """Handle the passage of time: lapse a lease not renewed, free one whose holder is gone.

        :param there: the callers connected as publishers of the selection
        """
        if now - self._repeated_at >= LEASE_S:
            self._lapsed = True
        if self._holder is None or self._empty_at is None:
            return
        if any(_caller(caller).is_successor_of(self._holder) for caller in there):
            self._empty_at = None
        elif now >= self._empty_at:
            self._holder = self.since = self._empty_at = None
            self._chosen, self._lapsed = (), False

    def next_tick(self) -> Optional[float]:
        """Return when to call :meth:`tick` next [s], or None for never."""
        return self._repeated_at + LEASE_S if self.state == LEASED else self._empty_at

    def kept(self) -> Dict[str, Any]:
        """Return the state for the next process, as JSON values."""
        return {'holder': self._holder and list(self._holder), 'since': self.since,
                'refused': [list(caller) for caller in self._refused],
                'forgotten': self._unsure_until is not None}

    def restore(self, kept: Dict[str, Any], now: float) -> None:
        """Restore the state of the previous process: nothing is selected, its holder may return.

        :param kept: the result of :meth:`kept`
        :raises LookupError, TypeError, ValueError: it is malformed
        """
        self._refused = {_caller(caller): None for caller in kept['refused'][-MAX_REFUSED:]}
        if kept['forgotten']:
            self.forget(now)
        if kept['holder']:
            self._holder, self.since = _caller(kept['holder']), min(float(kept['since']), now)
            self._wait_for_holder(now)

    def forget(self, now: float) -> None:
        """Handle that the state of the previous process is lost."""
        self._unsure_until = now + RETURN_S
