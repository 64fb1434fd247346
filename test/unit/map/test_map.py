# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pure part of the map: pixels and places, trails, spreading out, gestures, the scene."""
import math

import numpy as np
import pytest

from mhri.base.geometry import Pose
from mhri.base.task_views import TaskView
from mhri.base.views import GONE, LinkFigures, LIVE, RobotView
from mhri.map import gesture
from mhri.map.canvas import Canvas, MAX_PX_PER_M, MIN_PX_PER_M
from mhri.map.grid import Grid
from mhri.map.scan_memory import OLD_SCAN_S, ScanMemory
from mhri.map.scene import goals_of, map_robot, MapMark, MapRobot, Placing, Scene, UnderWay
from mhri.map.spread import has_room, SPACING_RADII, spread
from mhri.map.trail import GOOD, link_grade, LOST, SLOW, Trail


def test_the_scans_of_all_lasers_are_drawn_until_they_are_old():
    memory = ScanMemory()
    assert memory.points(0.0) is None
    memory.add(0, np.array([[1.0, 0.0]]), 0.0)
    memory.add(1, np.array([[2.0, 0.0], [3.0, 0.0]]), 0.5)
    assert memory.points(0.5).tolist() == [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]
    memory.add(1, np.array([[4.0, 0.0]]), 0.6)
    assert memory.points(OLD_SCAN_S).tolist() == [[1.0, 0.0], [4.0, 0.0]]
    assert memory.points(OLD_SCAN_S + 0.1).tolist() == [[4.0, 0.0]]
    assert memory.points(OLD_SCAN_S + 0.7) is None


def near(one, other):
    return one == pytest.approx(other, abs=1e-6)


CANVASES = [Canvas(800, 600), Canvas(333, 777, 4.0, -2.5, 17.0, 2.2),
            Canvas(10, 20, -300.0, 7.0, 400.0, -math.pi)]


@pytest.mark.parametrize('canvas', CANVASES)
@pytest.mark.parametrize('place', [(0.0, 0.0), (3.2, -1.7), (-900.0, 450.0)])
def test_a_place_has_a_pixel_and_the_pixel_that_place(canvas, place):
    assert near(canvas.world(*canvas.pixel(*place)), place)
    assert near(canvas.pixels(np.array([place]))[0].tolist(), canvas.pixel(*place))


def test_north_is_up_and_a_turned_map_turns_to_the_left():
    assert near(Canvas(100, 100, px_per_m=10.0).pixel(1.0, 2.0), (60.0, 30.0))
    turned = Canvas(100, 100, px_per_m=10.0, turn_rad=math.pi / 2.0)
    assert near(turned.pixel(1.0, 0.0), (50.0, 40.0))
    assert near(turned.heading(0.0), math.pi / 2.0)


def test_zoom_and_pan_have_their_bounds():
    assert Canvas(100, 100).zoomed(1e9, 5, 5).px_per_m == MAX_PX_PER_M
    assert Canvas(100, 100).zoomed(1e-9, 5, 5).px_per_m == MIN_PX_PER_M
    assert Canvas(100, 100, px_per_m=2.0).panned(-1e6, 0.0).x_m == 1000.0


# Trails.

@pytest.mark.parametrize('figures, live, grade', [
    (LinkFigures(), True, GOOD), (LinkFigures(0.02, loss=0.0), True, GOOD),
    (LinkFigures(0.4), True, SLOW), (LinkFigures(loss=0.2), True, SLOW),
    (LinkFigures(0.02), False, LOST)])
def test_the_grade_of_a_link(figures, live, grade):
    assert link_grade(figures, live) == grade


def test_a_trail_is_bounded_and_keeps_both_ends():
    trail = Trail(most=50)
    for step in range(1000):
        trail.add(Pose(0.1 * step, 0.0, 0.0), GOOD, float(step))
        assert len(trail) <= 50
    (_, places), = trail.pieces(True, 1000.0)
    assert places[-1].tolist() == pytest.approx([99.9, 0.0])
    assert len(places) > 20


def test_the_pieces_of_a_trail_meet_where_the_link_changes():
    trail = Trail()
    for step, link in enumerate((GOOD, GOOD, SLOW, SLOW, GOOD)):
        trail.add(Pose(0.2 * step, 0.0, 0.0), link, float(step))
    pieces = [(grade, places[:, 0].round(1).tolist()) for grade, places in trail.pieces(True, 5.0)]
    assert pieces == [(GOOD, [0.0, 0.2, 0.4]), (SLOW, [0.4, 0.6, 0.8])]
    assert [grade for grade, _ in trail.pieces(False, 12.5)] == [1, 0]


def test_a_robot_that_is_placed_anew_does_not_drive_there():
    trail = Trail()
    for x_m in (0.0, 0.2, 5.0, 5.2):
        trail.add(Pose(x_m, 0.0, 0.0), GOOD, 0.0)
    assert [places[:, 0].round(1).tolist() for _, places in trail.pieces(True, 0.0)] == [
        [0.0, 0.2], [5.0, 5.2]]
    assert trail.tail(-1.0)[:, 0].round(1).tolist() == [5.0, 5.2]


# Several to one place.

GOAL = Pose(2.0, 1.0, 0.7)


@pytest.mark.parametrize('count', range(1, 13))
def test_several_are_spread_out_side_by_side(count):
    robots = {'bot{}'.format(number): Pose(0.3 * number, -2.0, 0.0) for number in range(count)}
    found = spread(GOAL, robots, 0.2)
    assert set(found) == set(robots)
    poses = list(found.values())
    for index, one in enumerate(poses):
        assert one.heading_rad == GOAL.heading_rad
        for other in poses[:index]:
            assert math.hypot(one.x_m - other.x_m, one.y_m - other.y_m) >= \
                SPACING_RADII * 0.2 - 1e-9
    # The first row has the goal in its middle, and nobody stands in front of it.
    ahead = [(pose.x_m - GOAL.x_m) * math.cos(0.7) + (pose.y_m - GOAL.y_m) * math.sin(0.7)
             for pose in poses]
    assert max(ahead) == pytest.approx(0.0)


def test_nobody_is_sent_to_where_nobody_can_stand():
    robots = {name: None for name in 'abc'}
    found = spread(Pose(0.0, 0.0, 0.0), robots, 0.2, lambda x_m, y_m: y_m < 0.1)
    assert len(found) == 3 and all(pose.y_m < 0.1 for pose in found.values())
    assert spread(Pose(0.0, 0.0, 0.0), robots, 0.2, lambda x_m, y_m: False) == {}


def test_nobody_is_sent_into_a_wall():
    cells = np.zeros((40, 40), np.int8)
    cells[:, 20] = 100
    for origin in (Pose(-1.0, -1.0, 0.0), Pose(1.0, -1.0, math.pi / 2.0)):
        grid = Grid(0.05, origin, cells)
        # The wall is one cell wide, along an axis from the middle.
        along_y = origin.heading_rad == 0.0
        for off, room in ((0.0, False), (0.2, False), (0.3, True), (-0.2, False), (-0.27, True)):
            place = (off, 0.3) if along_y else (0.3, off)
            assert has_room(grid, *place, 0.25) == room, (origin, off)
        assert has_room(grid, 50.0, -50.0, 0.25)


# What is drawn.

def test_a_goal_is_pressed_dragged_and_let_go():
    drawn = gesture.Gesture()
    drawn.choose_tool(gesture.GOTO)
    drawn.press(1.0, 2.0)
    assert math.isnan(drawn.pose.heading_rad)
    drawn.drag(1.0, 3.0, 0.2)
    assert drawn.pose.heading_rad == pytest.approx(math.pi / 2.0)
    act = drawn.release(1.0, 3.0, 0.2)
    assert act == gesture.Act(gesture.GOTO, Pose(1.0, 2.0, math.pi / 2.0), True)
    assert drawn.tool == gesture.LOOK and drawn.pose is None


@pytest.mark.parametrize('tool, least', [(gesture.ROUTE, 1), (gesture.FENCE, 3)])
def test_corners_are_clicked_and_ended(tool, least):
    drawn = gesture.Gesture()
    drawn.choose_tool(tool)
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)][:least]
    for number, corner in enumerate(corners):
        assert drawn.problem() and drawn.finish() is None
        drawn.press(*corner)
        assert drawn.release(*corner, 0.1) is None
        assert len(drawn.corners) == number + 1
    # The second click of a double click.
    drawn.release(*corners[-1], 0.1)
    assert drawn.finish() == gesture.Act(tool, corners=tuple(corners))
    assert drawn.tool == gesture.LOOK and drawn.corners == ()


# The scene.

VIEW = RobotView('bot2', link=LIVE, x_m=1.0, y_m=0.0, heading_rad=0.0, number=2)


def test_a_robot_is_where_its_odometry_has_taken_it_since_it_was_placed():
    robot = map_robot(VIEW, Placing(Pose(5.0, 5.0, math.pi / 2.0), 'by hand'), 0.2, True)
    assert near((robot.pose.x_m, robot.pose.y_m), (5.0, 6.0))
    assert robot.pose.heading_rad == pytest.approx(math.pi / 2.0)
    assert (robot.text, robot.old, robot.looked_at) == ('by hand', False, True)


@pytest.mark.parametrize('view, placing, text', [
    (VIEW, None, 'not placed: place it'),
    (VIEW, Placing(None, 'no tf from map'), 'no tf from map'),
    (RobotView('bot2'), Placing(Pose(0, 0, 0), 'by hand'), 'odometry')])
def test_a_robot_that_is_nowhere_says_why(view, placing, text):
    robot = map_robot(view, placing, 0.2, False)
    assert robot.pose is None and text in robot.text


@pytest.mark.parametrize('more, word, task', [
    ({}, 'standing', ''), ({'moving': True}, 'moving', ''), ({'selected': True}, 'selected', ''),
    ({'selected': True, 'driven': True}, 'driving', ''),
    ({'obeys': 'task', 'driven': True}, 'on a task', 'task'),
    ({'task': TaskView('Patrol')}, 'patrol', 'Patrol'),
    ({'task': TaskView('Go to', waits=True)}, 'go to waits', 'Go to')])
def test_the_state_of_a_robot_is_a_word(more, word, task):
    view = RobotView(**{**vars(VIEW), **more})
    robot = map_robot(view, Placing(Pose(0.0, 0.0, 0.0), ''), 0.2, False)
    assert (robot.state, robot.task, robot.trouble) == (word, task, '')


def test_what_is_old_is_said_and_dimmed():
    origin = Pose(0.0, 0.0, 0.0)
    robot = map_robot(VIEW, Placing(origin, 'placed by tf', 12.0), 0.2, False)
    assert robot.old and '12 s old' in robot.text
    gone = RobotView('bot2', link=GONE, x_m=0.0, y_m=0.0, heading_rad=0.0, age_s=30.0)
    robot = map_robot(gone, Placing(origin, 'placed by hand'), 0.2, False)
    assert robot.old and '30 s old' in robot.text and robot.trouble == GONE


def test_goals_are_read_from_the_parameters_of_tasks():
    goals, leaders = goals_of((
        UnderWay('goto', '{x: 1.0, y: -2, heading: 0.5}', ('bot1',)),
        UnderWay('patrol', '{route: [[0, 0], [1, 0], [1, 1]]}', ('bot2', 'bot3')),
        UnderWay('follow', '{leader: bot1}', ('bot4', 'bot5')),
        UnderWay('goto', '{x: 1.0, y: 2.0, frame: odom}', ('bot6',)),
        UnderWay('square', '{side: 1.0}', ('bot7',)), UnderWay('x', '{x: [', ('bot8',)),
        UnderWay('x', '{route: [[a, 0]], x: .nan, y: 0}', ('bot9',))))
    assert [(goal.robots, goal.route, goal.heading_rad, goal.closed) for goal in goals] == [
        (('bot1',), ((1.0, -2.0),), 0.5, False),
        (('bot2', 'bot3'), ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), None, True)]
    assert leaders == (('bot4', 'bot1'), ('bot5', 'bot1'))


def test_who_is_meant_and_what_is_where():
    scene = Scene(robots=(
        MapRobot('bot1', pose=Pose(0.0, 0.0, 0.0), looked_at=True),
        MapRobot('bot2', pose=Pose(1.0, 0.0, 0.0)), MapRobot('bot3')),
        marks=(MapMark('dock', Pose(3.0, 0.0, 0.0)),), fence=((5.0, 5.0), (6.0, 5.0), (6.0, 6.0)))
    assert scene.targets() == ('bot1',)
    assert scene.at(0.9, 0.1, 0.05).name == 'bot2' and scene.at(2.0, 0.0, 0.2) is None
    assert scene.mark_at(3.1, 0.0, 0.2).name == 'dock' and scene.mark_at(0.0, 0.0, 0.2) is None
    assert scene.bounds() == ((0.0, 0.0), (6.0, 6.0))
    assert Scene().bounds() is None
    chosen = Scene(robots=(MapRobot('bot1', looked_at=True), MapRobot('bot2', selected=True)))
    assert chosen.targets() == ('bot2',)
