# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The faults that a simulated robot can have: a table, and which of them it has now."""
from dataclasses import dataclass
import math
from typing import Dict, List, NamedTuple, Optional, Tuple

# What a link that is down for longer teaches can be had by asking again [s].
MOST_S = 3600.0
ALL = 'all'


@dataclass(frozen=True)
class Fault:
    """A row of the table: ``label`` is what an operator reads.

    Its value is from ``low`` to ``high`` in ``unit``; a fault with ``unit`` '' has none.
    ``timed`` ones end by time alone: nobody could ask them to.
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
    """A fault that cannot be had; the text names what is wrong and what would be right."""


def fault_named(key: str) -> Fault:
    """Return a row of the table.

    :raises FaultRefused: there is none of this name
    """
    if key not in ROWS:
        raise FaultRefused('there is no fault {!r}; there are {}'.format(
            key[:60], ', '.join(ROWS)))
    return ROWS[key]


def checked_value(fault: Fault, value: float) -> float:
    """Return the value that a fault will have; NaN stands for its default.

    :raises FaultRefused: it is out of the fault's range
    """
    if not fault.unit or math.isnan(value):
        return fault.default
    if not fault.low <= value <= fault.high:
        raise FaultRefused('{}: expected a value from {:g} to {:g} {}, got {:g}'.format(
            fault.key, fault.low, fault.high, fault.unit, value))
    return value


def checked_duration(fault: Fault, duration_s: float) -> float:
    """Return how long a fault will last [s], infinity for "until asked to end".

    :raises FaultRefused: it is no such time, or the fault needs one
    """
    if not duration_s <= MOST_S:
        raise FaultRefused('{}: expected a duration from 0 to {:g} s, got {:g}'.format(
            fault.key, MOST_S, duration_s))
    if fault.timed and duration_s == 0.0:
        raise FaultRefused('{}: give a duration: nobody can ask a dead program to come '
                           'back'.format(fault.key))
    return duration_s or math.inf


class Having(NamedTuple):
    """A fault that a robot has: its value, and until when [s of the caller's clock]."""

    value: float
    until: float


class FaultBook:
    """The faults that one robot has now; any thread may ask, one at a time may change it.

    Times are seconds of a clock that never goes back.
    """

    def __init__(self) -> None:
        self._has: Dict[str, Having] = {}

    def begin(self, key: str, value: float, duration_s: float, now: float) -> None:
        """Begin a fault, or replace it: see ``SetFault.srv``.

        :raises FaultRefused: an unknown name, or a value or duration that cannot be
        """
        fault = fault_named(key)
        has = Having(checked_value(fault, value), now + checked_duration(fault, duration_s))
        # Put in place whole: others read without a lock.
        self._has = {**self._has, key: has}

    def end(self, key: str) -> None:
        """End a fault, or ``all``; one that the robot does not have is no mistake.

        :raises FaultRefused: an unknown name
        """
        if key != ALL:
            fault_named(key)
        self._has = {other: has for other, has in self._has.items() if ALL != key != other}

    def value(self, key: str, now: float) -> Optional[float]:
        """Return the value of a fault that the robot has now; None if it does not have it."""
        has = self._has.get(key)
        return has.value if has is not None and now < has.until else None

    def has(self, key: str, now: float) -> bool:
        """Tell whether the robot has a fault now."""
        return self.value(key, now) is not None

    def phrases(self, now: float) -> Tuple[str, ...]:
        """Return what fails now, e.g. "delay each way 0.4 s"; cheap while nothing does."""
        return tuple(ROWS[key].words(has.value) for key, has in self._has.items()
                     if now < has.until)

    def words(self, now: float) -> List[str]:
        """Return what fails now, a phrase each, e.g. "delay each way 0.4 s, 7 s left"."""
        return ['{}{}'.format(ROWS[key].words(has.value), '' if math.isinf(has.until) else
                              ', {:.0f} s left'.format(math.ceil(has.until - now)))
                for key, has in self._has.items() if now < has.until]


def failing_in(words: str) -> Tuple[str, ...]:
    """Return the keys of the faults that a robot's answer names, e.g. "bot1: laser silent"."""
    return tuple(fault.key for fault in FAULTS if fault.label in words)
