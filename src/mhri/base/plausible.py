# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bounds of plausible sensor values: one table, far beyond any real robot.

A value beyond its bound comes from a fault (bytes of another type, a driver that divides by zero)
or from an attack. It is replaced by NaN, as if it had not arrived. NaN itself is not a fault:
drivers send it for a missing measurement.
"""
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np


class Bound(NamedTuple):
    """The minimum and maximum possible value, and their unit."""

    least: float
    greatest: float
    unit: str


def _within(greatest: float, unit: str) -> Bound:
    return Bound(-greatest, greatest, unit)


QUATERNION = 'quaternion'
ANGLE = 'angle'
ANGULAR_VELOCITY = 'angular velocity'
ACCELERATION = 'acceleration'
SPEED = 'speed'
PLACE = 'place'
RANGE = 'range'
BATTERY = 'battery'
SENSOR = 'sensor'

#: The fastest gyroscopes read 350 rad/s and shock sensors 5,000 g; a position may be in a national
#: grid, whose coordinates reach 10,000 km; a battery's charge is a fraction or a percentage.
BOUNDS: Dict[str, Bound] = {
    QUATERNION: _within(10.0, ''),
    ANGLE: _within(1e6, 'rad'),
    ANGULAR_VELOCITY: _within(1e3, 'rad/s'),
    ACCELERATION: _within(5e4, 'm/s^2'),
    SPEED: _within(300.0, 'm/s'),
    PLACE: _within(1e7, 'm'),
    RANGE: Bound(0.0, 1e4, 'm'),
    BATTERY: Bound(0.0, 110.0, '%'),
    # Of any kind, in any unit; beyond the limits that a type may name.
    SENSOR: _within(1e12, ''),
}
#: A full turn in steps of 0.0036 degrees; no laser has more beams.
MAX_BEAMS = 100_000


def can_be(kind: str, value: float) -> bool:
    """Return whether a value is plausible; False for NaN."""
    bound = BOUNDS[kind]
    return bound.least <= value <= bound.greatest


def sifted(kinds: Sequence[str], values: Sequence[float]) -> Tuple[List[float], Optional[str]]:
    """Return (values with NaN for each impossible one, description of the first of those or None).

    :param kinds: key of :data:`BOUNDS` for each value
    """
    kept, problem = list(values), None
    for index, (kind, value) in enumerate(zip(kinds, values)):
        # Both comparisons are false for NaN, which is kept.
        bound = BOUNDS[kind]
        if value < bound.least or value > bound.greatest:
            kept[index] = float('nan')
            problem = problem or '{} of {:.3g} {}'.format(kind, value, bound.unit).rstrip()
    return kept, problem


def beams_problem(count: int, angle_min: float, angle_increment: float) -> Optional[str]:
    """Describe why a scan is impossible, None if it is possible.

    :param count: number of its ranges
    :param angle_min: angle of the first range [rad]
    :param angle_increment: angle between two ranges [rad]
    """
    if count > MAX_BEAMS:
        return '{} beams'.format(count)
    for value in (angle_min, angle_increment):
        if not can_be(ANGLE, value):
            return 'beams at an angle of {:.3g} rad'.format(value)
    return None


def thinned(ranges: np.ndarray, most: int) -> Tuple[np.ndarray, int]:
    """Return (at most ``most`` ranges, number of beams per range).

    Each group of beams keeps its nearest, so that no obstacle is lost.

    :param ranges: array [m], NaN for no measurement
    """
    together = max(1, -(-len(ranges) // most))
    if together == 1:
        return ranges, 1
    padded = np.full(-(-len(ranges) // together) * together, np.nan)
    padded[:len(ranges)] = ranges
    return np.fmin.reduce(padded.reshape(-1, together), axis=1), together
