# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the free floor of a map ends, and that no task drives over it."""
import math

import numpy as np
import pytest

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.map.floor import Floor
from mhri.map.grid import FREE, grid_of, OCCUPIED, UNKNOWN
from mhri.tasks.base import BLOCKED, DONE, ENDS, Step, Task
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import RobotRun

from support.task_world import World


def floor_of(cells, resolution_m=0.5, origin=Pose(0.0, 0.0, 0.0)):
    """Return the floor of rows of cells, the upper one first."""
    rows = np.array(cells, dtype=np.int8)[::-1]
    return Floor(grid_of(resolution_m, origin, rows.shape[1], rows.shape[0],
                         rows.reshape(-1)))


WALLED = [[FREE, FREE, FREE, OCCUPIED],
          [FREE, FREE, FREE, OCCUPIED],
          [FREE, FREE, FREE, UNKNOWN]]


@pytest.mark.parametrize('pose, seen', [
    # At (0.75, 0.75) the wall is 0.75 m off, wherever the robot looks.
    (Pose(0.75, 0.75, 0.0), (0.75, 0.0)), (Pose(0.75, 0.75, 0.5 * math.pi), (0.0, -0.75)),
    (Pose(0.75, 0.75, math.pi), (-0.75, 0.0)), (Pose(1.25, 0.25, 0.0), (0.25, 0.0))])
def test_an_edge_is_where_free_cells_end(pose, seen):
    points = floor_of(WALLED).edge(pose, 2.0)
    gaps = np.hypot(*(points - seen).T)
    assert gaps.min() < 0.06
    assert len(points) >= 15
    # No robot fits through, and nothing else is met: beyond the map's sides nothing is known.
    assert np.hypot(*points.T).min() == pytest.approx(math.hypot(*seen), abs=0.01)


@pytest.mark.parametrize('x, y', [(1.75, 1.25), (1.75, 0.25), (9.0, 0.0), (-5.0, -5.0)])
def test_where_the_map_has_no_free_floor_nothing_is_said(x, y):
    assert not len(floor_of(WALLED).edge(Pose(x, y, 0.0), 1.0))


class Ahead(Task):
    """Wants straight on for ever."""

    def step(self, senses):
        return Step(Velocity(0.4, 0.0), text='straight on')


@pytest.mark.parametrize('laser', [True, False])
def test_a_task_stops_before_what_no_laser_sees(laser):
    cells = np.full((40, 80), FREE, np.int8)
    cells[:, 60:] = UNKNOWN
    world = World(floor=Floor(grid_of(0.05, Pose(-1.0, -1.0, 0.0), 80, 40, cells.reshape(-1))))
    robot = world.add('bot1')
    robot.run = RobotRun('bot1', Ahead(), robot.task_body, 0.0, world.now_s)
    while robot.run.state not in ENDS and world.now_s < 60.0:
        world.step(has_laser=laser)
    assert robot.run.state == BLOCKED and 'free floor' in robot.run.text
    gap_m = 2.0 - robot.body.x - robot.task_body.radius_m
    assert 0.0 < gap_m < 0.25


def test_a_goal_behind_a_mapped_thing_is_reached_around_it():
    cells = np.full((120, 120), FREE, np.int8)
    cells[52:68, 70:80] = OCCUPIED
    world = World(floor=Floor(grid_of(0.05, Pose(-3.0, -3.0, 0.0), 120, 120, cells.reshape(-1))))
    robot = world.add('bot1', x=-1.0)
    robot.begin(BY_KEY['goto'], '{x: 2.0, y: 0.0}', world.now_s)
    nearest_m = math.inf
    while robot.run.state not in ENDS and world.now_s < 90.0:
        world.step()
        nearest_m = min(nearest_m, max(abs(robot.body.x - 0.75) - 0.25,
                                       abs(robot.body.y) - 0.4))
    assert robot.run.state == DONE, robot.run.text
    assert nearest_m > robot.task_body.radius_m
