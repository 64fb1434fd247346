# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the lasers of one robot have met, as one scan in the robot's own frame."""
import math
from typing import NamedTuple, Sequence, Tuple

import numpy as np

from mhri.base.mocap import Pose

_BEAMS = 720
_STEP_RAD = 2.0 * math.pi / _BEAMS


class Sweep(NamedTuple):
    """A scan: ranges [m] with NaN for no measurement, angles [rad], 0 ahead, left positive."""

    ranges: np.ndarray
    angle_min: float
    angle_increment: float
    range_max: float


#: Where a laser sits on its robot, and whether it is mounted upside down.
Mount = Tuple[Pose, bool]


def turned(scan: Sweep, mount: Mount) -> Sweep:
    """Return a scan with its angles counted from the robot's own ahead; distances stay."""
    pose, turned_over = mount
    sign = -1.0 if turned_over else 1.0
    return scan._replace(angle_min=sign * scan.angle_min + pose.heading_rad,
                         angle_increment=sign * scan.angle_increment)


def all_round(scans: Sequence[Tuple[Sweep, Mount]]) -> Sweep:
    """Return several lasers' scans as one, measured from the robot's middle, half a degree a beam.

    The nearest of what lies in the direction of a beam counts.
    """
    ranges = np.full(_BEAMS, np.inf)
    for scan, mount in scans:
        seen = turned(scan, mount)
        angles = seen.angle_min + seen.angle_increment * np.arange(len(seen.ranges))
        met = np.isfinite(seen.ranges)
        x_m = seen.ranges[met] * np.cos(angles[met]) + mount[0].x_m
        y_m = seen.ranges[met] * np.sin(angles[met]) + mount[0].y_m
        beams = np.rint((np.arctan2(y_m, x_m) + math.pi) / _STEP_RAD).astype(int) % _BEAMS
        np.minimum.at(ranges, beams, np.hypot(x_m, y_m))
    return Sweep(np.where(np.isfinite(ranges), ranges, np.nan), -math.pi, _STEP_RAD,
                 max(scan.range_max for scan, _ in scans))
