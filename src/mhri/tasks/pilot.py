# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drives a robot to a position, around single obstacles."""
import math
from typing import Optional

import numpy as np

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.sensors.brake import within_reach
from mhri.tasks.base import Body, Senses, turn_to, way, wrapped

# Candidate headings relative to the straight one [rad]; required free distance of each [m].
_OFFSETS = np.radians(np.arange(-120, 121, 8, dtype=float))
LOOK_M = 1.0
# Clearance to obstacles while going around them, a little more than that of the brake [m].
CLEARANCE_M = 0.14
# Minimum gain for changing the side on which it goes around [rad].
_KEEP_SIDE_RAD = math.radians(60.0)
_TURN_GAIN, _MAX_TURN_RAD_S = 1.2, 0.8
# Beyond this heading error the robot turns on the spot [rad].
_TURN_FIRST_RAD = 0.7
_SLOWS_MPS2 = 0.25
_MIN_MPS = 0.04
HEADING_WITHIN_RAD = 0.06


class Pilot:
    """Steers one robot step by step.

    :param speed_mps: maximum speed, within the robot's limits
    """

    def __init__(self, body: Body, speed_mps: float) -> None:
        self._body = body
        self._speed_mps = min(speed_mps, body.limits.linear_mps)
        self._turn_rad_s = min(_MAX_TURN_RAD_S, body.limits.angular_rad_s)
        self._side = 0.0

    def towards(self, senses: Senses, pose: Pose, x_m: float, y_m: float,
                rest: bool = True) -> Optional[Velocity]:
        """Return the velocity towards a position; None if the way is blocked.

        :param pose: pose of the robot in the frame of the position
        :param rest: whether to come to rest there
        """
        left_m = way(pose, x_m, y_m)
        heading = self._free_heading(senses.points, turn_to(pose, x_m, y_m), left_m)
        if heading is None:
            return None
        turn = max(-self._turn_rad_s, min(self._turn_rad_s, _TURN_GAIN * heading))
        if abs(heading) > _TURN_FIRST_RAD:
            return Velocity(0.0, turn)
        most = math.sqrt(2.0 * _SLOWS_MPS2 * left_m) if rest else math.inf
        speed = min(self._speed_mps, max(_MIN_MPS, most)) * math.cos(heading) ** 2
        return Velocity(speed, turn)

    def turned(self, pose: Pose, heading_rad: float) -> Optional[Velocity]:
        """Return the velocity that turns a robot on the spot; None at the heading."""
        off = wrapped(heading_rad - pose.heading_rad)
        if abs(off) <= HEADING_WITHIN_RAD:
            return None
        turn = math.copysign(max(0.1, min(self._turn_rad_s, 1.2 * abs(off))), off)
        return Velocity(0.0, turn)

    def _free_heading(self, points: np.ndarray, bearing: float, left_m: float) -> Optional[float]:
        """Return the free heading nearest to a bearing [rad]; None if all are blocked."""
        room_m, reach_m = self._body.radius_m + CLEARANCE_M, min(left_m, LOOK_M)
        # Points further off do not matter, and the straight heading is usually free.
        points = within_reach(points, reach_m + room_m)
        if free_ways(points, np.array([bearing]), room_m)[0] >= reach_m:
            self._side = 0.0
            return bearing
        headings = bearing + _OFFSETS
        good = free_ways(points, headings, room_m) >= reach_m
        if not good.any():
            return None
        costs = np.abs(_OFFSETS) + _KEEP_SIDE_RAD * (np.sign(_OFFSETS) == -self._side)
        best = int(np.argmin(np.where(good, costs, np.inf)))
        self._side = float(np.sign(_OFFSETS[best]))
        return wrapped(float(headings[best]))


def free_ways(points: np.ndarray, headings: np.ndarray, radius_m: float) -> np.ndarray:
    """Return how far a disc can move along each heading before it touches a point [m].

    A point that it already touches only blocks headings towards it.
    """
    if not len(points):
        return np.full(len(headings), np.inf)
    cos, sin = np.cos(headings)[:, None], np.sin(headings)[:, None]
    along = cos * points[:, 0] + sin * points[:, 1]
    across = np.abs(cos * points[:, 1] - sin * points[:, 0])
    near = (across < radius_m) & (along > 0.0)
    ways = along - np.sqrt(np.maximum(radius_m ** 2 - across ** 2, 0.0))
    free: np.ndarray = np.where(near, np.maximum(ways, 0.0), np.inf).min(axis=1)
    return free
