# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A drill driven by the scripted operator in no time: bodies, lasers and links without ROS.

The same bodies, faults, referee and operator as on the graph, in steps of a virtual clock; mux and
gates are as short as can be: the stick times the speed limit goes to the robot that is checked,
and a zero to one that is let go of. What a robot sends and is sent takes the delay of its link.
"""
import math
import random

import numpy as np

from mhri.drill.operator import ahead_of, RATE_HZ, ScriptedOperator, Seen
from mhri.drill.referee import Doing, Referee, TruePose
from mhri.drill.results import result_of
from mhri.sim.body import Body, Bumper
from mhri.sim.delay_line import DelayLine
from mhri.sim.faults import FaultBook
from mhri.sim.sensors import Laser

STEP_S = 0.02
SEES_EVERY, ACTS_EVERY = 5, round(1.0 / RATE_HZ / STEP_S) or 1
PERSON_M = 0.25
# The panel's own limits [m/s, rad/s].
LIMITS = (0.5, 1.5)


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

    def link(self, now, base_s):
        """Return delay [s] and loss [0 to 1] each way."""
        delay_s = base_s + (self.faults.value('delay', now) or 0.0)
        frozen = any(self.faults.has(key, now) for key in ('computer_frozen', 'node_dead'))
        return (delay_s, 1.0 if frozen else (self.faults.value('loss', now) or 0.0) / 100.0)

    def step(self, now, base_s, tick):
        """Move, and send what is due."""
        body = self.body
        for linear, angular in self.down.take(now):
            body.command(linear, angular, now)
        share = self.faults.value('wheel_slow', now)
        body.left_share = 0.0 if self.faults.has('motor_stuck', now) else \
            1.0 if share is None else share / 100.0
        body.slip = math.radians(self.faults.value('drift', now) or 0.0)
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
        """Return the robot as the operator sees it."""
        return Seen(*self.seen, age_s=now - self.seen_at)

    def put_person(self, ahead_m):
        """Put somebody before it."""
        away = ahead_m + self.body.type.radius_m + PERSON_M
        self.person = (self.body.x + away * math.cos(self.body.yaw),
                       self.body.y + away * math.sin(self.body.yaw), PERSON_M)


class Rehearsal:
    """One drill, one run.

    :param scenario: :class:`mhri.drill.scenario.Scenario`
    :param plan: its :class:`mhri.sim.plan.Plan`
    :param bodies: {robot: (:class:`mhri.sim.body.BodyType`, limits)}
    :param delay_s: of every link, each way
    :param seed: of everything that chance decides
    """

    def __init__(self, scenario, plan, bodies, delay_s=0.0, seed=1):
        self._scenario, self._delay_s = scenario, delay_s
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
        """Return what stands around a robot: x, y, radius [m] of the others and of persons."""
        discs = [(other.body.x, other.body.y, other.body.type.radius_m)
                 for key, other in self._robots.items() if key != name]
        return np.array(discs + self._persons(), dtype=float).reshape(-1, 3)

    def _persons(self):
        return [robot.person for robot in self._robots.values() if robot.person]

    def run(self):
        """Drive until the drill is over; return its result."""
        self.referee.begin(0.0)
        tick, doing = 0, Doing()
        while not self.referee.over():
            now = tick * STEP_S
            self._begin_faults(now)
            for robot in self._robots.values():
                robot.step(now, self._delay_s, tick)
            if tick % ACTS_EVERY == 0:
                doing = self._act(now)
            self.referee.see(now, {
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
        act = self._operator.act({name: robot.as_seen(now) for name, robot in self._robots.items()
                                  if robot.seen is not None})
        if self._checked and act.robot != self._checked:
            self._send(self._checked, 0.0, 0.0, now)
        self._checked = act.robot
        if act.robot:
            self._send(act.robot, act.forward * LIMITS[0], act.turn * LIMITS[1], now)
        return Doing((act.robot,) if act.robot else (), bool(act.forward or act.turn))

    def _send(self, name, linear, angular, now):
        robot = self._robots[name]
        robot.down.put((linear, angular), now, *robot.link(now, self._delay_s))
