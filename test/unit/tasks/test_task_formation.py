# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Formations in a small kinematic world: how far each robot is off its place, in bends as well."""
import math

import pytest

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.tasks.base import LOST, RUNNING, Step, Task
from mhri.tasks.formation import COLUMN, LeaderPath, LINE, Slot, slot_of, WEDGE
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import RobotRun

from support.task_world import World

SPACING_M = 0.8
TEAM = ('bot2', 'bot3')


class Leads(Task):
    """Drives at 0.2 m/s: in a circle of 2 m, or from side to side in bends of 1 m."""

    def __init__(self, how):
        self._how = how

    def step(self, senses):
        turn = 0.1 if self._how == 'circle' else -0.2 * math.sin(senses.now_s * math.pi / 12.0)
        return Step(Velocity(0.2, turn) if senses.now_s < 24.0 else Velocity())


def formed(shape, how='circle', off=(0.0, 0.0)):
    """Return (world, leader, [(follower, its slot)]) with all of them in their places, or off."""
    world = World()
    leader = world.add('bot1')
    leader.run = RobotRun('bot1', Leads(how), leader.task_body, 0.0, 0.0)
    followers = []
    for number, name in enumerate(TEAM):
        slot = slot_of(shape, SPACING_M, number)
        robot = world.add(name, off[0] - slot.behind_m, off[1] + slot.left_m, seed=number)
        robot.begin(BY_KEY['formation'], '{{leader: bot1, shape: {}, spacing: {}}}'.format(
            shape, SPACING_M), 0.0, TEAM)
        followers.append((robot, slot))
    return world, leader, followers


def errors(world, leader, followers, path):
    """Return how far each is off its place [m]."""
    path.add(leader.pose())
    found = []
    for robot, slot in followers:
        place = path.pose(slot.behind_m, slot.left_m)
        found.append(math.hypot(robot.body.x - place.x_m, robot.body.y - place.y_m))
    return found


@pytest.mark.parametrize('shape, how, mean_m, most_m', [
    (COLUMN, 'circle', 0.06, 0.1), (LINE, 'weave', 0.15, 0.3), (WEDGE, 'weave', 0.08, 0.2)])
def test_spacing_holds_in_bends(shape, how, mean_m, most_m):
    world, leader, followers = formed(shape, how)
    path, found = LeaderPath(), []
    while world.now_s < 31.0:
        world.step()
        now = errors(world, leader, followers, path)
        if world.now_s > 3.0:
            found += now
    print('formation {} {}: mean {:.3f} m, most {:.3f} m off'.format(
        shape, how, sum(found) / len(found), max(found)))
    assert sum(found) / len(found) < mean_m and max(found) < most_m
    assert max(now) < 0.1, 'where the leader stands, all come to their places'
    assert not sum(robot.contacts for robot in world.robots)
    assert [robot.run.state for robot, _ in followers] == [RUNNING, RUNNING]


def test_who_begins_elsewhere_falls_in():
    world, leader, followers = formed(WEDGE, off=(-1.0, 0.8))
    path = LeaderPath()
    while world.now_s < 45.0:
        world.step()
        now = errors(world, leader, followers, path)
    assert max(now) < 0.1
    assert not sum(robot.contacts for robot in world.robots)


def test_who_is_ahead_waits_and_does_not_turn_round():
    world, leader, followers = formed(COLUMN, off=(0.25, 0.0))
    while world.now_s < 6.0:
        world.step()
        assert all(abs(robot.body.yaw) < 0.5 for robot, _ in followers)


def test_a_leader_that_turns_on_the_spot_swings_nobody_around():
    path = LeaderPath()
    for x in range(20):
        path.add(Pose(0.1 * x, 0.0, 0.0))
    path.add(Pose(1.9, 0.0, 1.5))
    place = path.pose(0.0, 1.0)
    assert (place.x_m, place.y_m, place.heading_rad) == pytest.approx((1.9, 1.0, 0.0))


SLOTS = [
    (COLUMN, [(0.8, 0.0), (1.6, 0.0), (2.4, 0.0)]),
    (LINE, [(0.0, 0.8), (0.0, -0.8), (0.0, 1.6)]),
    (WEDGE, [(0.566, 0.566), (0.566, -0.566), (1.131, 1.131)])]


@pytest.mark.parametrize('shape, places', SLOTS)
def test_who_stands_where(shape, places):
    for number, (behind_m, left_m) in enumerate(places):
        slot = slot_of(shape, SPACING_M, number)
        assert isinstance(slot, Slot)
        assert (slot.behind_m, slot.left_m) == pytest.approx((behind_m, left_m), abs=1e-3)


def test_a_formation_without_its_leader_is_lost():
    world = World()
    robot = world.add('bot2')
    robot.begin(BY_KEY['formation'], '{leader: bot9}', 0.0)
    world.until_ended()
    assert robot.run.state == LOST and 'bot9' in robot.run.text


def test_a_leader_does_not_follow_itself():
    world = World()
    with pytest.raises(ValueError, match='bot1'):
        world.add('bot1').begin(BY_KEY['formation'], '{leader: bot1}', 0.0)
