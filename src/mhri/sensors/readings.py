# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What each beam of a laser scan says: measured, "nothing there", or not measured at all.

One rule for the brakes, the map and the views; the guard on the robot has a copy of it. A robot's
type says which values mean "nothing there" (``no_return``), REP 117 where it is silent: +inf. They
are looked for before the bounds. A range equal to ``range_max`` is no return, either (Stage, older
Gazebo, as amcl takes it). Everything else outside the bounds was not measured: NaN, -inf, 0,
negative, below ``range_min`` or above ``range_max``.
"""
from collections import deque
import math
from typing import Deque, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mhri.base.mocap import Pose
from mhri.base.plausible import BOUNDS, RANGE

# No beam returned, by REP 117.
NO_RETURN = (math.inf,)
# A laser whose share of measuring beams falls from this to nothing within this time is dead [s].
FELL_FROM, FELL_WITHIN_S = 1.0 / 3.0, 1.0
# Unless the robot has turned by so much of its field of view; or, if it was not looked at for
# longer, has moved by so much [m].
TURNED_SHARE, MOVED_M = 0.25, 0.5
# A laser whose least range is greater tells nothing by "nothing there" [m].
MOST_NEAR_M = 1.5
_SAME_M = 1e-3


class Readings(NamedTuple):
    """What beams say: ranges [m], NaN where nothing was measured; and where nothing is there.

    ``free`` says so by a value that only a working laser sends; ``unsure`` by one that may as well
    come from a dead one, or from what is too near.
    """

    ranges: np.ndarray
    free: np.ndarray
    unsure: np.ndarray

    @property
    def sure_share(self) -> float:
        """Share of the beams that a dead laser would not send."""
        sure = np.isfinite(self.ranges) | self.free
        return float(sure.mean()) if len(sure) else 0.0


def no_return_of(values: Mapping[Optional[float], Tuple[float, ...]],
                 range_max: float) -> Tuple[float, ...]:
    """Return the values that mean "nothing there" from a laser of that reach.

    :param values: {range_max of a laser [m], None for any other: values}
    """
    for reach_m, found in values.items():
        if reach_m is not None and abs(reach_m - range_max) < _SAME_M:
            return found
    return values.get(None, NO_RETURN)


def bounds_of(range_min: float, range_max: float) -> Tuple[float, float]:
    """Return what a sensor says it can measure, at least and at most [m].

    NaN and absurd values do not count.
    """
    bound = BOUNDS[RANGE]
    return (range_min if range_min > bound.least else bound.least,
            range_max if range_max < bound.greatest else bound.greatest)


def read_ranges(ranges: Sequence[float], range_min: float, range_max: float,
                no_return: Sequence[float] = NO_RETURN) -> Readings:
    """Return what the beams of a scan say.

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
    """Return up to which distance each beam says nothing [m]: inf where it says nothing at all.

    What is nearer than ``near_m`` may hide behind a beam that is unsure, unless beams measured far
    beyond it close by on both sides: no thing as wide as the robot is there.

    :param near_m: 0 where nothing that is too near could be outside the robot; inf where such a
        beam tells nothing
    :param half_m: half the width of the robot
    """
    measured = np.isfinite(readings.ranges)
    found = np.where(measured | readings.free, 0.0, np.where(readings.unsure, near_m, np.inf))
    if not 0.0 < near_m < math.inf or not readings.unsure.any() or not step_rad:
        return found
    slack = int(math.asin(min(1.0, half_m / near_m)) / abs(step_rad))
    with np.errstate(invalid='ignore'):
        far = (readings.ranges >= 2.0 * near_m) | readings.free
    count = len(found)
    if abs(step_rad) * (count + 1) >= 2.0 * math.pi:
        far = np.concatenate((far, far, far))
        begin = count
    else:
        begin = 0
    places = np.arange(len(far))
    before = np.maximum.accumulate(np.where(far, places, -len(far)))
    after = np.minimum.accumulate(np.where(far, places, 2 * len(far))[::-1])[::-1]
    flanked = ((places - before <= slack) & (after - places <= slack))[begin:begin + count]
    found[flanked & readings.unsure] = 0.0
    return found


class LaserLife:
    """Whether a laser is alive whose "nothing there" may as well come from a dead one.

    It is not before it has measured anything, nor after the share of its measuring beams fell
    from a third to nothing within a second, though the robot hardly turned, until it measures
    again. A share that falls gradually is a hall.
    """

    def __init__(self) -> None:
        self._measured = False
        self._dead = False
        self._past: Deque[Tuple[float, float, Pose]] = deque()

    def look(self, sure_share: float, pose: Pose, at_s: float, field_rad: float) -> bool:
        """Return whether it is alive, given a scan that says "nothing there" where it is unsure.

        :param pose: of the robot, by its odometry
        :param field_rad: its field of view
        """
        if sure_share > 0.0:
            self._measured, self._dead = True, False
        elif not self._dead:
            self._dead = not self._measured or self._fell(pose, at_s, field_rad)
        self._past.append((at_s, sure_share, pose))
        # The newest before stays: it may have been looked at last long ago.
        while len(self._past) > 2 and at_s - self._past[0][0] > FELL_WITHIN_S:
            self._past.popleft()
        return not self._dead

    def _fell(self, pose: Pose, at_s: float, field_rad: float) -> bool:
        for number, (then_s, share, then) in enumerate(reversed(self._past)):
            late = at_s - then_s > FELL_WITHIN_S
            if late and (number or math.hypot(pose.x_m - then.x_m, pose.y_m - then.y_m) > MOVED_M):
                break
            turned = abs(math.remainder(pose.heading_rad - then.heading_rad, 2.0 * math.pi))
            if share >= FELL_FROM and turned < TURNED_SHARE * field_rad:
                return True
        return False
