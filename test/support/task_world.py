# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A small kinematic world for tasks: simulated bodies and lasers in a plan, no ROS and no clock."""
import math
import random

import numpy as np

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.base.robot_types import Limits
from mhri.sensors.brake import Surroundings
from mhri.sensors.laser_scan import laser_scan
from mhri.sensors.readings import NO_RETURN
from mhri.sim.body import Body, BodyType, Bumper
from mhri.sim.plan import disc_distance
from mhri.sim.sensors import Laser
from mhri.tasks.base import (
    Body as TaskBody, circles, ENDS, NOWHERE, Other, Senses, Start, Step, Task)
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import Facts, RobotRun

DT_S = 0.05
KIND = BodyType(radius_m=0.177, height_m=0.4, wheel_separation_m=0.23, accel_mps2=1.0,
                accel_rad_s2=6.0, brake_mps2=5.0, watchdog_s=0.6, scan_min_m=0.45, scan_max_m=10.0,
                colour=(0, 0, 0))
LIMITS = Limits(0.65, 3.14)
NO_WALLS = np.zeros((0, 4))


def room(width_m=6.0, height_m=6.0):
    """Return the walls of an empty room around the origin, as a plan has them."""
    x, y = 0.5 * width_m, 0.5 * height_m
    corners = [(-x, -y), (x, -y), (x, y), (-x, y), (-x, -y)]
    return np.array([one + two for one, two in zip(corners, corners[1:])])


def wall_distance(walls, x, y):
    """Return the way to the nearest wall [m]."""
    if not len(walls):
        return math.inf
    start, along = walls[:, :2], walls[:, 2:] - walls[:, :2]
    share = np.clip(((np.array((x, y)) - start) * along).sum(axis=1)
                    / np.maximum((along ** 2).sum(axis=1), 1e-12), 0.0, 1.0)
    return float(np.hypot(*(np.array((x, y)) - start - share[:, None] * along).T).min())


class Robot:
    """A body with its laser and its run.

    :param delay: ticks from a command to the moment at which the body has it
    :param no_return: values by which its laser says that nothing is there
    """

    def __init__(self, world, name, pose, seed, kind=KIND, delay=1, no_return=NO_RETURN):
        self.name = name
        self._world = world
        self.kind = kind
        self.body = Body(kind, LIMITS, pose, Bumper(
            kind.radius_m, lambda x, y: min(wall_distance(world.walls, x, y),
                                            disc_distance(world.discs, x, y)),
            lambda: world.others(name)), random.Random(seed))
        self.laser = Laser(world.walls if len(world.walls) else np.array([[1e6, 0, 1e6, 1]]),
                           kind.scan_min_m, kind.scan_max_m, np.random.default_rng(seed),
                           nothing=no_return[0])
        self.no_return = no_return
        self.seen = Surroundings(kind.radius_m)
        self.task_body = TaskBody(kind.radius_m, LIMITS)
        self.run = None
        self.contacts = 0
        self._commands = [(0.0, 0.0)] * (delay + 1)
        self.scan_at = -math.inf
        self.blind = False

    def odometry(self):
        return Pose(self.body.odom_x, self.body.odom_y, self.body.odom_yaw)

    def pose(self):
        return Pose(self.body.x, self.body.y, self.body.yaw)

    def begin(self, kind, parameters, now_s, team=None, **start):
        """Begin a task."""
        values = kind.read(parameters)
        self.run = RobotRun(self.name, kind.make(values, Start(
            self.name, team or (self.name,), self.task_body, **start)), self.task_body,
            values.number('timeout'), now_s)

    def sense(self, now_s, tick):
        """Look around, ten times a second."""
        if tick % 2 == 0 and not self.blind:
            ranges = self.laser.scan(self.body.x, self.body.y, self.body.yaw,
                                     self._world.seen_by(self.name))
            if self.seen.see(self._world.scan_of(self, ranges), self.odometry(), now_s):
                self.scan_at = now_s

    def senses(self, now_s):
        others = {other.name: Other(other.pose(), other.name < self.name
                                    and other.run is not None
                                    and other.run.state not in ENDS, other.kind.radius_m)
                  for other in self._world.robots if other is not self}
        self.seen.forget(self.odometry(), circles(self.pose(), others.values()))
        return Senses(now_s, self.pose(), self.odometry(), self.pose(),
                      self.seen.around(self.odometry()), others, self._world.fence,
                      self._world.floor.edge(self.pose(), 1.5) if self._world.floor else NOWHERE)

    def command(self, velocity):
        """Give the body what was said some ticks ago."""
        self._commands = self._commands[1:] + [(velocity.linear_mps, velocity.angular_rad_s)]
        return self._commands[0]


class World:
    """Walls, discs and robots; time goes on by :meth:`step`."""

    def __init__(self, walls=NO_WALLS, discs=(), fence=(), floor=None):
        self.floor = floor
        self.walls = walls
        self.fence = np.array(fence, dtype=float).reshape(-1, 2)
        self.discs = np.array(discs, dtype=float).reshape(-1, 3)
        self.robots = []
        self.now_s = 0.0
        self.tick = 0

    def add(self, name, x=0.0, y=0.0, yaw=0.0, seed=1, **options):
        robot = Robot(self, name, (x, y, yaw), seed, **options)
        self.robots.append(robot)
        return robot

    def others(self, name):
        """Return the bodies of all robots but one, as an array (n, 3)."""
        return np.array([(robot.body.x, robot.body.y, robot.kind.radius_m)
                         for robot in self.robots if robot.name != name]).reshape(-1, 3)

    def seen_by(self, name):
        return np.vstack((self.discs, self.others(name)))

    @staticmethod
    def scan_of(robot, ranges):
        """Return a scan as the node reads it."""
        return laser_scan(ranges, (0.0, robot.laser.increment_rad),
                          (robot.kind.scan_min_m, robot.kind.scan_max_m),
                          {None: robot.no_return}, robot.kind.radius_m)

    def step(self, **facts):
        """Let a twentieth of a second pass."""
        self.now_s += DT_S
        self.tick += 1
        for robot in self.robots:
            robot.sense(self.now_s, self.tick)
        for robot in self.robots:
            if robot.run is None:
                continue
            known = dict(obeys='task', odometry_age_s=0.0, scan_age_s=self.now_s - robot.scan_at,
                         senses=robot.senses(self.now_s),
                         looks=robot.seen.looks(robot.odometry()))
            robot.last = robot.run.tick(Facts(self.now_s, **{**known, **facts}))
            robot.body.command(*robot.command(robot.last), self.now_s)
        for robot in self.robots:
            for _ in range(5):
                robot.body.step(DT_S / 5, self.now_s)
                robot.contacts += robot.body.blocked

    def until_ended(self, most_s=200.0, brake=True):
        """Go on until every run has ended."""
        while any(robot.run is not None and robot.run.state not in ENDS for robot in self.robots):
            assert self.now_s < most_s, [(robot.name, robot.run.state, robot.run.text)
                                         for robot in self.robots if robot.run]
            self.step(has_laser=brake)


class Wander(Task):
    """Wants anything, at random."""

    def __init__(self, seed):
        self._chance = random.Random(seed)
        self._velocity = Velocity()

    def step(self, senses):
        if self._chance.random() < 0.03:
            self._velocity = Velocity(self._chance.uniform(0.0, 0.65),
                                      self._chance.uniform(-1.5, 1.5))
        return Step(self._velocity)


def random_drive(seed, most_s, brake):
    """Let a robot wander among five things; return it."""
    chance = random.Random(seed)
    discs = [(chance.uniform(-1.8, 1.8), chance.uniform(-1.8, 1.8), chance.uniform(0.03, 0.3))
             for _ in range(5)]
    world = World(room(4.0, 4.0), [disc for disc in discs
                                   if math.hypot(*disc[:2]) > 0.5 + disc[2]])
    robot = world.add('bot1', seed=seed)
    while world.now_s < most_s:
        if robot.run is None or robot.run.phase == 'ended':
            robot.run = RobotRun('bot1', Wander(chance.random()), robot.task_body, 0.0,
                                 world.now_s)
        world.step(has_laser=brake)
    return robot


def random_goal(seed, brake=True):
    """Send a robot to a place in a room with four things; return it at the end."""
    chance = random.Random(seed)
    discs = [(chance.uniform(-2.4, 2.4), chance.uniform(-2.4, 2.4), chance.uniform(0.05, 0.3))
             for _ in range(4)]
    world = World(room(), [disc for disc in discs if math.hypot(*disc[:2]) > 0.6 + disc[2]])
    robot = world.add('bot1', seed=seed)
    robot.begin(BY_KEY['goto'], '{{x: {:.2f}, y: {:.2f}, speed: 0.4}}'.format(
        chance.uniform(-2.5, 2.5), chance.uniform(-2.5, 2.5)), 0.0)
    world.until_ended(brake=brake)
    return robot
