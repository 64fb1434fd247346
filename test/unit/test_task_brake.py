# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake: tables, and random drives in a small world that end without contact."""
import math
from pathlib import Path
import random
import sys

import numpy as np
import pytest

from mhri.core.driving.limits import Velocity
from mhri.core.robots.mocap import Pose
from mhri.core.robots.robot_types import Limits
from mhri.core.tasks.base import Body, Step, Task
from mhri.core.tasks.brake import (
    braked, BRAKES_MPS2, CRAWL_MPS, free_way, Scan, stopping_speed, Surroundings)
from mhri.core.tasks.run import RobotRun

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from support.task_world import room, World  # noqa: E402

BODY = Body(0.2, Limits(1.0, 3.0))
AHEAD, ASIDE, BEHIND = (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)


@pytest.mark.parametrize('points, velocity, way', [
    ([], (0.5, 0.0), math.inf),
    ([AHEAD], (0.5, 0.0), 0.8),
    ([AHEAD], (0.0, 1.0), math.inf),
    ([AHEAD], (-0.5, 0.0), math.inf),
    ([BEHIND], (-0.5, 0.0), 0.8),
    ([ASIDE], (0.5, 0.0), math.inf),
    ([(1.0, 0.19)], (0.5, 0.0), 1.0 - math.sqrt(0.2 ** 2 - 0.19 ** 2)),
    ([(1.0, 0.21)], (0.5, 0.0), math.inf),
    ([(0.1, 0.0)], (0.5, 0.0), 0.0),
    ([(-0.1, 0.0)], (0.5, 0.0), math.inf),
    # A left turn of 1 m radius meets what is a quarter of it away, and not what is ahead.
    ([(1.0, 1.0)], (0.5, 0.5), math.pi / 2 - 2 * math.asin(0.1)),
    ([(1.0, -1.0)], (0.5, 0.5), math.inf),
    ([(1.0, -1.0)], (0.5, -0.5), math.pi / 2 - 2 * math.asin(0.1)),
    ([(-1.0, 1.0)], (-0.5, -0.5), math.pi / 2 - 2 * math.asin(0.1)),
    ([(2.0, 0.0), AHEAD], (0.5, 0.0), 0.8)])
def test_the_free_way_of_a_disc(points, velocity, way):
    found = free_way(np.array(points, dtype=float).reshape(-1, 2), 0.2, Velocity(*velocity))
    assert found == pytest.approx(way, abs=1e-6)


@pytest.mark.parametrize('way', [0.0, 0.01, 0.1, 0.5, 2.0])
@pytest.mark.parametrize('delay', [0.0, 0.2, 0.5])
def test_the_speed_is_lost_within_the_way(way, delay):
    speed = stopping_speed(way, delay)
    assert speed * delay + speed ** 2 / (2 * BRAKES_MPS2) == pytest.approx(way, abs=1e-9)


@pytest.mark.parametrize('wanted, age, allowed', [
    ((0.5, 0.3), None, (0.0, 0.3)),
    ((0.5, 0.3), 0.31, (0.0, 0.3)),
    ((-0.5, 0.3), 0.31, (-CRAWL_MPS, 0.3)),
    ((-0.5, 0.0), 0.1, (-0.5, 0.0)),
    ((0.0, 1.0), 0.1, (0.0, 1.0)),
    ((0.05, 0.0), 0.1, (0.05, 0.0))])
def test_what_is_allowed(wanted, age, allowed):
    found = braked(Velocity(*wanted), np.array([[0.6, 0.0]]), BODY, age)
    assert (found.linear_mps, found.angular_rad_s) == pytest.approx(allowed)


def test_the_speed_falls_with_the_distance_to_zero_before_contact():
    speeds = [braked(Velocity(1.0, 0.0), np.array([[x, 0.0]]), BODY, 0.1).linear_mps
              for x in np.arange(0.2, 3.0, 0.05)]
    assert speeds == sorted(speeds)
    assert speeds[0] == 0.0 and speeds[1] == 0.0 and speeds[-1] == 1.0


def scan(ranges, range_min=0.45):
    """Return a scan of a full turn."""
    return Scan(np.array(ranges, dtype=float), 0.0, 2 * math.pi / len(ranges), range_min, 10.0)


def test_what_came_too_near_to_be_seen_is_remembered_until_it_is_looked_at_again():
    seen, nothing = Surroundings(), [math.nan] * 360
    seen.see(scan([0.6] + nothing[1:]), Pose(0.0, 0.0, 0.0))
    near = Pose(0.3, 0.0, 0.0)
    seen.see(scan(nothing), near)
    assert seen.around(near)[0] == pytest.approx((0.3, 0.0), abs=0.03)
    seen.see(scan(nothing), near)
    assert len(seen.around(near)) == 1
    # Turned on the spot it is still there, on the other side; from further off it is gone.
    turned = Pose(0.3, 0.0, math.pi)
    seen.see(scan(nothing), turned)
    assert seen.around(turned)[0] == pytest.approx((-0.3, 0.0), abs=0.05)
    seen.see(scan(nothing), Pose(-0.1, 0.0, 0.0))
    assert len(seen.around(near)) == 0


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


def drive(seed, most_s, brake):
    """Let a robot wander among five things; return its contacts."""
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
    return robot.contacts


@pytest.mark.parametrize('seed', range(20))
def test_random_drives_end_without_contact(seed):
    assert drive(seed, 25.0, True) == 0


def test_the_same_drives_without_the_brake_meet_something():
    assert any(drive(seed, 25.0, False) for seed in range(8))
