# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The time and robot pose of a scan: one rule for stick and tasks.

A scan has the time of its stamp if that comes from the clock of the robot's odometry; else the time
of its receipt, and the newest pose. The clocks of robot and host need not agree.
"""
from collections import deque
import math
from typing import Deque, NamedTuple, Optional, Tuple

from mhri.base.geometry import Pose
from mhri.robots.stamp_age import StampAge

# A scan stamped longer before the newest odometry is too late to use [s].
KEPT_S = 0.5
# A stamp further from that of the newest odometry is invalid, or of another clock [s].
SAME_CLOCK_S = 2.0
_MOST = 100
# Odometry has restarted if it moves or turns further than this between two messages [m, rad], on
# top of the way the robot can have driven in that time, of which this much counts at most [s].
_LEAP_M, _LEAP_RAD, _TURNS_RAD_S, _UNHEARD_S = 0.2, 0.5, 6.0, 1.0
_MAX_SOURCES = 8


class Moment(NamedTuple):
    """The time of a scan [s, of our clock], and the robot's pose (None: its present pose)."""

    at_s: float
    pose: Optional[Pose]


class PoseTrack:
    """The latest poses of a robot with their stamps [s], all of one clock.

    One thread adds poses; another may query them.

    :param most_mps: maximum speed of the robot
    """

    def __init__(self, most_mps: float = 2.0) -> None:
        self._poses: Deque[Tuple[float, Pose]] = deque(maxlen=_MOST)
        self._age = StampAge()
        self._most_mps = most_mps
        self._last: Optional[Tuple[Pose, float, float]] = None
        self._sources: Deque[object] = deque(maxlen=_MAX_SOURCES)

    def follow(self, pose: Pose, heard_s: float, source: object = None,
               stamp_s: float = 0.0) -> bool:
        """Handle a pose, with or without a stamp; return whether odometry has restarted.

        :param heard_s: time of receipt, of our monotonic clock [s]
        :param source: identifies the sender; each sender has its own origin
        :param stamp_s: stamp [s], 0: none
        """
        last, self._last = self._last, (pose, heard_s, stamp_s)
        anew = last is not None and all(source is not one for one in self._sources)
        if last is None or anew:
            self._sources.append(source)
            return anew
        then, then_s, then_stamp_s = last
        passed_s = min(max(heard_s - then_s, stamp_s - then_stamp_s), _UNHEARD_S)
        turned = abs(math.remainder(pose.heading_rad - then.heading_rad, 2.0 * math.pi))
        return (math.hypot(pose.x_m - then.x_m, pose.y_m - then.y_m)
                > _LEAP_M + 1.5 * self._most_mps * passed_s
                or turned > _LEAP_RAD + _TURNS_RAD_S * passed_s)

    def add(self, stamp_s: float, pose: Pose, heard_s: float) -> None:
        """Add a pose; a stamp that does not advance discards all earlier poses.

        :param heard_s: time of receipt, of our monotonic clock [s]
        """
        self._age.late_s(stamp_s, heard_s)
        if self._poses and stamp_s <= self._poses[-1][0]:
            self._poses.clear()
        self._poses.append((stamp_s, pose))
        while self._poses[-1][0] - self._poses[0][0] > KEPT_S and len(self._poses) > 2:
            self._poses.popleft()

    def moment(self, stamp_s: float, heard_s: float) -> Moment:
        """Return the time and pose of a scan received at a time.

        :raises ValueError: it is too late, or two clocks of the robot differ
        """
        poses = tuple(self._poses)
        if not poses or abs(stamp_s - poses[-1][0]) > SAME_CLOCK_S:
            return Moment(heard_s, None)
        behind_s = poses[-1][0] - stamp_s
        if behind_s > KEPT_S:
            raise ValueError('stamped {:.1f} s before the odometry: it comes too late, or the '
                             'clocks of the robot\'s computers are apart'.format(behind_s))
        return Moment(heard_s - self._age.since_s(stamp_s, heard_s), _at(stamp_s, poses))


def _at(stamp_s: float, poses: Tuple[Tuple[float, Pose], ...]) -> Optional[Pose]:
    """Return the pose of the robot at that stamp, None if unknown."""
    for (before_s, before), (after_s, after) in zip(poses, poses[1:]):
        if before_s <= stamp_s <= after_s:
            share = (stamp_s - before_s) / (after_s - before_s)
            turned = math.remainder(after.heading_rad - before.heading_rad, 2.0 * math.pi)
            return Pose(before.x_m + share * (after.x_m - before.x_m),
                        before.y_m + share * (after.y_m - before.y_m),
                        before.heading_rad + share * turned)
    return None
