# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts the values of a driver's laser scan to a scan for the obstacle brake."""
import math
from typing import Mapping, Optional, Sequence, Tuple

from mhri.base.geometry import Pose
from mhri.base.plausible import thinned
from mhri.sensors.brake import MARGIN_M, Scan
from mhri.sensors.readings import blind_distances, bounds_of, MAX_NEAR_M, no_return_of, read_ranges

# A finer scan is thinned; the nearest of adjacent beams is kept.
MAX_BEAMS = 400
# A laser that measures this close to the robot has no blind distance [m].
_EDGE_M = MARGIN_M + 0.05
_MIDDLE = Pose(0.0, 0.0, 0.0)


def laser_scan(ranges: Sequence[float], angles: Tuple[float, float], limits: Tuple[float, float],
               no_return: Mapping[Optional[float], Tuple[float, ...]], radius_m: float,
               mount: Tuple[Pose, bool] = (_MIDDLE, False)) -> Scan:
    """Return a scan.

    :param ranges: as the driver sends them
    :param angles: angle of the first beam, and increment [rad]
    :param limits: ``range_min`` and ``range_max`` [m]
    :param no_return: see :func:`mhri.sensors.readings.no_return_of`
    :param radius_m: of the disc around all of the robot
    :param mount: pose of the laser, and whether it is mounted upside down
    """
    first, step = angles
    place, turned_over = mount
    low, high = bounds_of(*limits)
    readings = read_ranges(ranges, *limits, no_return=no_return_of(no_return, limits[1]))
    # Obstacles too near to be measured matter only if they can be outside the robot.
    aside_m = math.hypot(place.x_m, place.y_m)
    near_m = max(low, radius_m + _EDGE_M + aside_m) if low + aside_m > radius_m else 0.0
    near_m = near_m if near_m <= MAX_NEAR_M else math.inf
    blind_m = blind_distances(readings, step, near_m, radius_m)
    met, together = thinned(readings.ranges, MAX_BEAMS)
    blind = thinned(blind_m, MAX_BEAMS)[0] if blind_m.any() else None
    first, step = first + 0.5 * (together - 1) * step, together * step
    if turned_over:
        first, step = -first, -step
    if step < 0.0:
        # Mounted upside down, its angles grow to the right.
        met, first, step = met[::-1], first + (len(met) - 1) * step, -step
        blind = None if blind is None else blind[::-1]
    return Scan(met, first, step, low, high, place, blind, near_m if near_m < math.inf else 0.0,
                readings.sure_share)
