# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A drill driven by the scripted operator faster than real time, without ROS.

It uses the same bodies, faults, referee and operator as on the graph, in steps of a virtual clock,
and a minimal mux: it sends the stick times the speed limit to the selected robot, and a zero to a
deselected one. Messages to and from a robot are delayed by its link. The operator steers by what
the newest picture shows, or by the end of the committed path on its floor.
"""
from dataclasses import replace
import math
import random

import numpy as np

from mhri.base.geometry import composed, Pose
from mhri.base.limits import Velocity
from mhri.drill.operator import ahead_of, RATE_HZ, ScriptedOperator, Seen
from mhri.drill.referee import Doing, Referee, TruePose
from mhri.drill.results import result_of
from mhri.sim.body import Body, Bumper
from mhri.sensors.committed import SentCommands
from mhri.sensors.floor import floor_path, level_camera
from mhri.sensors.point_cloud import Lens
from mhri.sim.delay_line import DelayLine
from mhri.sim.faults import FaultBook
from mhri.sim.lens import CAMERA_HEIGHT_M, CENTRE_X_PX, CENTRE_Y_PX, FOCAL_PX, HEIGHT, WIDTH
from mhri.sim.sensors import Laser

STEP_S = 0.02
SEES_EVERY, ACTS_EVERY = 5, round(1.0 / RATE_HZ / STEP_S) or 1
PERSON_M = 0.25
# Speed limits of the panel [m/s, rad/s].
LIMITS = (0.5, 1.5)
CAMERA = level_camera(0.0, CAMERA_HEIGHT_M, Lens(
    FOCAL_PX, FOCAL_PX, CENTRE_X_PX, CENTRE_Y_PX, WIDTH, HEIGHT))
# Error of a person who reads the end of the path off the picture [m, rad], standard deviation.
READING_ERROR = 0.03


class _Robot:
    """One robot and its link."""

    def __init__(self, kind, limits, pose, plan, others, chance):
        self.body = Body(kind, limits, pose, Bumper(kind.radius_m, plan.distance, others), chance)
        self.laser = Laser(plan.walls, kind.scan_min_m, kind.scan_max_m,
                           np.random.default_rng(chance.randrange(1 << 32)))
        self.faults = FaultBook()
        self.down, self.up = DelayLine(chance.random), DelayLine(chance.random)
        self.others = others
        self.landmarks = plan.discs()
        self.person = None
        self.seen, self.seen_at = None, -math.inf
        self.sent, self._limits, self._chance = SentCommands(), limits, chance

    def link(self, now, base_s):
        """Return the delay [s] and the loss [0 to 1] in each direction."""
        delay_s, loss = self.faults.link(now)
        frozen = any(self.faults.has(key, now) for key in ('computer_frozen', 'node_dead'))
        return base_s + delay_s, 1.0 if frozen else loss

    def step(self, now, base_s, tick):
        """Move for one step, and send due messages."""
        body = self.body
        for linear, angular in self.down.take(now):
            body.command(linear, angular, now)
        self.faults.weaken(body, now)
        if not self.faults.has('person', now):
            self.person = None
        body.step(STEP_S, now)
        if tick % SEES_EVERY == 0 and not self.faults.has('odometry_silent', now):
            self.up.put(self._look(), now, *self.link(now, base_s))
        for seen in self.up.take(now):
            self.seen, self.seen_at = seen, now

    def _look(self):
        body = self.body
        discs = np.vstack((self.landmarks, self.others()))
        ranges = self.laser.scan(body.x, body.y, body.yaw, discs)
        return body.x, body.y, body.yaw, ahead_of(
            ranges, self.laser.increment_rad, body.type.radius_m, body.type.scan_min_m)

    def as_seen(self, now):
        """Return the robot as known to the operator."""
        return Seen(*self.seen, age_s=now - self.seen_at)

    def add_sent(self, linear, angular, now):
        """Handle a command, which the drive limits to what the robot can do."""
        most = self._limits
        self.sent.add(Velocity(max(-most.linear_mps, min(most.linear_mps, linear)),
                               max(-most.angular_rad_s, min(most.angular_rad_s, angular))), now)

    def at_path_end(self, now, round_trip_s):
        """Return the same at the end of the committed path, as far as the picture shows it."""
        seen = self.as_seen(now)
        path = self.sent.path(round_trip_s, now)
        if not floor_path(path, self.body.type.radius_m, CAMERA).visible:
            return seen
        end = composed(Pose(seen.x_m, seen.y_m, seen.yaw_rad), path[-1])
        x, y, yaw = (value + self._chance.gauss(0.0, READING_ERROR) for value in (
            end.x_m, end.y_m, end.heading_rad))
        way = math.hypot(path[-1].x_m, path[-1].y_m)
        return replace(seen, x_m=x, y_m=y, yaw_rad=yaw, ahead_m=max(0.0, seen.ahead_m - way))

    def put_person(self, ahead_m):
        """Put a person in front of the robot, at a distance [m]."""
        self.person = (*self.body.ahead(ahead_m + self.body.type.radius_m + PERSON_M), PERSON_M)


class Rehearsal:
    """One drill, one run.

    :param scenario: :class:`mhri.drill.scenario.Scenario`
    :param plan: its :class:`mhri.sim.plan.Plan`
    :param bodies: {robot: (:class:`mhri.sim.body.BodyType`, limits)}
    :param delay_s: delay of every link in each direction [s]
    :param seed: seed of all random numbers
    :param with_path: whether the pictures show the committed path, and the operator steers by it
    """

    def __init__(self, scenario, plan, bodies, delay_s=0.0, seed=1, with_path=False):
        self._scenario, self._delay_s = scenario, delay_s
        self._with_path = with_path
        chance = random.Random(seed)
        self._robots = {}
        for number, name in enumerate(scenario.robots):
            kind, limits = bodies[name]
            self._robots[name] = _Robot(kind, limits, plan.starts[number], plan,
                                        lambda name=name: self._around(name), chance)
        radii = {name: kind.radius_m for name, (kind, _) in bodies.items()}
        self.referee = Referee(scenario, radii, plan.distance, plan.walls)
        self._operator = ScriptedOperator(scenario.routes, LIMITS[1])
        self._due = sorted(scenario.faults, key=lambda fault: fault.at_s)
        self._checked = ''

    def _around(self, name):
        """Return the obstacles of a robot, robots and persons: (n, 3) of x, y, radius [m]."""
        discs = [(other.body.x, other.body.y, other.body.type.radius_m)
                 for key, other in self._robots.items() if key != name]
        return np.array(discs + self._persons(), dtype=float).reshape(-1, 3)

    def _persons(self):
        return [robot.person for robot in self._robots.values() if robot.person]

    def run(self):
        """Run the drill to its end; return its result."""
        self.referee.begin(0.0)
        tick, doing = 0, Doing()
        while not self.referee.over():
            now = tick * STEP_S
            self._begin_faults(now)
            for robot in self._robots.values():
                robot.step(now, self._delay_s, tick)
            if tick % ACTS_EVERY == 0:
                doing = self._act(now)
            self.referee.update(now, {
                name: TruePose(robot.body.x, robot.body.y, robot.body.yaw)
                for name, robot in self._robots.items()}, self._persons(), doing)
            tick += 1
        return result_of(self._scenario, self.referee, 0.0, 'script')

    def _begin_faults(self, now):
        while self._due and self._due[0].at_s <= now:
            due = self._due.pop(0)
            robot = self._robots[due.robot]
            robot.faults.begin(due.fault.key, due.value, due.for_s, now)
            if due.fault.key == 'person':
                robot.put_person(due.value)
            self.referee.on_fault(due.robot, due.fault.words(due.value))

    def _act(self, now):
        act = self._operator.act({name: self._seen(robot, now)
                                  for name, robot in self._robots.items()
                                  if robot.seen is not None})
        if self._checked and act.robot != self._checked:
            self._send(self._checked, 0.0, 0.0, now)
        self._checked = act.robot
        if act.robot:
            self._send(act.robot, act.forward * LIMITS[0], act.turn * LIMITS[1], now)
        return Doing((act.robot,) if act.robot else (), bool(act.forward or act.turn))

    def _seen(self, robot, now):
        return robot.at_path_end(now, 2.0 * self._delay_s) if self._with_path \
            else robot.as_seen(now)

    def _send(self, name, linear, angular, now):
        robot = self._robots[name]
        robot.add_sent(linear, angular, now)
        robot.down.put((linear, angular), now, *robot.link(now, self._delay_s))
