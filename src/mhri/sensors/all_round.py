# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The scans of all lasers of a robot as one, in the robot's own frame."""
import math
from typing import NamedTuple, Sequence, Tuple

import numpy as np

from mhri.base.geometry import Pose

_BEAMS = 720
_STEP_RAD = 2.0 * math.pi / _BEAMS


class Sweep(NamedTuple):
    """A scan: ranges [m] with NaN for no measurement, angles [rad], 0 ahead, left positive."""

    ranges: np.ndarray
    angle_min: float
    angle_increment: float
    range_max: float


#: The pose of a laser on its robot, and whether it is mounted upside down.
Mount = Tuple[Pose, bool]


def turned(scan: Sweep, mount: Mount) -> Sweep:
    """Return a scan with its angles relative to the robot's heading; distances are unchanged."""
    pose, turned_over = mount
    sign = -1.0 if turned_over else 1.0
    return scan._replace(angle_min=sign * scan.angle_min + pose.heading_rad,
                         angle_increment=sign * scan.angle_increment)


def all_round(scans: Sequence[Tuple[Sweep, Mount]]) -> Sweep:
    """Return the scans of several lasers as one from the robot's centre, with half-degree beams.

    A beam has the nearest point in its direction.
    """
    ranges = np.full(_BEAMS, np.inf)
    for scan, mount in scans:
        seen = turned(scan, mount)
        angles = seen.angle_min + seen.angle_increment * np.arange(len(seen.ranges))
        hit = np.isfinite(seen.ranges)
        x_m = seen.ranges[hit] * np.cos(angles[hit]) + mount[0].x_m
        y_m = seen.ranges[hit] * np.sin(angles[hit]) + mount[0].y_m
        beams = np.rint((np.arctan2(y_m, x_m) + math.pi) / _STEP_RAD).astype(int) % _BEAMS
        np.minimum.at(ranges, beams, np.hypot(x_m, y_m))
    return Sweep(np.where(np.isfinite(ranges), ranges, np.nan), -math.pi, _STEP_RAD,
                 max(scan.range_max for scan, _ in scans))
