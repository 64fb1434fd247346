# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random drives and goals in :mod:`support.task_world` with the senses that robots really have.

Lasers that see half a turn, or nothing that is near; scans that are rare, late, noisy or lost;
commands that take their time; places that are a little wrong. Everything comes from the seed.
"""
from dataclasses import dataclass, replace
import math
import random

import numpy as np

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.driving.stick_brake import StickBrake
from mhri.robots.pose_track import PoseTrack
from mhri.sensors.laser_scan import laser_scan
from mhri.sensors.readings import NO_RETURN
from mhri.sim.plan import disc_distance
from mhri.tasks.base import ENDS, RUNNING, Step, Task, way, wrapped
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import RobotRun
from support.task_world import DT_S, KIND, LIMITS, Robot, room, wall_distance, World

# Moved by less than this the robot stands [m, rad].
STANDS_M, STANDS_RAD = 0.005, 0.01
# What a robot's clock says when the world begins [s].
BEGAN_S = 1.8e9


@dataclass(frozen=True)
class Rough:
    """How a robot senses and obeys; times in ticks of 0.05 s.

    :param every: from scan to scan
    :param late: from a scan to the moment at which it is heard
    :param lost: share of the scans that never come
    :param delay: from a command to the moment at which the body has it
    :param place_m: standard deviation of what motion capture says
    :param stamped: whether scans are stamped; else they count from their receipt
    """

    name: str
    scan_min_m: float = 0.12
    half: bool = False
    every: int = 2
    late: int = 1
    lost: float = 0.0
    noise_m: float = 0.01
    delay: int = 1
    place_m: float = 0.002
    stamped: bool = True
    no_return: tuple = NO_RETURN


ROUGH = (
    Rough('TurtleBot3', scan_min_m=0.12, every=4, late=1, no_return=(0.0,)),
    Rough('TurtleBot2', scan_min_m=0.45, every=2, late=1, no_return=(math.nan,)),
    Rough('half a turn', half=True, late=1),
    Rough('half, not near', scan_min_m=0.45, half=True, late=1),
    Rough('late', late=3, delay=2, scan_min_m=0.45),
    Rough('late, no stamps', late=3, delay=2, scan_min_m=0.45, stamped=False),
    Rough('lost', lost=0.4, late=1, noise_m=0.03, scan_min_m=0.45),
    Rough('noisy places', place_m=0.02, noise_m=0.02))


class RoughRobot(Robot):
    """A robot of the small world whose senses are rough."""

    def __init__(self, world, name, pose, seed, rough=ROUGH[0]):
        super().__init__(world, name, pose, seed, replace(KIND, scan_min_m=rough.scan_min_m),
                         rough.delay, rough.no_return)
        self.rough = rough
        self.laser.NOISE_M = rough.noise_m
        self._chance = random.Random(seed)
        self._under_way = []
        self._track = PoseTrack()
        self.eye = None
        self.closest_m = math.inf

    def sense(self, now_s, tick):
        """Measure when it is due; hear what was measured some ticks ago."""
        rough = self.rough
        if tick % rough.every == 0 and self._chance.random() >= rough.lost:
            ranges = self.laser.scan(self.body.x, self.body.y, self.body.yaw,
                                     self._world.seen_by(self.name))
            self._under_way.append((tick + rough.late, self._scan(ranges),
                                    BEGAN_S + now_s if rough.stamped else 0.0))
        # Each tick has its odometry, which is heard at once.
        self._track.add(BEGAN_S + now_s, self.odometry(), now_s)
        while self._under_way and self._under_way[0][0] <= tick:
            _, scan, stamp_s = self._under_way.pop(0)
            at_s, pose = self._track.moment(stamp_s, now_s)
            if self.seen.see(scan, pose or self.odometry(), at_s):
                self.scan_at = at_s
            if self.eye is not None:
                self.eye.move(self.odometry())
                self.eye.see(scan, at_s, pose)

    def _scan(self, ranges):
        if not self.rough.half:
            return self._world.scan_of(self, ranges)
        quarter, step = len(ranges) // 4, self.laser.increment_rad
        ahead = np.concatenate((ranges[-quarter:], ranges[:quarter + 1]))
        return laser_scan(ahead, (-quarter * step, step),
                          (self.kind.scan_min_m, self.kind.scan_max_m),
                          {None: self.no_return}, self.kind.radius_m)

    def senses(self, now_s):
        senses = super().senses(now_s)
        return replace(senses, pose=self._about(senses.pose), others={
            name: replace(other, pose=self._about(other.pose))
            for name, other in senses.others.items()})

    def _about(self, pose):
        gauss, spread_m = self._chance.gauss, self.rough.place_m
        return Pose(pose.x_m + gauss(0.0, spread_m), pose.y_m + gauss(0.0, spread_m),
                    pose.heading_rad + gauss(0.0, spread_m))

    def measure(self):
        """Note the gap to whatever is nearest."""
        x, y = self.body.x, self.body.y
        gap_m = min(wall_distance(self._world.walls, x, y),
                    disc_distance(self._world.seen_by(self.name), x, y)) - self.kind.radius_m
        self.closest_m = min(self.closest_m, gap_m)


class RoughWorld(World):
    """The small world with rough robots."""

    def add_rough(self, name, pose, seed, rough):
        """Add a robot."""
        robot = RoughRobot(self, name, pose, seed, rough)
        self.robots.append(robot)
        return robot

    def step(self, **facts):
        super().step(**facts)
        for robot in self.robots:
            robot.measure()


class Wander(Task):
    """Wants anything, at random; without an eye for what is behind it never backs away."""

    def __init__(self, seed, backward):
        self._chance = random.Random(seed)
        self._least_mps = -0.3 if backward else 0.0
        self._velocity = Velocity()

    def step(self, senses):
        if self._chance.random() < 0.03:
            self._velocity = Velocity(self._chance.uniform(self._least_mps, LIMITS.linear_mps),
                                      self._chance.uniform(-1.5, 1.5))
        return Step(self._velocity)


class Stick:
    """Instead of a run: what a stick says goes through the brake alone, as in the mux."""

    state = RUNNING

    def __init__(self, robot, wander):
        self._robot, self._wander = robot, wander
        robot.eye = StickBrake(robot.kind.radius_m, True)
        robot.eye.ask(True)

    def tick(self, facts):
        """Return the velocity that the robot is given."""
        wanted = self._wander.step(None).velocity
        if not facts.has_laser:
            return wanted
        self._robot.eye.move(self._robot.odometry())
        return self._robot.eye.allow(wanted, facts.now_s)


def free_places(chance, walls_m, discs, count, apart_m=0.8):
    """Return places with room around them: poses (x, y, heading)."""
    found = []
    while len(found) < count:
        x, y = (chance.uniform(-0.5 * walls_m + 0.4, 0.5 * walls_m - 0.4) for _ in range(2))
        if all(math.hypot(x - dx, y - dy) > dr + 0.7 for dx, dy, dr in discs) \
                and all(math.hypot(x - px, y - py) > apart_m for px, py, _ in found):
            found.append((x, y, chance.uniform(-math.pi, math.pi)))
    return found


def things(chance, walls_m, count):
    """Return random discs (x, y, radius) [m]."""
    return [(chance.uniform(-0.45, 0.45) * walls_m, chance.uniform(-0.45, 0.45) * walls_m,
             chance.uniform(0.03, 0.3)) for _ in range(count)]


def random_drive(seed, seconds, brake):
    """Let one robot or several wander among things; return them.

    Every other drive is that of a stick: one robot, nobody knows where others are.
    """
    chance = random.Random(seed)
    rough, stick = ROUGH[seed % len(ROUGH)], seed % 2
    discs = things(chance, 5.0, 5)
    world = RoughWorld(room(5.0, 5.0), discs)
    for number, pose in enumerate(free_places(chance, 5.0, discs, 1 if stick else 3)):
        world.add_rough('bot{}'.format(number + 1), pose, chance.randrange(10 ** 6), rough)
    while world.now_s < seconds:
        for robot in world.robots:
            if robot.run is None or robot.run.state in ENDS:
                wander = Wander(chance.random(), not rough.half)
                robot.run = Stick(robot, wander) if stick else RobotRun(
                    robot.name, wander, robot.task_body, 0.0, world.now_s)
        world.step(has_laser=brake)
    return world.robots


class Watch:
    """How long a robot on a task stood, and how long it did so without a word."""

    def __init__(self, robot):
        self._robot = robot
        self._from = (robot.pose(), 0.0)
        self.stood_s = self.silent_s = 0.0
        self._spoke_at = 0.0

    def look(self, now_s):
        """Note what it does now."""
        pose, (since, at) = self._robot.pose(), self._from
        if way(since, pose.x_m, pose.y_m) > STANDS_M \
                or abs(wrapped(pose.heading_rad - since.heading_rad)) > STANDS_RAD:
            self._from = (pose, now_s)
            return
        if self._robot.run.state != RUNNING:
            self._spoke_at = now_s
        self.stood_s = max(self.stood_s, now_s - at)
        self.silent_s = max(self.silent_s, now_s - max(at, self._spoke_at))


@dataclass(frozen=True)
class Outcome:
    """How one robot's goal ended: after so long, of a timeout of so long."""

    state: str
    text: str
    took_s: float
    timeout_s: float
    left_m: float
    contacts: int
    closest_m: float
    stood_s: float
    silent_s: float


def random_goals(seed, brake):
    """Send one robot or several to places of their own; return the :class:`Outcome` of each."""
    chance = random.Random(seed)
    rough, count = ROUGH[seed % len(ROUGH)], 1 + seed % 4
    discs = things(chance, 6.0, 4)
    world = RoughWorld(room(), discs)
    goals = free_places(chance, 6.0, [], count)
    timeouts, ended = [chance.choice((20.0, 60.0, 120.0)) for _ in goals], {}
    for number, pose in enumerate(free_places(chance, 6.0, discs, count)):
        robot = world.add_rough('bot{}'.format(number + 1), pose, chance.randrange(10 ** 6), rough)
        robot.begin(BY_KEY['goto'], '{{x: {:.2f}, y: {:.2f}, speed: {:.2f}, timeout: {}}}'.format(
            *goals[number][:2], chance.uniform(0.15, 0.5), timeouts[number]), 0.0)
    watches = [Watch(robot) for robot in world.robots]
    while len(ended) < count and world.now_s < max(timeouts) + 5.0:
        world.step(has_laser=brake)
        for number, robot in enumerate(world.robots):
            if robot.run.state in ENDS:
                ended.setdefault(number, world.now_s)
            else:
                watches[number].look(world.now_s)
    return [Outcome(robot.run.state, robot.run.text, ended.get(number, math.inf), timeouts[number],
                    way(robot.pose(), *goals[number][:2]), robot.contacts, robot.closest_m,
                    watches[number].stood_s, watches[number].silent_s)
            for number, robot in enumerate(world.robots)]


__all__ = ['DT_S', 'Outcome', 'random_drive', 'random_goals', 'ROUGH']
