# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Each task in a small kinematic world: where the robot ends, what is said, what it never does."""
import math

import pytest

from mhri.base.config import ConfigError
from mhri.base.geometry import Pose
from mhri.tasks.base import BLOCKED, DONE, FAILED, LOST, STOPPED, TAKEN_OVER, TIMEOUT, WAITING
from mhri.tasks.retrace import without_loops
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import BLOCKED_AFTER_S, LEFT_OUT_S

from support.task_world import DT_S, KIND, random_goal, room, World


def alone(task, parameters, walls=room(), discs=(), **start):
    """Let one robot do one task to its end; return it."""
    world = World(walls, discs)
    robot = world.add('bot1', **start)
    robot.begin(BY_KEY[task], parameters, 0.0)
    world.until_ended()
    return robot


@pytest.mark.parametrize('x, y, heading', [
    (2.0, 1.5, None), (-2.0, 0.0, 1.0), (0.0, -2.0, 3.1), (0.4, 0.0, -1.5), (0.0, 0.0, 2.0)])
def test_goto_ends_where_it_was_sent(x, y, heading):
    robot = alone('goto', '{{x: {}, y: {}{}}}'.format(
        x, y, '' if heading is None else ', heading: {}'.format(heading)))
    assert robot.run.state == DONE
    assert math.hypot(robot.body.x - x, robot.body.y - y) < 0.1
    if heading is not None:
        assert abs(math.remainder(robot.body.yaw - heading, 2 * math.pi)) < 0.12
    assert robot.contacts == 0


@pytest.mark.parametrize('task, parameters, placed', [
    ('goto', '{x: 1, y: 0}', True), ('goto', '{x: 1, y: 0, frame: odom}', False),
    ('patrol', '{route: [[1, 0]]}', True), ('patrol', '{route: [[1, 0]], frame: odom}', False),
    ('follow', '{leader: bot2}', True), ('square', '{side: 1}', False), ('hold', '', False),
    ('return', '', False), ('return', '{mark: dock}', True), ('replay', '', False),
    ('formation', '{leader: bot2}', True)])
def test_which_tasks_need_a_place(task, parameters, placed):
    kind = BY_KEY[task]
    assert kind.placed(kind.read(parameters)) == placed


@pytest.mark.parametrize('discs', [
    [(1.0, 0.0, 0.15)], [(1.0, 0.1, 0.3)], [(1.2, -0.2, 0.4)], [(0.8, 0.0, 0.05)]])
def test_goto_goes_around_a_single_thing(discs):
    robot = alone('goto', '{x: 2.2, y: 0.0}', discs=discs)
    assert (robot.run.state, robot.contacts) == (DONE, 0)
    assert math.hypot(robot.body.x - 2.2, robot.body.y) < 0.1


def test_goto_into_a_wall_says_that_it_is_blocked():
    robot = alone('goto', '{x: 4.0, y: 0.0}')
    assert robot.run.state == BLOCKED
    assert robot.contacts == 0
    assert robot.body.x < 3.0 - 0.177


def test_goto_gives_up_in_time():
    robot = alone('goto', '{x: 2.0, y: 0.0, timeout: 3.0}')
    assert robot.run.state == TIMEOUT


def test_a_team_stands_side_by_side():
    world = World(room(8.0, 8.0))
    team = ('bot1', 'bot2', 'bot3')
    for number, name in enumerate(team):
        world.add(name, -2.0, (0.0, 1.0, -1.0)[number], seed=number).begin(
            BY_KEY['goto'], '{x: 1.0, y: 0.0, heading: 0.0}', 0.0, team)
    world.until_ended()
    assert [robot.run.state for robot in world.robots] == [DONE] * 3
    places = sorted(robot.body.y for robot in world.robots)
    assert all(abs(place - want) < 0.15 for place, want in zip(places, (-0.7, 0.0, 0.7)))
    assert sum(robot.contacts for robot in world.robots) == 0


@pytest.mark.parametrize('side, number', [(1.0, 1), (0.6, 2)])
def test_square_closes_and_says_its_corners(side, number):
    robot = alone('square', '{{side: {}, number: {}}}'.format(side, number))
    assert robot.run.state == DONE, robot.run.text
    assert math.hypot(robot.body.odom_x, robot.body.odom_y) < 0.06
    corners = [line for line in robot.run.said if line.startswith('corner')]
    assert len(corners) == 4 * number
    assert robot.run.text.count(' m') >= 2


@pytest.mark.parametrize('gap_m', [0.02, 0.1, 0.2])
def test_a_first_task_before_a_wall_that_is_too_near_to_be_seen_touches_nothing(gap_m):
    world = World(room())
    robot = world.add('bot1', x=3.0 - KIND.radius_m - gap_m, no_return=(math.nan,))
    robot.begin(BY_KEY['goto'], '{x: 4.5, y: 0.0}', 0.0)
    world.until_ended()
    assert robot.run.state == BLOCKED and robot.contacts == 0


def test_hold_stands_and_says_if_pushed():
    world = World()
    robot = world.add('bot1')
    robot.begin(BY_KEY['hold'], '{seconds: 2.0}', 0.0)
    for _ in range(10):
        world.step()
    robot.body.x += 0.2
    world.step()
    assert len(robot.run.said) == 1 and '0.20 m' in robot.run.said[0]
    world.until_ended()
    assert robot.run.state == DONE


def test_return_leaves_out_the_loops_of_its_trail():
    """Out along a line, around a circle, and on: the way back is the line alone."""
    turns = [2.0 * math.pi * number / 70 for number in range(1, 70)]
    trail = [Pose(0.1 * number, 0.0, 0.0) for number in range(11)]
    trail += [Pose(1.0 + math.sin(turn), 1.0 - math.cos(turn), turn) for turn in turns]
    trail += [Pose(1.0 + 0.1 * number, 0.0, 0.0) for number in range(11)]
    world = World()
    robot = world.add('bot1', 2.0, 0.0, 0.0)
    trail = [Pose(pose.x_m - 2.0, pose.y_m, pose.heading_rad) for pose in trail]
    robot.begin(BY_KEY['return'], '', 0.0, trail=trail)
    gone_m, furthest_m = 0.0, 0.0
    while robot.run.state not in (DONE, BLOCKED):
        before = robot.body.odom_x, robot.body.odom_y
        world.step()
        gone_m += math.dist(before, (robot.body.odom_x, robot.body.odom_y))
        furthest_m = max(furthest_m, min(
            math.hypot(pose.x_m - robot.body.odom_x, pose.y_m - robot.body.odom_y)
            for pose in trail))
    assert robot.run.state == DONE
    assert math.dist((robot.body.odom_x, robot.body.odom_y), (-2.0, 0.0)) < 0.1
    assert gone_m < 2.5 and furthest_m < 0.25


@pytest.mark.parametrize('places, cut_m, kept', [
    ([(0, 0)], 0.15, [(0, 0)]),
    ([(0, 0), (0.1, 0), (0.2, 0)], 0.05, [(0, 0), (0.1, 0), (0.2, 0)]),
    # There and back: the end is where it began.
    ([(0, 0), (1, 0), (2, 0), (1, 0.1), (0, 0.1)], 0.15, [(0, 0), (0, 0.1)]),
    # Past itself with more room between than may be cut: a wall may stand there.
    ([(0, 0), (1, 0), (2, 0), (2, 0.5), (1, 0.2), (0, 0.2)], 0.15,
     [(0, 0), (1, 0), (2, 0), (2, 0.5), (1, 0.2), (0, 0.2)]),
    ([(0, 0), (1, 0), (1, 1), (0.9, 0), (0, 5)], 0.15, [(0, 0), (1, 0), (0.9, 0), (0, 5)])])
def test_what_is_a_loop(places, cut_m, kept):
    assert without_loops(places, cut_m) == tuple(kept)


def test_followers_keep_their_distance_in_a_bend():
    world = World()
    team = ('bot2', 'bot3')
    leader = world.add('bot1', 0.0, 0.0)
    followers = [world.add(name, -0.9 * number, 0.0, seed=number)
                 for number, name in enumerate(team, 1)]
    leader.begin(BY_KEY['patrol'], '{route: [[2, 0], [2, 2], [0, 2]], rounds: 1}', 0.0)
    for robot in followers:
        robot.begin(BY_KEY['follow'], '{leader: bot1, distance: 0.8}', 0.0, team)
    while leader.run.state != DONE:
        world.step()
        for one, two in zip(world.robots, followers):
            assert math.hypot(one.body.x - two.body.x, one.body.y - two.body.y) < 1.3
    for _ in range(100):
        world.step()
    gap = math.hypot(leader.body.x - followers[0].body.x, leader.body.y - followers[0].body.y)
    assert 0.6 < gap < 1.0
    assert sum(robot.contacts for robot in world.robots) == 0


def on_its_way():
    """Return (world, robot): it has a goal 3 m ahead, and drives there."""
    world = World()
    robot = world.add('bot1')
    robot.begin(BY_KEY['goto'], '{x: 3, y: 0}', 0.0)
    for _ in range(40):
        world.step()
    assert robot.last.linear_mps > 0.1
    return world, robot


@pytest.mark.parametrize('obeys', ['', 'task'])
def test_a_task_begins_by_leaving_its_robot_out_unless_it_is_still_on_another(obeys):
    """Else the drive cannot tell it from one that was taken over, or stopped."""
    world = World()
    robot = world.add('bot1')
    robot.begin(BY_KEY['goto'], '{x: 3, y: 0}', 0.0)
    begun, named = world.now_s, []
    while world.now_s - begun < 2.0 * LEFT_OUT_S:
        world.step(obeys=obeys)
        named.append((world.now_s - begun, robot.run.drives))
    assert all(drives == (obeys == 'task' or after_s > LEFT_OUT_S) for after_s, drives in named
               if abs(after_s - LEFT_OUT_S) > 0.1)


ENDINGS = [
    (dict(stop_all=True), STOPPED, 'STOP ALL'),
    (dict(stands='stopped_alone'), STOPPED, ''), (dict(answers=False), LOST, ''),
    (dict(obeys='operator'), TAKEN_OVER, ''), (dict(obeys=''), LOST, ''),
    (dict(stands='not_heard'), LOST, ''), (dict(known=False), LOST, ''),
    (dict(odometry_age_s=0.6), LOST, '0.6 s'),
    (dict(odometry_age_s=0.6, odometry_note='why it is wrong'), LOST, 'why it is wrong'),
    (dict(place_age_s=0.7, place_text='why it is old'), LOST, 'why it is old'),
    (dict(place_age_s=None, place_text='why it has none'), LOST, 'why it has none'),
    (dict(battery=0.1), FAILED, '10 %')]


@pytest.mark.parametrize('facts, state, words', ENDINGS)
def test_what_ends_a_task_ends_it_with_a_zero_for_good(facts, state, words):
    world, robot = on_its_way()
    world.step(**facts)
    assert (robot.run.state, robot.last.is_zero()) == (state, True)
    assert words in robot.run.text
    for _ in range(20):
        world.step()
        assert robot.last.is_zero() and robot.run.state == state


def test_a_place_that_is_corrected_by_far_holds_the_robot_for_a_moment():
    world, robot = on_its_way()
    world.step(settling='why')
    assert robot.last.is_zero() and robot.run.state == WAITING
    assert robot.run.text == 'why'
    world.until_ended()
    assert robot.run.state == DONE


def test_no_scan_no_way_and_it_is_said():
    world, robot = on_its_way()
    robot.blind = True
    for _ in range(10):
        world.step()
    assert robot.last.linear_mps == 0.0
    assert robot.run.state == WAITING
    for _ in range(int(BLOCKED_AFTER_S / DT_S) + 2):
        world.step()
    assert robot.run.state == BLOCKED


def test_no_way_where_a_laser_looks_nobody_knows_where():
    world, robot = on_its_way()
    robot.blind = True
    for _ in range(10):
        world.step(unplaced=True)
    assert robot.last.linear_mps == 0.0 and robot.run.state == WAITING


def test_nothing_moves_before_its_gate_obeys_the_task():
    world = World()
    robot = world.add('bot1')
    robot.begin(BY_KEY['goto'], '{x: 3, y: 0}', 0.0)
    for _ in range(50):
        world.step(obeys='')
        assert robot.last.is_zero()
    while robot.run.state != FAILED:
        world.step(obeys='')
        assert world.now_s < 10.0


def test_who_has_the_higher_number_lets_the_other_pass():
    world = World(room(8.0, 8.0))
    for name, x, y in (('bot1', 0.0, -2.0), ('bot2', -2.0, 0.0)):
        world.add(name, x, y, 1.57 if x == 0.0 else 0.0)
    world.robots[0].begin(BY_KEY['goto'], '{x: 0, y: 2}', 0.0)
    world.robots[1].begin(BY_KEY['goto'], '{x: 2, y: 0}', 0.0)
    waited = False
    while any(robot.run.state != DONE for robot in world.robots):
        world.step()
        waited = waited or 'bot1' in world.robots[1].run.text
        assert 'bot2' not in world.robots[0].run.text
        assert world.now_s < 60.0
    assert waited and not sum(robot.contacts for robot in world.robots)


@pytest.mark.parametrize('seed', range(5))
def test_random_goals_end_without_contact(seed):
    robot = random_goal(seed)
    assert robot.run.state in (DONE, BLOCKED), robot.run.text
    assert robot.contacts == 0


PARAMETERS = [
    ('goto', '', 'x'), ('goto', '{x: 1, y: two}', 'y'), ('goto', '{x: 1, y: 2, z: 3}', 'z'),
    ('goto', '{x: 1e9, y: 2}', 'x'), ('goto', '{x: 1, y: 2, frame: base}', 'frame'),
    ('square', '{side: 0.0}', 'side'), ('square', '{side: 1, number: 1.5}', 'number'),
    ('patrol', '{route: [[1, .nan]]}', 'route'), ('patrol', '{route: 3}', 'route'),
    ('formation', '{leader: bot1, shape: circle}', 'shape'), ('follow', '{}', 'leader'),
    ('hold', '{team: [bot1, bot1]}', 'team'), ('hold', '{team: [1, 2]}', 'team')]


@pytest.mark.parametrize('task, parameters, key', PARAMETERS)
def test_unusable_parameters_are_refused_by_key(task, parameters, key):
    with pytest.raises(ConfigError) as refused:
        BY_KEY[task].read(parameters)
    assert refused.value.key == key
