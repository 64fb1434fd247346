# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map in the place that the cameras of a film leave empty."""
from types import SimpleNamespace

import numpy as np
import pytest

from mhri.base.geometry import Pose
from mhri.base.robot_colours import colour_of
from mhri.map.grid import Grid
from mhri.robots.link import Motion
from mhri.session.film import Camera, frame_of, frame_size, map_size, Tile
from mhri.session.film_map import FilmMap
from mhri.session.report import RobotRow
from mhri.session.survey import RobotSurvey

# 8 m by 6 m, with a wall at its lower edge.
CELLS = np.zeros((60, 80), np.int8)
CELLS[:3] = 100
GRID = Grid(0.1, Pose(0.0, 0.0, 0.0), CELLS)
SIZE = (640, 452)


def row(name, number, origin=Pose(0.0, 0.0, 0.0)):
    """Return the row of a robot that drove from x = 1 m to 7 m."""
    survey = RobotSurvey()
    survey.on_place(origin)
    for step in range(61):
        survey.on_motion(0.1 * step, Motion(1.0, 0.0, 1.0 + 0.1 * step, float(number)))
    return RobotRow(name, number, '', colour_of(number, dark=False), survey, 0.0)


def film_map(*rows, grid=GRID):
    placed = tuple(each.name for each in rows if each.survey.placed)
    return FilmMap(SimpleNamespace(robots=rows, placed=placed), grid, SIZE)


def bgr(number):
    colour = colour_of(number, dark=False)
    return [int(colour[place:place + 2], 16) for place in (5, 3, 1)]


def inked(picture, number, x_m, y_m):
    """Return whether a robot's colour is near a place of the map."""
    scale = picture.shape[1] / 8.0
    across, down = round(x_m * scale), picture.shape[0] - round(y_m * scale)
    part = picture[max(0, down - 12):down + 12, max(0, across - 12):across + 12].astype(int)
    return bool((np.abs(part - bgr(number)).max(axis=2) < 12).any())


def test_the_paths_grow_with_the_film():
    shown = film_map(row('bot1', 1), row('bot2', 2))
    first = shown.at(0.0, {'bot1': (Pose(1.0, 1.0, 0.0), False)})
    assert first.shape[1] <= SIZE[0] and first.shape[0] <= SIZE[1]
    assert inked(first, 1, 1.0, 1.0) and not inked(first, 2, 1.0, 2.0)
    for step in range(1, 21):
        last = shown.at(0.1 * step, {
            'bot1': (Pose(1.0 + 0.2 * step, 1.0, 0.0), False),
            'bot2': (Pose(1.0, 2.0, 0.0), False)})
    assert inked(last, 1, 2.0, 1.0) and inked(last, 1, 5.0, 1.0) and not inked(last, 1, 6.0, 1.0)
    assert inked(last, 2, 1.0, 2.0)


def test_a_jump_is_no_path_and_a_lost_robot_is_pale():
    shown = film_map(row('bot1', 1))
    shown.at(0.0, {'bot1': (Pose(1.0, 3.0, 0.0), False)})
    jumped = shown.at(0.1, {'bot1': (Pose(6.0, 3.0, 0.0), False)})
    assert inked(jumped, 1, 6.0, 3.0) and not inked(jumped, 1, 3.0, 3.0)
    assert not inked(shown.at(0.2, {'bot1': (Pose(6.0, 3.0, 0.0), True)}), 1, 6.0, 3.0)


@pytest.mark.parametrize('grid', [GRID, None])
def test_only_placed_robots_are_on_a_map_where_any_is(grid):
    shown = film_map(row('bot1', 1), row('bot2', 2, origin=None), grid=grid)
    assert shown.names == ('bot1',) and shown.placed
    loose = film_map(row('bot2', 2, origin=None), grid=grid)
    assert loose.names == ('bot2',) and not loose.placed


def test_it_is_in_the_empty_place_of_a_frame():
    assert [count for count in range(1, 17) if map_size(count)] == [3, 5, 7, 8, 10, 11, 13, 14, 15]
    tiles = [Tile(Camera('bot1', 1, '/bot1/camera'), np.full((30, 40, 3), 200, np.uint8))] * 3
    frame = frame_of(tiles, '', False, np.full((452, 640, 3), 255, np.uint8))
    wide, high = frame_size(3)
    assert frame.shape == (high, wide, 3)
    assert frame[high - 200, wide - 300].tolist() == [255] * 3
    assert frame[high - 200, 300].tolist() == [200] * 3
