# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The fence that no task leaves."""
import math
import random

import numpy as np
import pytest

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.base.robot_types import Limits
from mhri.tasks.base import BLOCKED, Body, DONE, ENDS, FAILED, Step, Task
from mhri.tasks.fence import depths, is_inside, kept_inside
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import RobotRun

from support.task_world import Wander, World

SQUARE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
# With a notch from above down to the middle.
NOTCHED = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (0.5, 2.0), (0.5, 0.0), (-0.5, 0.0),
           (-0.5, 2.0), (-2.0, 2.0)]
BODY = Body(0.18, Limits(0.65, 3.0))


@pytest.mark.parametrize('fence, x, y, depth', [
    (SQUARE, 0.0, 0.0, 1.0), (SQUARE, 0.9, 0.0, 0.1), (SQUARE, 1.2, 0.0, -0.2),
    (SQUARE, 2.0, 2.0, -math.sqrt(2.0)), (SQUARE[::-1], 0.0, 0.5, 0.5),
    (NOTCHED, 0.0, 1.0, -0.5), (NOTCHED, 0.0, -0.3, 0.3), (NOTCHED, 1.0, 1.0, 0.5)])
def test_how_far_inside_a_place_lies(fence, x, y, depth):
    assert depths(np.array(fence), np.array([[x, y]]))[0] == pytest.approx(depth)
    assert is_inside(np.array(fence), x, y) == (depth > 0.0)


KEPT = [
    # pose, wanted (m/s, rad/s), whether it may go on
    ((0.0, 0.0, 0.0), (0.3, 0.0), True),
    ((0.8, 0.0, 0.0), (0.3, 0.0), False),
    ((0.8, 0.0, 0.0), (-0.3, 0.0), True),
    ((0.8, 0.0, math.pi), (0.3, 0.0), True),
    ((0.8, 0.0, math.pi), (-0.3, 0.0), False),
    # Along the fence, and in a bend away from it or towards it.
    ((0.7, 0.0, 0.5 * math.pi), (0.2, 0.0), True),
    ((0.74, 0.0, 0.5 * math.pi), (0.2, 1.0), True),
    ((0.74, 0.0, 0.5 * math.pi), (0.2, -1.0), False),
    # Outside: back in, not away.
    ((1.5, 0.0, math.pi), (0.3, 0.0), True),
    ((1.5, 0.0, 0.0), (0.3, 0.0), False),
    ((1.5, 0.0, 0.0), (-0.3, 0.0), True)]


@pytest.mark.parametrize('pose, wanted, goes', KEPT)
def test_a_robot_may_drive_where_it_stays_inside_or_comes_back(pose, wanted, goes):
    kept = kept_inside(Velocity(*wanted), Pose(*pose), np.array(SQUARE), BODY)
    assert (kept.linear_mps == pytest.approx(wanted[0])) if goes else abs(kept.linear_mps) < 0.02
    assert kept.angular_rad_s == wanted[1]


def test_without_a_fence_nothing_is_kept():
    wanted = Velocity(0.5, 0.1)
    assert kept_inside(wanted, Pose(9.0, 9.0, 0.0), np.zeros((0, 2)), BODY) == wanted
    assert is_inside(np.zeros((0, 2)), 9.0, 9.0)


class Ahead(Task):
    """Wants straight on for ever."""

    def step(self, senses):
        return Step(Velocity(0.6, 0.0), text='straight on')


@pytest.mark.parametrize('laser', [True, False])
def test_at_the_fence_it_stands_and_is_blocked_in_the_end(laser):
    world = World(fence=SQUARE)
    robot = world.add('bot1')
    robot.run = RobotRun('bot1', Ahead(), robot.task_body, 0.0, 0.0)
    world.until_ended(brake=laser)
    assert robot.run.state == BLOCKED
    assert 'fence' in robot.run.text
    assert 0.5 < robot.body.x < 1.0 - robot.kind.radius_m


@pytest.mark.parametrize('seed', range(3))
def test_who_wanders_stays_inside(seed):
    world, chance = World(fence=NOTCHED), random.Random(seed)
    robot = world.add('bot1', 1.0, -1.0, 1.0, seed=seed)
    least = math.inf
    while world.now_s < 30.0:
        if robot.run is None or robot.run.state in ENDS:
            robot.run = RobotRun('bot1', Wander(chance.random()), robot.task_body, 0.0,
                                 world.now_s)
        world.step()
        least = min(least, depths(world.fence, np.array([[robot.body.x, robot.body.y]]))[0])
    print('seed {}: {:.3f} m of the robot beyond the fence'.format(
        seed, max(0.0, robot.kind.radius_m - least)))
    assert least > robot.kind.radius_m


def test_a_goal_outside_is_refused_and_one_inside_is_reached_from_outside():
    world = World(fence=SQUARE)
    robot = world.add('bot1', 2.0, 0.0, 0.0)
    robot.begin(BY_KEY['goto'], '{x: 3.0, y: 0.0}', 0.0)
    world.until_ended()
    assert robot.run.state == FAILED and 'fence' in robot.run.text
    robot.begin(BY_KEY['goto'], '{x: 0.0, y: 0.3}', world.now_s)
    world.until_ended()
    assert robot.run.state == DONE
