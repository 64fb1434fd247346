# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A scripted operator: drives one robot after the other along its way, by what a screen shows.

It knows no more than a person at the screen: where each robot was when its newest message left it,
what its laser sees ahead, and whether it is heard. It steers at the next place of the way, stops
for what stands before it, and turns to the next robot when this one has arrived, or is not heard.
"""
from dataclasses import dataclass
import math
from typing import Dict, Mapping, Optional, Sequence, Tuple

from mhri.drill.scenario import Point

# A place is reached within so much [m].
REACHED_M = 0.25
# How much it turns for each radian that the robot is off [1/s], and the most it pushes the stick to
# a side. With more, a link of 0.4 s each way has it swing (for ever at pi / 2 over the delay of the
# loop): a computer that is 30 ms late would then take a tenth longer for a drill.
STEER, MOST_TURN = 1.0, 0.4
# It does not drive, only turns, if the robot is further off [rad]; it slows down before a place,
# within so much [m].
ASIDE_RAD, SLOW_M = 0.7, 0.6
LEAST_FORWARD = 0.25
# It stops if this is nearer to the robot's front [m], and waits until it has gone.
AHEAD_M = 0.45
# It looks this far to both sides for what is ahead [rad].
AHEAD_RAD = 0.35
# What is so near to its front is not looked for [m].
_FRONT_M = 0.05
# Nothing heard for so long: it lets go [s].
NOT_HEARD_S = 1.0
# It looks and acts so often [Hz].
RATE_HZ = 20.0


def ahead_of(ranges: Sequence[float], increment_rad: float, front_m: float,
             range_min_m: float) -> float:
    """Return the free way straight ahead [m] of a scan that begins there, from the front on.

    What is nearer than the laser measures counts as being there. 0 and NaN may mean that, or that
    nothing is there: the latter, where the laser measures all that is before the robot's front.
    """
    side = int(AHEAD_RAD / increment_rad)
    unsure_m = range_min_m if range_min_m > front_m + _FRONT_M else math.inf
    near = [distance if distance > 0.0 else range_min_m if distance < 0.0 else unsure_m
            for distance in (*ranges[:side + 1], *ranges[-side:])]
    return max(0.0, min(near, default=math.inf) - front_m)


@dataclass(frozen=True)
class Seen:
    """A robot as the operator sees it: place and heading in the plan [m, m, rad].

    ``ahead_m`` is what its laser measures from its front on, infinity for nothing, ``age_s`` how
    long nothing has come from it.
    """

    x_m: float
    y_m: float
    yaw_rad: float
    ahead_m: float = math.inf
    age_s: float = 0.0


@dataclass(frozen=True)
class Act:
    """What the operator does: ``robot`` is checked ('' for none), the stick in [-1, 1]."""

    robot: str = ''
    forward: float = 0.0
    turn: float = 0.0


class ScriptedOperator:
    """Decides what to do next.

    :param routes: {robot: the places it is to pass}, in the order in which they are driven
    :param turn_rad_s: turn rate of a stick pushed all the way to the side
    """

    def __init__(self, routes: Mapping[str, Sequence[Point]], turn_rad_s: float) -> None:
        self._left: Dict[str, Tuple[Point, ...]] = {
            robot: tuple(route) for robot, route in routes.items() if route}
        self._turn_rad_s = turn_rad_s
        self._robot = ''

    @property
    def done(self) -> bool:
        """Whether every robot has been all the way."""
        return not self._left

    def act(self, seen: Mapping[str, Seen]) -> Act:
        """Return what to do now; call it :data:`RATE_HZ` times a second.

        :param seen: the robots of which anything was ever heard
        """
        robot = self._choose(seen)
        if robot is None:
            return Act()
        if robot != self._robot:
            # The stick is centred for the new one first.
            self._robot = robot
            return Act(robot)
        forward, turn = self._steer(robot, seen[robot])
        return Act(robot, forward, turn)

    def _choose(self, seen: Mapping[str, Seen]) -> Optional[str]:
        """Return the robot to drive: this one while it is heard, else the next that is."""
        heard = [name for name in self._left if name in seen and seen[name].age_s < NOT_HEARD_S]
        if self._robot in heard:
            self._pass(self._robot, seen[self._robot])
        if self._robot in self._left and self._robot in heard:
            return self._robot
        return next((name for name in heard if name in self._left), None)

    def _pass(self, robot: str, seen: Seen) -> None:
        """Leave behind the place that the robot has reached."""
        x, y = self._left[robot][0]
        if math.hypot(x - seen.x_m, y - seen.y_m) < REACHED_M:
            self._left[robot] = self._left[robot][1:]
            if not self._left[robot]:
                del self._left[robot]

    def _steer(self, robot: str, seen: Seen) -> Tuple[float, float]:
        x, y = self._left[robot][0]
        off = math.remainder(math.atan2(y - seen.y_m, x - seen.x_m) - seen.yaw_rad, 2.0 * math.pi)
        turn = max(-MOST_TURN, min(MOST_TURN, STEER * off / self._turn_rad_s))
        way = math.hypot(x - seen.x_m, y - seen.y_m)
        if seen.ahead_m < min(AHEAD_M, way) and abs(off) < ASIDE_RAD:
            return 0.0, turn
        forward = max(0.0, 1.0 - abs(off) / ASIDE_RAD) * min(1.0, LEAST_FORWARD + way / SLOW_M)
        return forward, turn
