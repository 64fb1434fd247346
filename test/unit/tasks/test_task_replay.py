# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A drive replayed by poses, and the way back to a mark."""
import math
import re

import pytest

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.tasks.base import BLOCKED, DONE, ENDS, Step, Task
from mhri.tasks.replay import laid
from mhri.tasks.retrace import Trail
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import RobotRun

from support.task_world import DT_S, World


class Drives(Task):
    """What a person does with a stick: (seconds, m/s, rad/s) one after the other."""

    def __init__(self, parts):
        self._velocities = [Velocity(*part[1:]) for part in parts
                            for _ in range(int(part[0] / DT_S))]

    def step(self, senses):
        if not self._velocities:
            return Step(state=DONE)
        return Step(self._velocities.pop(0))


BEND = [(5.0, 0.3, 0.0), (5.0, 0.3, 0.5), (4.0, 0.25, -0.6), (1.0, 0.0, 0.0)]
CORNERS = [(4.0, 0.3, 0.0), (1.5, 0.0, 1.0), (4.0, 0.3, 0.0), (1.5, 0.0, -1.0), (3.0, 0.3, 0.0)]
BACKWARDS = [(4.0, 0.3, 0.2), (4.0, -0.2, 0.3), (1.0, 0.0, 0.0), (4.0, 0.3, -0.2)]
EIGHT = [(12.6, 0.3, 0.5), (12.6, 0.3, -0.5)]


def driven(parts, discs=()):
    """Let a person drive; return (world, robot, [pose by odometry of each step])."""
    world = World(discs=discs)
    robot = world.add('bot1', yaw=0.4)
    robot.run = RobotRun('bot1', Drives(parts), robot.task_body, 0.0, 0.0)
    poses = []
    while robot.run.state not in ENDS:
        world.step(has_laser=False)
        poses.append(robot.odometry())
    while abs(robot.body.v) > 0.0:
        world.step()
    return world, robot, tuple(poses)


def off(robot):
    """Return what it says that it was off: (most, mean, end) [m] by odometry."""
    return tuple(map(float, re.findall(r'([\d.]+) m\b', robot.run.text)[:3]))


@pytest.mark.parametrize('name, parts, begin', [
    ('bend', BEND, 'here'), ('bend', BEND, 'there'), ('corners', CORNERS, 'there'),
    ('backwards', BACKWARDS, 'here'), ('eight', EIGHT, 'there')])
def test_a_drive_is_replayed_within_015_m(name, parts, begin):
    world, robot, poses = driven(parts)
    first = poses[0] if begin == 'there' else robot.odometry()
    robot.begin(BY_KEY['replay'], '{{bag: x.bag, begin: {}, speed: 0.3}}'.format(begin),
                world.now_s, drive=poses)
    world.until_ended(most_s=world.now_s + 120.0)
    assert robot.run.state == DONE, robot.run.text
    print('replay {} {}: {}'.format(name, begin, robot.run.text))
    assert max(off(robot)) < 0.15
    end = laid(poses, first)[-1]
    assert math.hypot(robot.body.odom_x - end.x_m, robot.body.odom_y - end.y_m) < 0.1
    assert abs(math.remainder(robot.body.odom_yaw - end.heading_rad, 2 * math.pi)) < 0.12


def test_the_way_leads_around_a_thing_that_was_not_there():
    world, robot, poses = driven([(10.0, 0.3, 0.0)])
    for place, states in ((1.5, (DONE,)), (3.0, (BLOCKED,))):
        x, y = place * math.cos(0.4), place * math.sin(0.4)
        world.discs = World(discs=[(x, y, 0.1)]).discs
        robot.begin(BY_KEY['replay'], '{bag: x.bag, begin: there, speed: 0.3}', world.now_s,
                    drive=poses)
        world.until_ended(most_s=world.now_s + 120.0)
        assert robot.run.state in states, robot.run.text
    assert robot.contacts == 0


def test_its_own_trail_is_replayed_as_far_back_as_it_is_told():
    trail = Trail()
    for step in range(40):
        trail.add(Pose(0.12 * step, 0.0, 0.0), float(step))
    world = World()
    robot = world.add('bot1')
    robot.begin(BY_KEY['replay'], '{seconds: 10}', 0.0, trail=trail.places(),
                trail_ages_s=trail.ages_s(40.0))
    world.until_ended()
    assert robot.run.state == DONE
    assert robot.body.odom_x == pytest.approx(1.08, abs=0.05)


@pytest.mark.parametrize('parameters', ['', '{bag: x.bag}'])
def test_nothing_to_replay_is_refused(parameters):
    with pytest.raises(ValueError):
        World().add('bot1').begin(BY_KEY['replay'], parameters, 0.0)


MARKS = {'dock': Pose(1.5, 1.0, 1.0), 'door': Pose(-1.0, 0.0, 0.0)}


def test_it_returns_to_a_mark():
    world = World()
    robots = [world.add(name, 0.0, -1.0 * number, seed=number)
              for number, name in enumerate(('bot1', 'bot2'))]
    for robot in robots:
        robot.begin(BY_KEY['return'], '{mark: dock}', 0.0, ('bot1', 'bot2'), marks=MARKS)
    world.until_ended()
    assert [robot.run.state for robot in robots] == [DONE, DONE]
    assert math.hypot(robots[0].body.x - 1.5, robots[0].body.y - 1.0) < 0.1
    assert math.hypot(robots[1].body.x - 1.5, robots[1].body.y - 1.0) == pytest.approx(0.7, abs=0.1)


def test_an_unknown_mark_is_refused_and_the_known_ones_named():
    with pytest.raises(ValueError, match='home.*dock, door'):
        World().add('bot1').begin(BY_KEY['return'], '{mark: home}', 0.0, marks=MARKS)
