# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake for manual driving, active while the operator requests it."""
import math
from typing import Optional, Tuple

from mhri.base.brake_view import CANNOT, OFF, ON
from mhri.base.geometry import Pose
from mhri.base.limits import Velocity, ZERO
from mhri.base.reasons import NO_PLACE, NO_SCAN, SLOWS, UNSEEN
from mhri.sensors.brake import (
    braked, CRAWL_MPS, free_way, MARGIN_M, reach_of, REACTION_S, Scan, SCAN_OLD_S, seen_velocity,
    Surroundings, Unplaced)

_SLOWER_MPS = 0.005
# Longest interval between two calls of StickBrake.allow while the robot is driven [s].
_ASKS_S = 0.3


class StickBrake:
    """Limits the commands of the stick by the scans of a robot's laser or depth camera.

    Scans may be added on one thread while another one calls :meth:`allow`; both are brief. Times
    are seconds of a monotonic clock.

    :param radius_m: radius of the disc that encloses the robot
    :param has_eye: whether robots of its type have a laser or depth camera
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
        """Whether the brake is requested."""
        return self._asked

    @property
    def reads(self) -> bool:
        """Whether the brake is requested and needs the robot's scans."""
        return self._asked and self._has_eye

    @property
    def remembers(self) -> bool:
        """Whether it was ever requested: then it needs odometry to locate remembered obstacles."""
        return self._remembers

    def ask(self, asked: bool) -> None:
        """Switch the brake on or off; obstacles are remembered, but a new scan is required."""
        if asked and not self._asked:
            self._scan_at = None
        self._asked, self._slowed_at = asked, -math.inf
        self._remembers |= self.reads

    def move(self, pose: Optional[Pose], anew: bool = False) -> None:
        """Handle the robot's pose by its odometry, None without a heading.

        :param anew: whether odometry has jumped, which invalidates earlier obstacles
        """
        if anew or (pose is None) is not (self._pose is None):
            self._seen.clear()
            self._scan_at = None
        self._pose = pose

    def see(self, scan: Scan, at_s: float, pose: Optional[Pose] = None, laser: str = '') -> None:
        """Handle a scan, see :class:`mhri.robots.pose_track.PoseTrack`.

        :param at_s: time of the measurement
        :param pose: the robot's pose at that time, None for its last pose
        :param laser: the laser that measured it, on a robot with several
        """
        self._unplaced.place(laser)
        pose = (pose or self._pose) if self._pose is not None else None
        if pose is None:
            # Without odometry no obstacle can be remembered: it would move along with the robot.
            self._seen.clear()
        if self._seen.see(scan, pose or _HERE, at_s, laser):
            self._scan_at = at_s if self._scan_at is None else max(at_s, self._scan_at)

    def on_unplaced_scan(self, laser: str, now: float) -> None:
        """Handle a scan of a laser whose pose on the robot is unknown."""
        self._unplaced.on_scan(laser, now)

    def allow(self, velocity: Velocity, now: float) -> Velocity:
        """Return a command reduced by the brake; turning on the spot is never reduced."""
        self._wanted, self._slowed_at = velocity, -math.inf
        speed_mps = velocity.speed_mps
        if not self.reads or speed_mps == 0.0:
            return velocity
        age_s, here = self._age(now), self._pose or _HERE
        reach_m = reach_of(speed_mps, self._radius_m, age_s or 0.0)
        looks, points = self._seen.looks(here, reach_m), self._seen.around(here, reach_m)
        crawl_mps = 0.0 if self._unplaced.any(now) else CRAWL_MPS
        allowed = braked(velocity, points, self._radius_m, age_s, looks, crawl_mps)
        if age_s is not None and speed_mps - allowed.speed_mps > _SLOWER_MPS:
            self._slowed_at = now
            seen = seen_velocity(velocity, self._radius_m + MARGIN_M, REACTION_S + age_s, looks,
                                 crawl_mps)
            self._unseen = seen.speed_mps - allowed.speed_mps <= _SLOWER_MPS
        return allowed

    def state(self, now: float) -> Tuple[str, float]:
        """Return (brake state, distance to the obstacle that slows the robot [m], else NaN).

        The state is one of :mod:`mhri.base.brake_view` or :mod:`mhri.base.reasons`.
        """
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
        # Measured from the robot itself: the brake keeps a margin around it.
        points = self._seen.around(self._pose or _HERE)
        return SLOWS, free_way(points, self._radius_m + MARGIN_M, self._wanted) + MARGIN_M

    def _age(self, now: float) -> Optional[float]:
        return None if self._scan_at is None else now - self._scan_at


_HERE = Pose(0.0, 0.0, 0.0)
