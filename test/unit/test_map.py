# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pure part of the map: pixels and places, trails, spreading out, gestures, the scene."""
import math

import numpy as np
import pytest

from mhri.base.mocap import Pose
from mhri.base.task_views import TaskView
from mhri.base.views import GONE, LinkFigures, LIVE, RobotView
from mhri.map import gesture
from mhri.map.canvas import (
    Canvas, known_corners, LEAST_PX_PER_M, length_words, MOST_PX_PER_M, place_words, scale_bar)
from mhri.map.grid import Grid
from mhri.map.met import Met, OLD_SCAN_S
from mhri.map.scene import (
    goals_of, in_frame, map_robot, MapMark, MapRobot, own_pose, Placing, Scene, UnderWay)
from mhri.map.spread import has_room, SPACING_RADII, spread
from mhri.map.track import Track
from mhri.map.trail import GOOD, link_grade, LOST, SLOW, Trail


def test_the_scans_of_all_lasers_are_drawn_until_they_are_old():
    met = Met()
    assert met.points(0.0) is None
    met.see(0, np.array([[1.0, 0.0]]), 0.0)
    met.see(1, np.array([[2.0, 0.0], [3.0, 0.0]]), 0.5)
    assert met.points(0.5).tolist() == [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]
    met.see(1, np.array([[4.0, 0.0]]), 0.6)
    assert met.points(OLD_SCAN_S).tolist() == [[1.0, 0.0], [4.0, 0.0]]
    assert met.points(OLD_SCAN_S + 0.1).tolist() == [[4.0, 0.0]]
    assert met.points(OLD_SCAN_S + 0.7) is None


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


@pytest.mark.parametrize('canvas', CANVASES)
def test_what_is_under_the_pointer_stays_there_while_it_zooms(canvas):
    before = canvas.world(7.0, 11.0)
    assert canvas.zoomed(1.7, 7.0, 11.0).world(7.0, 11.0) == pytest.approx(before, abs=1e-6)


def test_zoom_and_pan_have_their_bounds():
    assert Canvas(100, 100).zoomed(1e9, 5, 5).px_per_m == MOST_PX_PER_M
    assert Canvas(100, 100).zoomed(1e-9, 5, 5).px_per_m == LEAST_PX_PER_M
    assert Canvas(100, 100, px_per_m=2.0).panned(-1e6, 0.0).x_m == 1000.0


def test_panning_moves_everything_with_the_pointer():
    canvas = CANVASES[1]
    before = canvas.pixel(1.0, 2.0)
    assert near(canvas.panned(30.0, -8.0).pixel(1.0, 2.0), (before[0] + 30.0, before[1] - 8.0))


def test_everything_is_shown_with_a_margin():
    canvas = Canvas(400, 300).showing((-3.0, -1.0), (5.0, 2.0))
    for corner in ((-3.0, -1.0), (5.0, 2.0)):
        right, down = canvas.pixel(*corner)
        assert 0.0 < right < 400.0 and 0.0 < down < 300.0
    assert Canvas(400, 300).showing((1.0, 1.0), (1.0, 1.0)).px_per_m == 150.0


def test_it_follows_only_what_leaves_the_middle():
    canvas = Canvas(300, 300, px_per_m=10.0)
    assert canvas.follows(3.0, -3.0) is canvas
    right, down = canvas.follows(20.0, 0.0).pixel(20.0, 0.0)
    assert near((right, down), (200.0, 150.0))


@pytest.mark.parametrize('px_per_m, most, length', [
    (60.0, 180.0, 2.0), (100.0, 100.0, 1.0), (1000.0, 180.0, 0.1), (2.0, 180.0, 50.0),
    (7.0, 180.0, 20.0), (59.9, 300.0, 5.0)])
def test_the_scale_bar_is_one_two_or_five(px_per_m, most, length):
    found, pixels = scale_bar(px_per_m, most)
    assert near((found, pixels), (length, length * px_per_m)) and pixels <= most * 1.001


def test_lengths_and_places_have_units():
    assert [length_words(length) for length in (0.05, 0.2, 1.0, 50.0, 2000.0)] == [
        '5 cm', '20 cm', '1 m', '50 m', '2 km']
    assert place_words(1.234, -0.5) == 'x   1.23 m  y  -0.50 m'


def test_the_known_part_of_a_map():
    cells = np.full((10, 20), -1, np.int8)
    assert known_corners(Grid(0.5, Pose(0, 0, 0), cells)) == []
    cells[2:4, 5:9] = 0
    corners = known_corners(Grid(0.5, Pose(1.0, 2.0, 0.0), cells))
    assert sorted(corners) == [(3.5, 3.0), (3.5, 4.0), (5.5, 3.0), (5.5, 4.0)]


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


def test_a_robot_that_stands_leaves_no_trail():
    trail = Trail()
    assert trail.add(Pose(1.0, 1.0, 0.0), GOOD, 0.0)
    assert not trail.add(Pose(1.02, 1.0, 2.0), GOOD, 1.0)
    assert list(trail.pieces(True, 1.0)) == []


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


def test_where_it_was_a_moment_ago():
    track = Track()
    assert track.at(0.0) is None
    for at_s, heading in ((1.0, 3.0), (2.0, -3.0), (2.0, 9.0)):
        track.add(at_s, Pose(at_s, 0.0, heading))
    assert track.at(0.5).x_m == 1.0 and track.at(9.0).x_m == 2.0
    middle = track.at(1.5)
    # The short way round.
    assert middle.x_m == 1.5 and abs(middle.heading_rad) == pytest.approx(math.pi, abs=1e-6)


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


def test_one_alone_goes_to_the_goal_itself():
    assert spread(GOAL, {'bot1': None}, 0.2) == {'bot1': GOAL}


def test_their_ways_do_not_cross():
    robots = {'right': Pose(0.0, -1.0, 0.0), 'left': Pose(0.0, 1.0, 0.0)}
    found = spread(Pose(5.0, 0.0, 0.0), robots, 0.3)
    assert found['left'].y_m > 0.0 > found['right'].y_m


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
    drawn.take(gesture.GOTO)
    drawn.press(1.0, 2.0)
    assert math.isnan(drawn.pose.heading_rad)
    drawn.drag(1.0, 3.0, 0.2)
    assert drawn.pose.heading_rad == pytest.approx(math.pi / 2.0)
    act = drawn.release(1.0, 3.0, 0.2)
    assert act == gesture.Act(gesture.GOTO, Pose(1.0, 2.0, math.pi / 2.0), True)
    assert drawn.tool == gesture.LOOK and drawn.pose is None


def test_a_short_drag_is_a_click():
    drawn = gesture.Gesture()
    drawn.take(gesture.MARK)
    drawn.press(1.0, 2.0)
    act = drawn.release(1.05, 2.0, 0.2)
    assert (act.pose, act.aimed) == (Pose(1.0, 2.0, 0.0), False)


@pytest.mark.parametrize('tool, least', [(gesture.ROUTE, 1), (gesture.FENCE, 3)])
def test_corners_are_clicked_and_ended(tool, least):
    drawn = gesture.Gesture()
    drawn.take(tool)
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


def test_a_corner_is_taken_back_and_another_tool_drops_all():
    drawn = gesture.Gesture()
    drawn.take(gesture.ROUTE)
    drawn.release(0.0, 0.0, 0.1)
    drawn.release(1.0, 0.0, 0.1)
    drawn.undo()
    assert drawn.corners == ((0.0, 0.0),)
    drawn.take(gesture.LOOK)
    drawn.undo()
    assert drawn.corners == () and drawn.finish() is None
    drawn.press(0.0, 0.0)
    assert drawn.release(0.0, 0.0, 0.1) is None


def test_every_tool_says_what_to_do():
    assert all(gesture.HINTS[tool].format('bot1') for tool in gesture.TOOLS)


# The scene.

VIEW = RobotView('bot2', link=LIVE, x_m=1.0, y_m=0.0, heading_rad=0.0, number=2)


def test_a_robot_is_where_its_odometry_has_taken_it_since_it_was_placed():
    robot = map_robot(VIEW, Placing(Pose(5.0, 5.0, math.pi / 2.0), 'placed by hand'), 0.2, True)
    assert near((robot.pose.x_m, robot.pose.y_m), (5.0, 6.0))
    assert robot.pose.heading_rad == pytest.approx(math.pi / 2.0)
    assert (robot.text, robot.old, robot.looked_at) == ('placed by hand', False, True)


@pytest.mark.parametrize('view, placing, text', [
    (VIEW, None, 'not placed: place it'),
    (VIEW, Placing(None, 'no tf from map'), 'no tf from map'),
    (RobotView('bot2'), Placing(Pose(0, 0, 0), 'by hand'), 'its odometry is not heard')])
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


def test_numbers_that_are_none_are_no_pose():
    assert own_pose(RobotView('bot1', x_m=math.nan, y_m=0.0, heading_rad=0.0)) is None


def test_what_is_old_is_said_and_dimmed():
    origin = Pose(0.0, 0.0, 0.0)
    robot = map_robot(VIEW, Placing(origin, 'placed by tf', 12.0), 0.2, False)
    assert robot.old and '12 s old' in robot.text
    gone = RobotView('bot2', link=GONE, x_m=0.0, y_m=0.0, heading_rad=0.0, age_s=30.0)
    robot = map_robot(gone, Placing(origin, 'placed by hand'), 0.2, False,
                      points=np.zeros((3, 2)))
    assert robot.old and '30 s old' in robot.text and robot.trouble == GONE
    assert robot.points is None


def test_points_are_turned_into_the_frame():
    points = in_frame(Pose(1.0, 1.0, math.pi / 2.0), np.array([[2.0, 0.0], [0.0, 1.0]]))
    assert points.tolist() == [pytest.approx([1.0, 3.0]), pytest.approx([0.0, 1.0])]


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
