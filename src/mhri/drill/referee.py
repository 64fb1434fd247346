# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The referee of a drill, which measures by the true poses of all robots.

Terms and formulas follow the literature, but are not certified:

- *Time driven* is interaction time, *time neglected* the rest until the end, *attention* the share
  of interaction time in both (robot attention demand): Olsen and Goodrich, "Metrics for
  Evaluating Human-Robot Interactions", PERMIS 2003.
- *Neglect tolerance* is the time for which a neglected robot stays active, here the mean; on how it
  limits the size of a team: Crandall, Goodrich, Olsen and Nielsen, "Validating Human-Robot
  Interaction Schemes in Multitasking Environments", IEEE Trans. SMC-A 35 (4), 2005.
- *Fan-out* is the activity of all robots over the interaction time: Olsen and Wood, "Fan-out:
  Measuring Human Control of Multiple Robots", CHI 2004.
- The tasks follow the standard test methods for response robots of NIST and the subcommittee
  ASTM E54.09: maneuvering as in ASTM E2829 (sustained speed), searching a maze as in ASTM E2853.
"""
from dataclasses import dataclass, field
import math
from typing import Callable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mhri.drill.scenario import Scenario, Target

# A contact begins below the first gap and ends above the second [m].
TOUCH_M, CLEAR_M = 0.01, 0.04
# A robot below both speeds does not move [m/s, rad/s].
STILL_MPS, STILL_RAD_S = 0.01, 0.05
# Time window for judging movement, and maximum length of a time step [s].
WINDOW_S, MAX_STEP_S = 0.2, 1.0
ALL_FOUND, TIME_UP, LEFT = 'all found', 'time is up', 'left'

Disc = Tuple[float, float, float]


class TruePose(NamedTuple):
    """The pose of a robot in the plan [m, m, rad]."""

    x_m: float
    y_m: float
    yaw_rad: float


class Doing(NamedTuple):
    """The state of the operator: selected robots, whether the stick is pushed, STOP ALL."""

    selected: Tuple[str, ...] = ()
    pushed: bool = False
    stopped: bool = False


@dataclass
class RobotTally:
    """The figures of one robot: seconds, metres, counts."""

    driven_s: float = 0.0
    neglected_s: float = 0.0
    active_s: float = 0.0
    tolerances_s: List[float] = field(default_factory=list)
    distance_m: float = 0.0
    contacts: int = 0
    least_gap_m: float = math.inf
    trail: List[Tuple[float, float]] = field(default_factory=list)


@dataclass
class Found:
    """A found target, with the robot and the time from the start of the drill [s]."""

    target: str
    robot: str
    at_s: float


@dataclass
class Reaction:
    """A fault, and the operator's first action after it: ``how``, '' if none.

    ``after_s`` is the reaction time [s], None without a reaction.
    """

    robot: str
    fault: str
    at_s: float
    how: str = ''
    after_s: Optional[float] = None


class _Follower:
    """Measures one robot: movement, contacts, neglect."""

    def __init__(self, radius_m: float) -> None:
        self.radius_m = radius_m
        self.tally = RobotTally()
        self._pose: Optional[TruePose] = None
        self._moved_at = -math.inf
        self._touches = False
        self._left_at: Optional[float] = None

    def update(self, pose: TruePose, gap_m: float, now: float, dt: float) -> None:
        tally, before = self.tally, self._pose
        if before is not None and dt > 0.0:
            way = math.hypot(pose.x_m - before.x_m, pose.y_m - before.y_m)
            turn = abs(math.remainder(pose.yaw_rad - before.yaw_rad, 2.0 * math.pi))
            tally.distance_m += way
            if way > STILL_MPS * dt or turn > STILL_RAD_S * dt:
                self._moved_at = now
        if not tally.trail or math.dist(tally.trail[-1], (pose.x_m, pose.y_m)) > 0.05:
            tally.trail.append((pose.x_m, pose.y_m))
        self._pose = pose
        tally.least_gap_m = min(tally.least_gap_m, gap_m)
        if gap_m < TOUCH_M and not self._touches:
            tally.contacts += 1
        self._touches = gap_m < (CLEAR_M if self._touches else TOUCH_M)

    def count(self, driven: bool, now: float, dt: float) -> None:
        tally, active = self.tally, now - self._moved_at <= WINDOW_S
        tally.active_s += dt * active
        if driven:
            tally.driven_s += dt
            self._left_at = now
            return
        tally.neglected_s += dt
        if self._left_at is not None and not active:
            # The time for which it moved on alone: by its task, or while braking.
            tally.tolerances_s.append(max(0.0, self._moved_at - self._left_at))
            self._left_at = None


class Referee:
    """Measures one run of a drill; times are [s, monotonic].

    :param radii: {robot: radius of its body [m]}
    :param distance: function (x, y) -> distance to the nearest fixed obstacle [m]
    :param walls: array (n, 4) of x1, y1, x2, y2 [m], which block the view
    """

    def __init__(self, scenario: Scenario, radii: Mapping[str, float],
                 distance: Callable[[float, float], float], walls: 'np.ndarray') -> None:
        self._scenario = scenario
        self._distance = distance
        self._walls = walls
        self._robots = {name: _Follower(radii[name]) for name in scenario.robots}
        self._left = list(scenario.targets)
        self._begun = self._now = -math.inf
        self._doing = Doing()
        self.found: List[Found] = []
        self.reactions: List[Reaction] = []
        self.stops_s: List[float] = []

    def begin(self, now: float) -> None:
        """Start the clock of the drill."""
        self._begun = self._now = now

    @property
    def elapsed_s(self) -> float:
        """The time since the start [s]."""
        return self._now - self._begun

    @property
    def left(self) -> Tuple[Target, ...]:
        """The targets not found yet."""
        return tuple(self._left)

    def tally(self, robot: str) -> RobotTally:
        """Return the figures of a robot so far."""
        return self._robots[robot].tally

    def on_fault(self, robot: str, fault: str) -> None:
        """Handle the start of a fault."""
        self.reactions.append(Reaction(robot, fault, self.elapsed_s))

    def update(self, now: float, poses: Mapping[str, TruePose], others: Sequence[Disc],
               doing: Doing) -> None:
        """Handle one time step.

        :param poses: poses of the present robots
        :param others: other obstacles: x, y, radius [m]
        """
        dt, self._now = min(now - self._now, MAX_STEP_S), now
        for name, robot in self._robots.items():
            pose = poses.get(name)
            if pose is not None:
                robot.update(pose, self._gap(name, pose, poses, others), now, dt)
            driven = doing.pushed and not doing.stopped and name in doing.selected
            robot.count(driven, now, dt)
        self._search(poses)
        self._react(doing)
        self._doing = doing

    def _gap(self, name: str, pose: TruePose, poses: Mapping[str, TruePose],
             others: Sequence[Disc]) -> float:
        """Return the distance of a robot's body to the nearest obstacle [m]."""
        gaps = [self._distance(pose.x_m, pose.y_m)]
        gaps += [math.hypot(x - pose.x_m, y - pose.y_m) - radius for x, y, radius in others]
        gaps += [math.hypot(other.x_m - pose.x_m, other.y_m - pose.y_m)
                 - self._robots[one].radius_m
                 for one, other in poses.items() if one != name and one in self._robots]
        return min(gaps) - self._robots[name].radius_m

    def _search(self, poses: Mapping[str, TruePose]) -> None:
        for target in self._left[:1] if self._scenario.in_order else list(self._left):
            for name in (target.robot,) if target.robot else self._scenario.robots:
                if name in poses and self._sees(poses[name], target):
                    self.found.append(Found(target.name, name, self.elapsed_s))
                    self._left.remove(target)
                    break

    def _sees(self, pose: TruePose, target: Target) -> bool:
        dx, dy = target.x_m - pose.x_m, target.y_m - pose.y_m
        aside = abs(math.remainder(math.atan2(dy, dx) - pose.yaw_rad, 2.0 * math.pi))
        return math.hypot(dx, dy) <= target.range_m and 2.0 * aside <= target.view_rad \
            and not self._hidden(pose, dx, dy)

    def _hidden(self, pose: TruePose, dx: float, dy: float) -> bool:
        """Return whether a wall crosses the line of sight."""
        px, py = self._walls[:, 0] - pose.x_m, self._walls[:, 1] - pose.y_m
        ex, ey = self._walls[:, 2] - self._walls[:, 0], self._walls[:, 3] - self._walls[:, 1]
        across = dx * ey - dy * ex
        with np.errstate(divide='ignore', invalid='ignore'):
            along, share = (px * ey - py * ex) / across, (px * dy - py * dx) / across
        return bool(((along > 0.0) & (along < 1.0) & (share >= 0.0) & (share <= 1.0)).any())

    def _react(self, doing: Doing) -> None:
        """Record a stop, and the operator's first action after a fault."""
        before, how = self._doing, ''
        if doing.stopped and not before.stopped:
            self.stops_s.append(self.elapsed_s)
            how = 'stop'
        elif doing.selected != before.selected:
            how = 'selection'
        elif before.pushed and not doing.pushed:
            how = 'stick'
        for reaction in self.reactions if how else ():
            if not reaction.how:
                reaction.how = how
                reaction.after_s = self.elapsed_s - reaction.at_s

    def over(self) -> str:
        """Return the reason for the end of the drill, '' while running."""
        if not self._left:
            return ALL_FOUND
        return TIME_UP if self.elapsed_s >= self._scenario.limit_s else ''
