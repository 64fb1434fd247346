# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The meaning of each beam of a laser scan: measured, "nothing there", or not measured at all.

One rule for the brakes, the map and the views; the guard on the robot has a copy of it. A robot's
type defines the values for "nothing there" (``no_return``); the default is +inf, by REP 117. They
are checked before the bounds. A range equal to ``range_max`` means "nothing there", too (Stage,
older Gazebo; amcl reads it the same way). Everything else outside the bounds was not measured: NaN,
-inf, 0, negative, below ``range_min`` or above ``range_max``.
"""
from collections import deque
import math
from typing import Deque, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mhri.base.geometry import Pose
from mhri.base.plausible import BOUNDS, RANGE

# The value of a beam without a return, by REP 117.
NO_RETURN = (math.inf,)
# A laser whose share of measuring beams falls from this to nothing within this time is dead [s].
FELL_FROM, FELL_WITHIN_S = 1.0 / 3.0, 1.0
# Unless the robot has turned by this share of the field of view.
TURNED_SHARE = 0.25
# "Nothing there" is not used from a laser with a longer blind distance [m].
MAX_NEAR_M = 1.5
_SAME_M = 1e-3


class Readings(NamedTuple):
    """The beams of a scan: ranges [m], NaN if not measured, and masks of "nothing there".

    ``free``: by a value that only a working laser sends; ``unsure``: by one that a dead laser, or
    one with an obstacle too close to it, may send as well.
    """

    ranges: np.ndarray
    free: np.ndarray
    unsure: np.ndarray

    @property
    def sure_share(self) -> float:
        """The share of beams that a dead laser would not send."""
        sure = np.isfinite(self.ranges) | self.free
        return float(sure.mean()) if len(sure) else 0.0


def no_return_of(values: Mapping[Optional[float], Tuple[float, ...]],
                 range_max: float) -> Tuple[float, ...]:
    """Return the values that mean "nothing there" from a laser with that maximum range.

    :param values: {range_max of a laser [m], None for any other: values}
    """
    for reach_m, found in values.items():
        if reach_m is not None and abs(reach_m - range_max) < _SAME_M:
            return found
    return values.get(None, NO_RETURN)


def bounds_of(range_min: float, range_max: float) -> Tuple[float, float]:
    """Return the stated minimum and maximum range of a sensor [m].

    NaN and absurd values are replaced by general bounds.
    """
    bound = BOUNDS[RANGE]
    return (range_min if range_min > bound.least else bound.least,
            range_max if range_max < bound.greatest else bound.greatest)


def read_ranges(ranges: Sequence[float], range_min: float, range_max: float,
                no_return: Sequence[float] = NO_RETURN) -> Readings:
    """Return the :class:`Readings` of a scan.

    :param range_min: see :func:`bounds_of`
    :param no_return: values that mean "nothing there"
    """
    low, high = bounds_of(range_min, range_max)
    found = np.array(ranges, dtype=float)
    with np.errstate(invalid='ignore'):
        free = (found == high) & (high > 0.0)
        unsure = np.zeros(len(found), dtype=bool)
        for value in no_return:
            if value == math.inf:
                free |= found == value
            else:
                unsure |= np.isclose(found, value, rtol=1e-6, atol=1e-9, equal_nan=True)
        unsure &= ~free
        found[free | unsure | ~((found >= low) & (found < high) & (found > 0.0))] = np.nan
    return Readings(found, free, unsure)


def blind_distances(readings: Readings, step_rad: float, near_m: float,
                    half_m: float) -> np.ndarray:
    """Return the blind distance of each beam [m], inf for an unusable beam.

    An obstacle nearer than ``near_m`` can hide in an unsure beam, unless beams on both sides of it
    measured far beyond, so close to each other that nothing as wide as the robot fits in between.

    :param near_m: 0 if anything too near to be measured is within the robot; inf if unsure beams
        are unusable
    :param half_m: half the width of the robot
    """
    measured = np.isfinite(readings.ranges)
    found = np.where(measured | readings.free, 0.0, np.where(readings.unsure, near_m, np.inf))
    if not 0.0 < near_m < math.inf or not readings.unsure.any() or not step_rad:
        return found
    most = 2 * int(math.asin(min(1.0, half_m / near_m)) / abs(step_rad))
    with np.errstate(invalid='ignore'):
        far = (readings.ranges >= 2.0 * near_m) | readings.free
    count = len(found)
    if abs(step_rad) * (count + 1) >= 2.0 * math.pi:
        far = np.concatenate((far, far, far))
        begin = count
    else:
        begin = 0
    places = np.arange(len(far))
    before = np.maximum.accumulate(np.where(far, places, -most - 1))
    after = np.minimum.accumulate(np.where(far, places, len(far) + most)[::-1])[::-1]
    flanked = (after - before <= most)[begin:begin + count]
    found[flanked & readings.unsure] = 0.0
    return found


class LaserLife:
    """Judges whether a laser is alive if a dead one may send its "nothing there" as well.

    It counts as dead before its first measurement; if it was not heard for a second; and after the
    share of its measuring beams fell from a third to zero within a second while the robot hardly
    turned. It is alive once it measures again. A gradual fall means open space, such as a hall.
    """

    def __init__(self) -> None:
        self._alive = False
        self._past: Deque[Tuple[float, float, Pose]] = deque()

    def look(self, sure_share: float, pose: Pose, at_s: float, field_rad: float) -> bool:
        """Handle a scan; return whether the laser is alive.

        :param pose: of the robot, by its odometry
        :param field_rad: its field of view
        """
        while self._past and at_s - self._past[0][0] > FELL_WITHIN_S:
            self._past.popleft()
        self._alive = sure_share > 0.0 or (
            self._alive and bool(self._past) and not any(
                share >= FELL_FROM and TURNED_SHARE * field_rad > abs(
                    math.remainder(pose.heading_rad - then.heading_rad, 2.0 * math.pi))
                for _, share, then in self._past))
        self._past.append((at_s, sure_share, pose))
        return self._alive
