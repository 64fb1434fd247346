# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The faults of simulated robots: a table, and the active ones of a robot."""
from dataclasses import dataclass
import math
from typing import Dict, List, NamedTuple, Optional, Tuple

from mhri.sim.body import Body

# Maximum duration of a fault; a request can be repeated [s].
MAX_S = 3600.0
ALL = 'all'


@dataclass(frozen=True)
class Fault:
    """A row of the table; ``label`` is its name on the screen.

    Its value is from ``low`` to ``high`` in ``unit``; a fault with ``unit`` '' has no value. A
    ``timed`` fault only ends by time, since the program cannot receive requests.
    """

    key: str
    label: str
    unit: str = ''
    low: float = 0.0
    high: float = 0.0
    default: float = 0.0
    timed: bool = False

    def words(self, value: float) -> str:
        """Return the fault with its value, e.g. "delay each way 0.4 s"."""
        return self.label if not self.unit else '{} {:g} {}'.format(self.label, value, self.unit)


FAULTS = (
    Fault('odometry_silent', 'odometry silent'),
    Fault('camera_silent', 'camera silent'),
    Fault('scan_silent', 'laser silent'),
    Fault('delay', 'delay each way', 's', 0.01, 5.0, 0.4),
    Fault('loss', 'loss each way', '%', 1.0, 100.0, 30.0),
    Fault('clock_off', 'clock off by', 's', -3600.0, 3600.0, 5.0),
    Fault('motor_stuck', 'left motor stuck'),
    Fault('wheel_slow', 'left wheel slow, at', '%', 5.0, 95.0, 50.0),
    Fault('drift', 'drifts left', 'deg/m', -90.0, 90.0, 15.0),
    Fault('battery_falling', 'battery falls', '%/min', 1.0, 6000.0, 60.0),
    Fault('computer_frozen', 'computer frozen'),
    Fault('node_dead', 'driver dead', timed=True),
    Fault('person', 'person in the way, at', 'm', 0.3, 10.0, 1.0))
ROWS = {fault.key: fault for fault in FAULTS}


class FaultRefused(ValueError):
    """A refused fault; the text names the problem and the valid values."""


def fault_named(key: str) -> Fault:
    """Return a row of the table.

    :raises FaultRefused: unknown name
    """
    if key not in ROWS:
        raise FaultRefused('there is no fault {!r}; there are {}'.format(
            key[:60], ', '.join(ROWS)))
    return ROWS[key]


def checked_value(fault: Fault, value: float) -> float:
    """Return the value of a requested fault; NaN selects its default.

    :raises FaultRefused: it is out of the fault's range
    """
    if not fault.unit or math.isnan(value):
        return fault.default
    if not fault.low <= value <= fault.high:
        raise FaultRefused('{}: expected a value from {:g} to {:g} {}, got {:g}'.format(
            fault.key, fault.low, fault.high, fault.unit, value))
    return value


def checked_duration(fault: Fault, duration_s: float) -> float:
    """Return the duration of a requested fault [s]; infinite: until ended by request.

    :raises FaultRefused: it is invalid, or missing for a fault that requires one
    """
    if not duration_s <= MAX_S:
        raise FaultRefused('{}: expected a duration from 0 to {:g} s, got {:g}'.format(
            fault.key, MAX_S, duration_s))
    if fault.timed and duration_s == 0.0:
        raise FaultRefused('{}: give a duration: nobody can ask a dead program to come '
                           'back'.format(fault.key))
    return duration_s or math.inf


class Having(NamedTuple):
    """An active fault: its value, and its end [s of the caller's clock]."""

    value: float
    until: float


class FaultBook:
    """The active faults of one robot; any thread may read, one at a time may write.

    Times are seconds of a monotonic clock.
    """

    def __init__(self) -> None:
        self._has: Dict[str, Having] = {}

    def begin(self, key: str, value: float, duration_s: float, now: float) -> None:
        """Start a fault, or replace it: see ``SetFault.srv``.

        :raises FaultRefused: an unknown name, or an invalid value or duration
        """
        fault = fault_named(key)
        has = Having(checked_value(fault, value), now + checked_duration(fault, duration_s))
        # Replaced atomically: others read without a lock.
        self._has = {**self._has, key: has}

    def end(self, key: str) -> None:
        """End a fault, or ``all``; ending an inactive one is not an error.

        :raises FaultRefused: an unknown name
        """
        if key != ALL:
            fault_named(key)
        self._has = {other: has for other, has in self._has.items() if ALL != key != other}

    def value(self, key: str, now: float) -> Optional[float]:
        """Return the value of an active fault, else None."""
        has = self._has.get(key)
        return has.value if has is not None and now < has.until else None

    def has(self, key: str, now: float) -> bool:
        """Return whether a fault is active."""
        return self.value(key, now) is not None

    def link(self, now: float) -> Tuple[float, float]:
        """Return delay [s] and share of loss, 0 to 1, of the link, each way."""
        return self.value('delay', now) or 0.0, (self.value('loss', now) or 0.0) / 100.0

    def weaken(self, body: Body, now: float) -> None:
        """Apply the faults of motors and floor to a body."""
        slow = self.value('wheel_slow', now)
        body.left_share = 0.0 if self.has('motor_stuck', now) else \
            1.0 if slow is None else slow / 100.0
        body.slip = math.radians(self.value('drift', now) or 0.0)

    def phrases(self, now: float) -> Tuple[str, ...]:
        """Return the active faults, e.g. "delay each way 0.4 s"; cheap without any."""
        return tuple(ROWS[key].words(has.value) for key, has in self._has.items()
                     if now < has.until)

    def words(self, now: float) -> List[str]:
        """Return the active faults, a phrase each, e.g. "delay each way 0.4 s, 7 s left"."""
        return ['{}{}'.format(ROWS[key].words(has.value), '' if math.isinf(has.until) else
                              ', {:.0f} s left'.format(math.ceil(has.until - now)))
                for key, has in self._has.items() if now < has.until]


def failing_in(words: str) -> Tuple[str, ...]:
    """Return the keys of the faults named in a robot's answer, e.g. "bot1: laser silent"."""
    return tuple(fault.key for fault in FAULTS if fault.label in words)
