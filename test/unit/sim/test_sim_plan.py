# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The floor plan: its file, its distances, and the building that is shipped."""
from collections import deque
from pathlib import Path

import numpy as np
import pytest
import yaml

from mhri.base.config import ConfigError
from mhri.sim.body import parse_bodies
from mhri.sim.floor_map import grid_of_plan
from mhri.sim.plan import parse_plan

SIM = Path(__file__).resolve().parents[3] / 'resource' / 'sim'
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


def test_the_cans_of_the_search_drill_are_not_on_its_map():
    rows = yaml.safe_load((DRILLS / 'search.yaml').read_text())
    plan = parse_plan((DRILLS / 'plans' / rows['plan']).read_text(), rows['plan'])
    taken = grid_of_plan(plan).taken()
    for target in rows['targets']:
        middle = np.array((target['x'], target['y']))
        assert np.hypot(*(taken - middle).T).min() > 0.2, target['name']


@pytest.mark.parametrize('x, y, wanted', [
    (2.0, -0.3, 0.3), (-0.3, -0.4, 0.5), (1.3, 2.4, 0.5), (2.0, 1.0, 0.5), (3.25, 1.0, -0.25),
    (1.0, 1.5, 0.0)])
def test_distance(x, y, wanted):
    assert parse_plan(SMALL, 'x').distance(x, y) == pytest.approx(wanted)


@pytest.mark.parametrize('old, new, key', [
    ('wall_height: 2.0', 'wall_height: low', 'wall_height'),
    ('wall_colour: [1, 2, 3]', 'wall_colour: [1, 2, -3]', 'wall_colour'),
    ('name: room', 'name: room\nroof: flat', 'roof'), ('[[1, 1], [1, 2]]', '[[1, 1]]', 'walls'),
    ('[[1, 1], [1, 2]]', '[[1, 1], [1, .nan]]', 'walls'),
    ('radius: 0.5', 'radius: .nan', 'landmarks[0].radius'),
    ('starts: [[2, 1, 0]]', 'starts: []', 'starts')])
def test_wrong_plan_is_refused_by_file_and_key(old, new, key):
    assert old in SMALL
    with pytest.raises(ConfigError) as caught:
        parse_plan(SMALL.replace(old, new), 'my/plan.yaml')
    assert (caught.value.origin, caught.value.key) == ('my/plan.yaml', key)


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
