# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake of a robot that is driven by hand, while the operator asks for it."""
import math
from typing import Optional, Tuple

from mhri.base.brake_view import CANNOT, NO_PLACE, NO_SCAN, OFF, ON, SLOWS, UNSEEN
from mhri.base.limits import Velocity, ZERO
from mhri.base.mocap import Pose
from mhri.sensors.brake import (
    braked, CRAWL_MPS, free_way, MARGIN_M, reach_of, REACTION_S, Scan, SCAN_OLD_S, seen_speed,
    Surroundings, Unplaced)

_SLOWER_MPS = 0.005
# A gate asks at least so often while its robot is driven [s].
_ASKS_S = 0.3


class StickBrake:
    """What a robot's laser or depth camera meets, and what is left of a command.

    A scan may be taken in on one thread while another asks what is allowed; each is brief. Times
    are seconds of a clock that never goes back.

    :param radius_m: of the disc around all of the robot
    :param has_eye: whether robots of its type have one of them
    """

    def __init__(self, radius_m: float, has_eye: bool) -> None:
        self._radius_m = radius_m
        self._has_eye = has_eye
        self._asked = self._remembers = False
        self._seen = Surroundings(radius_m)
        self._unplaced = Unplaced()
        self._pose: Optional[Pose] = None
        self._scan_at: Optional[float] = None
        self._wanted = ZERO
        self._slowed_at = -math.inf
        self._unseen = False

    @property
    def asked(self) -> bool:
        """Whether it is asked for."""
        return self._asked

    @property
    def reads(self) -> bool:
        """Whether it is asked for and needs what looks to be read."""
        return self._asked and self._has_eye

    @property
    def remembers(self) -> bool:
        """Whether it was ever asked for: then it needs odometry, to know where what it saw is."""
        return self._remembers

    def ask(self, asked: bool) -> None:
        """Switch it on or off; what was met before is remembered, but nobody looks there now."""
        if asked and not self._asked:
            self._scan_at = None
        self._asked, self._slowed_at = asked, -math.inf
        self._remembers |= self.reads

    def move(self, pose: Pose, anew: bool = False) -> None:
        """Take in where the robot is by its odometry.

        :param anew: odometry has jumped, so nobody knows where what was seen before is
        """
        if self._pose is None or anew:
            self._seen.clear()
            self._scan_at = None
        self._pose = pose

    def see(self, scan: Scan, at_s: float, pose: Optional[Pose] = None, laser: str = '') -> None:
        """Take in a scan, see :class:`mhri.robots.pose_track.PoseTrack`.

        :param at_s: when it was made
        :param pose: where the robot was then; None: where it was heard last
        :param laser: which one made it, on a robot that has several
        """
        self._unplaced.place(laser)
        pose = (pose or self._pose) if self._pose is not None else None
        if pose is None:
            # Without odometry nothing can be remembered: it would move along with the robot.
            self._seen.clear()
        if self._seen.see(scan, pose or _HERE, at_s, laser):
            self._scan_at = at_s if self._scan_at is None else max(at_s, self._scan_at)

    def hear_unplaced(self, laser: str, now: float) -> None:
        """Take in that a laser was heard of which nobody says where it sits."""
        self._unplaced.hear(laser, now)

    def allow(self, velocity: Velocity, now: float) -> Velocity:
        """Return what is left of a command; turning on the spot always is."""
        self._wanted, self._slowed_at = velocity, -math.inf
        if not self.reads or velocity.linear_mps == 0.0:
            return velocity
        age_s, here = self._age(now), self._pose or _HERE
        reach_m = reach_of(velocity.linear_mps, self._radius_m, age_s or 0.0)
        looks, points = self._seen.looks(here, reach_m), self._seen.around(here, reach_m)
        crawl_mps = 0.0 if self._unplaced.any(now) else CRAWL_MPS
        allowed = braked(velocity, points, self._radius_m, age_s, looks, crawl_mps)
        if age_s is not None and abs(velocity.linear_mps) - abs(allowed.linear_mps) > _SLOWER_MPS:
            self._slowed_at = now
            seen_mps = seen_speed(velocity, self._radius_m + MARGIN_M, REACTION_S + age_s, looks,
                                  crawl_mps)
            self._unseen = abs(seen_mps) - abs(allowed.linear_mps) <= _SLOWER_MPS
        return allowed

    def state(self, now: float) -> Tuple[str, float]:
        """Return (one of :data:`WORDS`, way to what slows it down [m], NaN while nothing does)."""
        if not self._asked:
            return OFF, math.nan
        if not self._has_eye:
            return CANNOT, math.nan
        age_s = self._age(now)
        fresh = age_s is not None and age_s <= SCAN_OLD_S
        slows = fresh and now - self._slowed_at <= _ASKS_S
        if not slows or self._unseen:
            if self._unplaced.any(now):
                return NO_PLACE, math.nan
            return (UNSEEN if slows else ON) if fresh else NO_SCAN, math.nan
        # From the robot itself: the brake keeps a margin around it.
        points = self._seen.around(self._pose or _HERE)
        return SLOWS, free_way(points, self._radius_m + MARGIN_M, self._wanted) + MARGIN_M

    def _age(self, now: float) -> Optional[float]:
        return None if self._scan_at is None else now - self._scan_at


_HERE = Pose(0.0, 0.0, 0.0)
