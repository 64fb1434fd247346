# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A scripted operator: drives one robot after another along its route, with the data of a screen.

It has no more information than a person at the screen: the pose in each robot's newest message, the
clearance ahead by its laser, and its silence. It steers to the next place of the route, stops for
obstacles, and goes on with the next robot when this one has arrived or is silent.
"""
from dataclasses import dataclass
import math
from typing import Dict, Mapping, Optional, Sequence, Tuple

from mhri.drill.scenario import Point

# A place is reached within this distance [m].
REACHED_M = 0.25
# Turn rate per heading error [1/s], and maximum sideways deflection of the stick. Higher values
# oscillate with a link delay of 0.4 s each way (sustained at pi / 2 over the delay of the loop):
# a computer that is 30 ms late would then need a tenth longer for a drill.
STEER, MAX_TURN = 1.0, 0.4
# Above this heading error [rad], the robot only turns; it slows down within this distance of a
# place [m].
ASIDE_RAD, SLOW_M = 0.7, 0.6
MIN_FORWARD = 0.25
# It stops for obstacles closer to the robot's front than this [m], and waits.
AHEAD_M = 0.45
# Half-angle of the sector ahead to check for obstacles [rad].
AHEAD_RAD = 0.35
# Distance from the front that the laser need not measure [m].
_FRONT_M = 0.05
# A robot that is silent for this long is released [s].
NOT_HEARD_S = 1.0
# Rate of decisions [Hz].
RATE_HZ = 20.0


def ahead_of(ranges: Sequence[float], increment_rad: float, front_m: float,
             range_min_m: float) -> float:
    """Return the clearance ahead of the robot's front [m], of a scan that begins straight ahead.

    Readings below the laser's minimum range count as obstacles. 0 and NaN may mean that, or nothing
    in range; they count as the latter if the laser measures everything in front of the robot.
    """
    side = int(AHEAD_RAD / increment_rad)
    unsure_m = range_min_m if range_min_m > front_m + _FRONT_M else math.inf
    near = [distance if distance > 0.0 else range_min_m if distance < 0.0 else unsure_m
            for distance in (*ranges[:side + 1], *ranges[-side:])]
    return max(0.0, min(near, default=math.inf) - front_m)


@dataclass(frozen=True)
class Seen:
    """A robot as known to the operator: position and heading in the plan [m, m, rad].

    ``ahead_m`` is the clearance from its front by its laser, infinity if free; ``age_s`` is the
    age of its newest message.
    """

    x_m: float
    y_m: float
    yaw_rad: float
    ahead_m: float = math.inf
    age_s: float = 0.0


@dataclass(frozen=True)
class Act:
    """An action of the operator: the selected ``robot`` ('' for none), the stick in [-1, 1]."""

    robot: str = ''
    forward: float = 0.0
    turn: float = 0.0


class ScriptedOperator:
    """Decides what to do next.

    :param routes: {robot: places to pass}, in the order of driving
    :param turn_rad_s: turn rate at full sideways deflection of the stick [rad/s]
    """

    def __init__(self, routes: Mapping[str, Sequence[Point]], turn_rad_s: float) -> None:
        self._left: Dict[str, Tuple[Point, ...]] = {
            robot: tuple(route) for robot, route in routes.items() if route}
        self._turn_rad_s = turn_rad_s
        self._robot = ''

    @property
    def done(self) -> bool:
        """Whether every robot has completed its route."""
        return not self._left

    def act(self, seen: Mapping[str, Seen]) -> Act:
        """Return the next action; call it :data:`RATE_HZ` times a second.

        :param seen: the robots with at least one message so far
        """
        robot = self._choose(seen)
        if robot is None:
            return Act()
        if robot != self._robot:
            # Centre the stick first for the new robot.
            self._robot = robot
            return Act(robot)
        forward, turn = self._steer(robot, seen[robot])
        return Act(robot, forward, turn)

    def _choose(self, seen: Mapping[str, Seen]) -> Optional[str]:
        """Return the robot to drive: the current one unless silent, else the next live one."""
        heard = [name for name in self._left if name in seen and seen[name].age_s < NOT_HEARD_S]
        if self._robot in heard:
            self._pass(self._robot, seen[self._robot])
        if self._robot in self._left and self._robot in heard:
            return self._robot
        return next((name for name in heard if name in self._left), None)

    def _pass(self, robot: str, seen: Seen) -> None:
        """Remove the next place of the route once it is reached."""
        x, y = self._left[robot][0]
        if math.hypot(x - seen.x_m, y - seen.y_m) < REACHED_M:
            self._left[robot] = self._left[robot][1:]
            if not self._left[robot]:
                del self._left[robot]

    def _steer(self, robot: str, seen: Seen) -> Tuple[float, float]:
        x, y = self._left[robot][0]
        off = math.remainder(math.atan2(y - seen.y_m, x - seen.x_m) - seen.yaw_rad, 2.0 * math.pi)
        turn = max(-MAX_TURN, min(MAX_TURN, STEER * off / self._turn_rad_s))
        way = math.hypot(x - seen.x_m, y - seen.y_m)
        if seen.ahead_m < min(AHEAD_M, way) and abs(off) < ASIDE_RAD:
            return 0.0, turn
        forward = max(0.0, 1.0 - abs(off) / ASIDE_RAD) * min(1.0, MIN_FORWARD + way / SLOW_M)
        return forward, turn
