# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a sensor can possibly report: one table of bounds, far beyond any real robot.

A value beyond its bound comes from a fault (bytes of another type, a driver that divides by zero)
or from somebody who means harm. It is no measurement: it counts as NaN, as if it had not arrived.
NaN itself is no fault: drivers write it for what they do not measure.
"""
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np


class Bound(NamedTuple):
    """The least and the greatest possible value, and their unit."""

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

#: The fastest gyroscopes read 350 rad/s and shock sensors 5,000 g; a place may be in a national
#: grid, whose numbers reach 10,000 km; a battery's charge comes as fraction or as percent.
BOUNDS: Dict[str, Bound] = {
    QUATERNION: _within(10.0, ''),
    ANGLE: _within(1e6, 'rad'),
    ANGULAR_VELOCITY: _within(1e3, 'rad/s'),
    ACCELERATION: _within(5e4, 'm/s^2'),
    SPEED: _within(300.0, 'm/s'),
    PLACE: _within(1e7, 'm'),
    RANGE: Bound(0.0, 1e4, 'm'),
    BATTERY: Bound(0.0, 110.0, '%'),
}
#: A full turn in steps of 0.0036 degrees; no laser has more beams.
MOST_BEAMS = 100_000


def can_be(kind: str, value: float) -> bool:
    """Tell whether a sensor can report a number; NaN it cannot."""
    bound = BOUNDS[kind]
    return bound.least <= value <= bound.greatest


def sifted(kinds: Sequence[str], values: Sequence[float]) -> Tuple[List[float], Optional[str]]:
    """Return (values with NaN for each impossible one, the first of those in words or None).

    :param kinds: key of :data:`BOUNDS` for each value
    """
    kept, problem = list(values), None
    for index, (kind, value) in enumerate(zip(kinds, values)):
        # Both comparisons are false for NaN, which passes unnoticed.
        bound = BOUNDS[kind]
        if value < bound.least or value > bound.greatest:
            kept[index] = float('nan')
            problem = problem or '{} of {:.3g} {}'.format(kind, value, bound.unit).rstrip()
    return kept, problem


def beams_problem(count: int, angle_min: float, angle_increment: float) -> Optional[str]:
    """Return in words why a scan is impossible, None if it is possible.

    :param count: number of its ranges
    :param angle_min: of the first of them [rad]
    :param angle_increment: from one to the next [rad]
    """
    if count > MOST_BEAMS:
        return '{} beams'.format(count)
    for value in (angle_min, angle_increment):
        if not can_be(ANGLE, value):
            return 'beams at an angle of {:.3g} rad'.format(value)
    return None


def thinned(ranges: np.ndarray, most: int) -> Tuple[np.ndarray, int]:
    """Return (at most ``most`` ranges, how many beams each stands for).

    Of beams taken together the nearest counts: nothing that the robot could hit is left out.

    :param ranges: array [m], NaN for no measurement
    """
    together = max(1, -(-len(ranges) // most))
    if together == 1:
        return ranges, 1
    padded = np.full(-(-len(ranges) // together) * together, np.nan)
    padded[:len(ranges)] = ranges
    return np.fmin.reduce(padded.reshape(-1, together), axis=1), together
