# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""When a robot's scan was made, and where the robot was then: the one rule, for stick and tasks.

A scan counts from its stamp, where that is by the clock which stamps the robot's odometry; else
from its receipt, where the robot was heard last. Our clock need not agree with the robot's.
"""
from collections import deque
import math
from typing import Deque, NamedTuple, Optional, Tuple

from mhri.base.mocap import Pose
from mhri.robots.stamp_age import StampAge

# What was measured longer before the newest odometry is late beyond use [s].
KEPT_S = 0.5
# A stamp that is further from that of the newest odometry is none, or by another clock [s].
SAME_CLOCK_S = 2.0
_MOST = 100
# Odometry that goes or turns further between two messages has begun anew [m, rad], besides what
# the robot may have moved meanwhile; nobody knows what it did for longer than this [s].
_LEAP_M, _LEAP_RAD, _TURNS_RAD_S, _UNHEARD_S = 0.2, 0.5, 6.0, 1.0
_MOST_SOURCES = 8


class Moment(NamedTuple):
    """When a scan was made [s, of our clock], and where the robot was, None: where it is now."""

    at_s: float
    pose: Optional[Pose]


class PoseTrack:
    """The last poses of a robot, each with its stamp [s]: of one clock, whichever it is.

    Poses come from one thread; another may ask.

    :param most_mps: the most that the robot drives
    """

    def __init__(self, most_mps: float = 2.0) -> None:
        self._poses: Deque[Tuple[float, Pose]] = deque(maxlen=_MOST)
        self._age = StampAge()
        self._most_mps = most_mps
        self._last: Optional[Tuple[Pose, float, float]] = None
        self._sources: Deque[object] = deque(maxlen=_MOST_SOURCES)

    def follow(self, pose: Pose, heard_s: float, source: object = None,
               stamp_s: float = 0.0) -> bool:
        """Take in a pose, with or without a stamp; return whether odometry has begun anew.

        :param heard_s: when, of our clock, which never goes back [s]
        :param source: stands for who said it: another than before has another origin
        :param stamp_s: what is heard late was not said at that time [s], 0: it has no stamp
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
        """Take in a pose; a stamp that goes back begins anew.

        :param heard_s: when, of our clock, which never goes back [s]
        """
        self._age.late_s(stamp_s, heard_s)
        if self._poses and stamp_s <= self._poses[-1][0]:
            self._poses.clear()
        self._poses.append((stamp_s, pose))
        while self._poses[-1][0] - self._poses[0][0] > KEPT_S and len(self._poses) > 2:
            self._poses.popleft()

    def moment(self, stamp_s: float, heard_s: float) -> Moment:
        """Return when and where a scan was made that was heard at a time.

        :raises ValueError: it is late beyond use, or two clocks of the robot are apart
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
    """Return where the robot was then, None where these poses do not tell."""
    for (before_s, before), (after_s, after) in zip(poses, poses[1:]):
        if before_s <= stamp_s <= after_s:
            share = (stamp_s - before_s) / (after_s - before_s)
            turned = math.remainder(after.heading_rad - before.heading_rad, 2.0 * math.pi)
            return Pose(before.x_m + share * (after.x_m - before.x_m),
                        before.y_m + share * (after.y_m - before.y_m),
                        before.heading_rad + share * turned)
    return None
