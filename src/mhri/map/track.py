# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recent poses of a robot, to draw scans from where they were measured."""
import collections
import math
from typing import Deque, Optional, Tuple

from mhri.base.geometry import Pose

# Number of poses to keep: two seconds of a screen at 20 Hz.
_MOST = 40


class Track:
    """The newest odometry poses of a robot with their times of receipt."""

    def __init__(self) -> None:
        self._poses: Deque[Tuple[float, Pose]] = collections.deque(maxlen=_MOST)

    def add(self, at_s: float, pose: Pose) -> None:
        """Add a pose, unless it is not newer than the last."""
        if not self._poses or at_s > self._poses[-1][0] + 1e-3:
            self._poses.append((at_s, pose))

    def at(self, at_s: float) -> Optional[Pose]:
        """Return the pose at a time, clipped to the known range; None if unknown."""
        before: Optional[Tuple[float, Pose]] = None
        for row in self._poses:
            if row[0] >= at_s:
                return row[1] if before is None else _between(before, row, at_s)
            before = row
        return None if before is None else before[1]


def _between(one: Tuple[float, Pose], other: Tuple[float, Pose], at_s: float) -> Pose:
    """Return the pose between two, at a time between theirs."""
    share = (at_s - one[0]) / (other[0] - one[0])
    turned = math.remainder(other[1].heading_rad - one[1].heading_rad, 2.0 * math.pi)
    return Pose(one[1].x_m + share * (other[1].x_m - one[1].x_m),
                one[1].y_m + share * (other[1].y_m - one[1].y_m),
                one[1].heading_rad + share * turned)
