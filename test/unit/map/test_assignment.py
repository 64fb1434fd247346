# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who of several robots takes which place: the least way together, and no ways that cross."""
from itertools import combinations, permutations
import math

import numpy as np
import pytest

from mhri.base.geometry import Pose
from mhri.map.assignment import assigned, shared_out
from mhri.map.spread import spread
from mhri.tasks.rows import BY_KEY


@pytest.mark.parametrize('seed', range(60))
def test_no_other_choice_costs_less(seed):
    chance = np.random.default_rng(seed)
    rows, more = seed % 6, int(chance.integers(0, 3))
    costs = chance.random((rows, rows + more)) if seed % 3 else chance.integers(
        0, 3, (rows, rows + more)).astype(float)
    found = assigned(costs)
    assert len(set(found)) == rows
    least = min(sum(costs[row, column] for row, column in enumerate(order))
                for order in permutations(range(rows + more), rows))
    assert sum(costs[row, column] for row, column in enumerate(found)) == pytest.approx(least)


def cross(one, two):
    """Return whether two ways ((x, y), (x, y)) cross."""
    def side(way, point):
        (x1, y1), (x2, y2) = way
        return (x2 - x1) * (point[1] - y1) - (y2 - y1) * (point[0] - x1)
    return side(one, two[0]) * side(one, two[1]) < 0.0 \
        and side(two, one[0]) * side(two, one[1]) < 0.0


@pytest.mark.parametrize('count', [2, 4, 7, 12])
@pytest.mark.parametrize('seed', range(5))
def test_no_ways_cross(count, seed):
    chance = np.random.default_rng(seed)
    poses = {'bot{}'.format(number): Pose(*chance.uniform(-4.0, 4.0, 2), heading_rad=0.0)
             for number in range(count)}
    goals = spread(Pose(6.0, 1.0, 0.4), poses, 0.2)
    ways = [((pose.x_m, pose.y_m), (goals[name].x_m, goals[name].y_m))
            for name, pose in poses.items()]
    assert not any(cross(*pair) for pair in combinations(ways, 2))


def test_where_places_are_few_the_far_ones_get_none():
    poses = [Pose(x, 0.0, 0.0) for x in (9.0, 1.0, 5.0)]
    assert shared_out(poses, [(0.0, 0.0), (4.0, 0.0)]) == [None, 0, 1]
    assert shared_out(poses, []) == [None] * 3
    assert shared_out([], [(0.0, 0.0)]) == []


@pytest.mark.parametrize('key, parameters, places', [
    ('goto', '{x: 2.0, y: 1.0}', [(2.0, 1.0), (2.0, 1.7), (2.0, 0.3)]),
    ('goto', '{x: 2.0, y: 1.0, frame: odom}', []),
    ('formation', '{leader: bot9, shape: column, spacing: 1.0}', [(3.0, 1.0), (3.0, 0.0),
                                                                  (3.0, -1.0)]),
    ('formation', '{leader: bot8}', [])])
def test_tasks_say_where_a_team_stands(key, parameters, places):
    kind = BY_KEY[key]
    known = {'bot9': Pose(3.0, 2.0, math.pi / 2.0)}
    found = kind.slots(kind.read(parameters), 3, known.get)
    assert np.allclose(np.array(found), np.array(places)) and len(found) == len(places)
