# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The floor plan: its file, its distances, and the building that is shipped."""
from collections import deque
import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from mhri.base.config import ConfigError
from mhri.sim.body import parse_bodies
from mhri.sim.floor_map import grid_of_plan
from mhri.sim.plan import disc_distance, parse_plan

SIM = Path(__file__).resolve().parents[2] / 'resource' / 'sim'
DRILLS = SIM.parent / 'drills'
SHIPPED = parse_plan((SIM / 'plan.yaml').read_text(), 'plan.yaml')
BODIES = parse_bodies((SIM / 'bodies.yaml').read_text(), 'bodies.yaml')
SMALL = """
name: room
wall_height: 2.0
wall_colour: [1, 2, 3]
floor_colour: [4, 5, 6]
walls: [[[0, 0], [4, 0], [4, 2]], [[1, 1], [1, 2]]]
landmarks:
  - {name: post, colour: [7, 8, 9], x: 3, y: 1, radius: 0.5, height: 1.5}
starts: [[2, 1, 0]]
"""


def test_small_plan():
    plan = parse_plan(SMALL, 'room.yaml')
    assert plan.walls.tolist() == [[0, 0, 4, 0], [4, 0, 4, 2], [1, 1, 1, 2]]
    assert (plan.name, plan.wall_height_m, plan.wall_colour, plan.floor_colour) == (
        'room', 2.0, (1, 2, 3), (4, 5, 6))
    post = plan.landmarks[0]
    assert (post.name, post.colour, post.height_m) == ('post', (7, 8, 9), 1.5)
    assert plan.discs().tolist() == [[3.0, 1.0, 0.5]]
    assert plan.starts == ((2.0, 1.0, 0.0),)


def test_what_is_to_be_searched_for_stands_there_but_not_on_the_map():
    plan = parse_plan(SMALL.replace('height: 1.5', 'height: 1.5, on_map: false'), 'room.yaml')
    assert plan.distance(3.0, 1.0) == pytest.approx(-0.5)
    grids = [grid_of_plan(plan), grid_of_plan(parse_plan(SMALL, 'room.yaml'))]
    assert [math.dist((3.0, 1.0), place) < 0.5 for grid in grids
            for place in [min(grid.taken(), key=lambda at: math.dist((3.0, 1.0), at))]] == [
                False, True]


def test_the_cans_of_the_search_drill_are_not_on_its_map():
    rows = yaml.safe_load((DRILLS / 'search.yaml').read_text())
    plan = parse_plan((DRILLS / 'plans' / rows['plan']).read_text(), rows['plan'])
    taken = grid_of_plan(plan).taken()
    for target in rows['targets']:
        middle = np.array((target['x'], target['y']))
        assert np.hypot(*(taken - middle).T).min() > 0.2, target['name']


def test_plan_without_landmarks():
    plan = parse_plan(SMALL.split('landmarks:')[0] + 'landmarks: []\nstarts: [[0, 0, 0]]', 'x')
    assert plan.discs().shape == (0, 3) and plan.distance(3.0, 1.0) == pytest.approx(1.0)


@pytest.mark.parametrize('x, y, wanted', [
    (2.0, 0.3, 0.3),
    (2.0, -0.3, 0.3),
    (-0.3, -0.4, 0.5),
    (1.0, 0.6, 0.4),
    (1.2, 1.7, 0.2),
    (1.3, 2.4, 0.5),
    (2.0, 1.0, 0.5),
    (3.0, 1.0, -0.5),
    (3.25, 1.0, -0.25),
    (1.0, 1.5, 0.0),
])
def test_distance(x, y, wanted):
    assert parse_plan(SMALL, 'x').distance(x, y) == pytest.approx(wanted)


@pytest.mark.parametrize('discs, wanted', [
    ([], math.inf), ([(3, 4, 1)], 4.0), ([(3, 4, 1), (1, 0, 0.5)], 0.5), ([(0, 0, 2)], -2.0)])
def test_disc_distance(discs, wanted):
    assert disc_distance(np.array(discs, dtype=float).reshape(-1, 3), 0.0, 0.0) == wanted


@pytest.mark.parametrize('old, new, said', [
    ('name: room', 'name: 5', 'name: expected text'),
    ('name: room', '', 'name: is missing'),
    ('wall_height: 2.0', 'wall_height: low', 'wall_height: expected a number'),
    ('wall_colour: [1, 2, 3]', 'wall_colour: [1, 2, 3.5]', 'wall_colour: expected red'),
    ('wall_colour: [1, 2, 3]', 'wall_colour: [1, 2, -3]', 'wall_colour: expected red'),
    ('floor_colour: [4, 5, 6]', 'floor_color: [4, 5, 6]', 'floor_colour: is missing'),
    ('name: room', 'name: room\nroof: flat', 'roof: unknown key'),
    ('[[1, 1], [1, 2]]', '[[1, 1]]', 'walls: a wall needs two corners'),
    ('[[1, 1], [1, 2]]', '[[1, 1], [1, 2, 3]]', 'walls: expected 2 numbers'),
    ('[[1, 1], [1, 2]]', '[[1, 1], [1, .nan]]', 'walls: expected 2 numbers'),
    ('[[1, 1], [1, 2]]', '[[1, 1], [1, .inf]]', 'walls: expected 2 numbers'),
    ('[[1, 1], [1, 2]]', '[[1, 1], [true, 2]]', 'walls: expected 2 numbers'),
    ('[[1, 1], [1, 2]]', '7', 'walls: expected a list'),
    ('walls: [[[0, 0], [4, 0], [4, 2]], [[1, 1], [1, 2]]]', 'walls: []', 'walls: '),
    ('walls: [[[0, 0], [4, 0], [4, 2]], [[1, 1], [1, 2]]]', 'walls: 3', 'walls: expected a list'),
    ('radius: 0.5', 'radius: 0', 'landmarks[0].radius: expected a number'),
    ('radius: 0.5', 'radius: .nan', 'landmarks[0].radius: expected a number'),
    ('height: 1.5', 'height: 1.5, depth: 1', 'landmarks[0].depth: unknown key'),
    ('colour: [7, 8, 9]', 'colour: [7, 8, 999]', 'landmarks[0].colour: expected red'),
    ('starts: [[2, 1, 0]]', 'starts: []', 'starts: '),
    ('starts: [[2, 1, 0]]', 'starts: [[2, 1]]', 'starts: expected 3 numbers'),
    ('starts: [[2, 1, 0]]', 'starts: [2, 1, 0]', 'starts: expected 3 numbers'),
    ('starts: [[2, 1, 0]]', 'starts: 5', 'starts: expected a list'),
    ('name: room', 'name: [', 'is not valid YAML'),
])
def test_wrong_plan_is_refused_by_file_and_key(old, new, said):
    assert old in SMALL
    with pytest.raises(ConfigError) as caught:
        parse_plan(SMALL.replace(old, new), 'my/plan.yaml')
    assert str(caught.value).startswith('my/plan.yaml: ' + said)


def test_start_places_are_free_for_every_body():
    widest = max(body.radius_m for body in BODIES.values())
    assert len(SHIPPED.starts) >= 12
    for number, (x, y, _) in enumerate(SHIPPED.starts):
        assert SHIPPED.distance(x, y) > widest + 0.1
        for other_x, other_y, _ in SHIPPED.starts[:number]:
            assert math.hypot(x - other_x, y - other_y) > 2.0 * widest + 0.2


@pytest.mark.parametrize('count', [3, 12])
def test_from_its_start_each_can_drive_a_metre_with_the_others_standing(count):
    widest = max(body.radius_m for body in BODIES.values())
    for number, (x, y, yaw) in enumerate(SHIPPED.starts[:count]):
        others = np.array([(ox, oy, widest) for index, (ox, oy, _) in enumerate(SHIPPED.starts)
                           if index != number and index < count])
        for metres in np.linspace(0.0, 1.0, 50):
            at = (x + metres * math.cos(yaw), y + metres * math.sin(yaw))
            assert SHIPPED.distance(*at) > widest
            assert disc_distance(others, *at) > widest


@pytest.mark.parametrize('turn', [1.0, -1.0])
def test_first_three_can_drive_a_metre_and_a_bend_together(turn):
    widest = max(body.radius_m for body in BODIES.values())
    for x, y, _ in SHIPPED.starts[:3]:
        for angle in np.linspace(0.0, math.pi / 2.0, 40):
            bend = (x + 1.0 + 0.5 * math.sin(angle), y + turn * 0.5 * (1.0 - math.cos(angle)))
            assert SHIPPED.distance(*bend) > widest


def test_every_room_can_be_reached_by_the_widest_body():
    widest = max(body.radius_m for body in BODIES.values()) + 0.1
    grid_m = 0.1
    free = np.array([[SHIPPED.distance(column * grid_m, row * grid_m) > widest
                      for row in range(91)] for column in range(121)])
    start = tuple(int(round(value / grid_m)) for value in SHIPPED.starts[0][:2])
    reached, todo = {start}, deque([start])
    while todo:
        column, row = todo.popleft()
        for near in ((column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1)):
            if near not in reached and 0 <= near[0] <= 120 and 0 <= near[1] <= 90 and free[near]:
                reached.add(near)
                todo.append(near)
    assert len(reached) == free.sum(), 'some part of the building has no door'
    assert len({item.colour for item in SHIPPED.landmarks}) == len(SHIPPED.landmarks) >= 4
