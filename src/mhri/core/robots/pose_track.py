# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where a robot was a moment ago, by the stamps of its odometry."""
from collections import deque
import math
from typing import Deque, Optional, Tuple

from mhri.core.robots.mocap import Pose

# What was measured longer before the newest odometry has another clock, or is late beyond use [s].
KEPT_S = 0.5
_MOST = 100


class PoseTrack:
    """The last poses of a robot, each with its stamp [s]: of one clock, whichever it is."""

    def __init__(self) -> None:
        self._poses: Deque[Tuple[float, Pose]] = deque(maxlen=_MOST)

    def add(self, stamp_s: float, pose: Pose) -> None:
        """Take in a pose; a stamp that goes back begins anew."""
        if self._poses and stamp_s <= self._poses[-1][0]:
            self._poses.clear()
        self._poses.append((stamp_s, pose))
        while self._poses[-1][0] - self._poses[0][0] > KEPT_S and len(self._poses) > 2:
            self._poses.popleft()

    def at(self, stamp_s: float) -> Optional[Pose]:
        """Return where the robot was then, None where these poses do not tell."""
        if not self._poses or self._poses[-1][0] - stamp_s > KEPT_S:
            return None
        for (before_s, before), (after_s, after) in zip(self._poses, list(self._poses)[1:]):
            if before_s <= stamp_s <= after_s:
                share = (stamp_s - before_s) / (after_s - before_s)
                turned = math.remainder(after.heading_rad - before.heading_rad, 2.0 * math.pi)
                return Pose(before.x_m + share * (after.x_m - before.x_m),
                            before.y_m + share * (after.y_m - before.y_m),
                            before.heading_rad + share * turned)
        return None
