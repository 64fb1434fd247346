# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the simulated camera sees, against distances and rows of pixels worked out by hand."""
import math
from pathlib import Path
import random

import numpy as np
import pytest

from mhri.sim.camera import (Camera, CAMERA_HEIGHT_M, CENTRE_X_PX, CENTRE_Y_PX, FOCAL_PX, HEIGHT,
                             WIDTH)
from mhri.sim.plan import Landmark, parse_plan, Plan
from mhri.sim.sensors import Laser

OTHER = np.dtype([('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                  ('colour', 'u1', 3)])
NOBODY = np.zeros(0, OTHER)
# A room 4 m x 2 m, its lower left corner in the origin.
ROOM = ((0, 0, 4, 0), (4, 0, 4, 2), (4, 2, 0, 2), (0, 2, 0, 0))
RED = (204, 40, 40)
TOP, MIDDLE, BOTTOM = 0, HEIGHT // 2, HEIGHT - 1
LEFT, RIGHT = 0, WIDTH - 1


def plan(walls=ROOM, landmarks=(), wall_height_m=2.4):
    return Plan('test', np.array(walls, float).reshape(-1, 4), wall_height_m, (220, 220, 210),
                (150, 140, 126), tuple(landmarks), ((0.0, 0.0, 0.0),))


def red(x, y, radius=0.2, height=1.2):
    return Landmark('red', RED, x, y, radius, height)


def robot(x, y, radius=0.2, height=0.42, colour=(60, 60, 64)):
    return np.array([(x, y, radius, height, colour)], OTHER)


def depth(x, y, yaw, others=NOBODY, **kind):
    camera = Camera(plan(**kind))
    picture = camera.depth(camera.look(x, y, yaw, others))
    assert picture.shape == (HEIGHT, WIDTH) and picture.dtype == np.uint16
    return picture


def rgb(x, y, yaw, others=NOBODY, **kind):
    camera = Camera(plan(**kind))
    picture = camera.rgb(camera.look(x, y, yaw, others))
    assert picture.shape == (HEIGHT, WIDTH, 3) and picture.dtype == np.uint8
    return picture


def mm(metres):
    return int(round(metres * 1000.0))


def is_red(pixels):
    pixels = pixels.astype(int)
    return (pixels[..., 0] > 2 * pixels[..., 1]) & (pixels[..., 0] > 2 * pixels[..., 2])


def down(row):
    """How far a ray falls [m] on 1 m ahead."""
    return (row - CENTRE_Y_PX) / FOCAL_PX


@pytest.mark.parametrize('yaw, wanted', [(0.0, 3.0), (90.0, 1.5), (180.0, 1.0), (-90.0, 0.5)])
def test_wall_ahead_is_one_depth_from_edge_to_edge(yaw, wanted):
    """The z-depth, not the length of the ray, which is 15 % more at the edges."""
    picture = depth(1.0, 0.5, math.radians(yaw))
    half = 0.5 if yaw in (0.0, 180.0) else 1.0
    columns = np.abs((np.arange(WIDTH) - CENTRE_X_PX) / FOCAL_PX) * wanted < half
    assert set(picture[MIDDLE][columns]) == {mm(wanted)}


def test_walls_beside_at_the_edges():
    picture = depth(1.0, 0.5, 0.0)
    sideways = CENTRE_X_PX / FOCAL_PX
    assert picture[MIDDLE, LEFT] == mm(1.5 / sideways)
    assert picture[MIDDLE, RIGHT] == mm(0.5 / sideways)


def test_centre_agrees_with_the_laser_in_the_lab():
    path = Path(__file__).resolve().parents[2] / 'resource' / 'sim' / 'plan.yaml'
    lab = parse_plan(path.read_text(), str(path))
    camera, chance = Camera(lab), random.Random(3)
    laser = Laser(lab.walls, 0.1, 100.0, None, rays=1)
    compared = 0
    while compared < 200:
        x, y = chance.uniform(0.0, 12.0), chance.uniform(0.0, 9.0)
        if lab.distance(x, y) < 0.15:
            continue
        heading, column = chance.uniform(-math.pi, math.pi), chance.randrange(WIDTH)
        aside = math.atan((column - CENTRE_X_PX) / FOCAL_PX)
        metres = laser.distances(x, y, heading - aside, lab.discs())[0] * math.cos(aside)
        picture = camera.depth(camera.look(x, y, heading, NOBODY))
        assert abs(int(picture[MIDDLE, column]) - (mm(metres) if metres < 10.0 else 0)) <= 1
        compared += 1


@pytest.mark.parametrize('row', [BOTTOM, 400, 300])
def test_floor(row):
    assert set(depth(0.1, 1.0, 0.0, walls=[(9, -9, 9, 9)])[row]) == {
        mm(CAMERA_HEIGHT_M / down(row))}


@pytest.mark.parametrize('row', [TOP, 50, 80])
def test_ceiling(row):
    assert set(depth(0.1, 1.0, 0.0, walls=[(9.9, -9, 9.9, 9)])[row]) == {
        mm((2.4 - CAMERA_HEIGHT_M) / -down(row))}


@pytest.mark.parametrize('distance, wanted', [(9.999, 9999), (10.0, 10000), (10.002, 0), (30.0, 0),
                                              (1000.0, 0)])
def test_nothing_beyond_range(distance, wanted):
    walls = [(distance, -2000, distance, 2000)]
    assert set(depth(0.0, 0.0, 0.0, walls=walls)[MIDDLE]) == {wanted}


def test_no_wall_ahead():
    assert not depth(0.0, 0.0, 0.0, walls=[(-1, -1, -1, 1)])[MIDDLE].any()
    assert rgb(0.0, 0.0, 0.0, walls=[(-1, -1, -1, 1)]).any()
    assert rgb(0.0, 0.0, 0.0, walls=[(0.02, -9, 0.02, 9)]).any()


@pytest.mark.parametrize('turned', [0.0, 0.7])
def test_no_ray_leaves_a_closed_room_by_its_corners(turned):
    cos, sin = math.cos(turned), math.sin(turned)
    turn = np.array([[cos, sin], [-sin, cos]])
    room = np.array(ROOM, float)
    walls = np.hstack([room[:, :2] @ turn, room[:, 2:] @ turn])
    camera, chance = Camera(plan(walls)), random.Random(1)
    for _ in range(200):
        x, y = np.array([chance.uniform(0.1, 3.9), chance.uniform(0.1, 1.9)]) @ turn
        # Exactly into the corner with some column of the picture.
        for corner_x, corner_y in walls[:, :2]:
            aside = math.atan((chance.randrange(WIDTH) - CENTRE_X_PX) / FOCAL_PX)
            yaw = math.atan2(corner_y - y, corner_x - x) + aside
            assert np.isfinite(camera.look(x, y, yaw, NOBODY).wall_m).all()


@pytest.mark.parametrize('height', [1.2, 0.42, 0.3])
def test_cylinder_from_its_foot_to_its_top(height):
    picture = depth(1.0, 1.0, 0.0, landmarks=[red(3.0, 1.0, 0.2, height)])
    column = picture[:, WIDTH // 2]
    near = (3.0 - 1.0 - 0.2)
    foot = CENTRE_Y_PX + FOCAL_PX * CAMERA_HEIGHT_M / near
    head = CENTRE_Y_PX - FOCAL_PX * (height - CAMERA_HEIGHT_M) / near
    on = np.flatnonzero(column == mm(near))
    assert (on[0], on[-1]) == (max(0, math.ceil(head)), math.floor(foot))
    assert len(on) == on[-1] - on[0] + 1
    if head > 0:
        assert column[on[0] - 1] == mm(3.0)


@pytest.mark.parametrize('radius', [0.2, 0.5])
def test_over_a_low_cylinder_its_top_and_then_the_wall(radius):
    height = 0.2
    picture = depth(0.5, 1.0, 0.0, robot(2.0, 1.0, radius, height))
    column = picture[:, WIDTH // 2]
    near, far = 1.5 - radius, 1.5 + radius
    drop = CAMERA_HEIGHT_M - height
    edge, back = (CENTRE_Y_PX + FOCAL_PX * drop / metres for metres in (near, far))
    for row in range(math.ceil(back), math.floor(edge) + 1):
        assert abs(int(column[row]) - mm(drop / down(row))) <= 1, row
    assert column[math.floor(edge) + 1] == mm(near)
    assert column[math.ceil(back) - 1] == mm(3.5)


def test_edge_of_a_cylinder():
    """The outermost columns that meet it are those of its tangents."""
    radius, ahead = 0.2, 2.0
    picture = depth(1.0, 1.0, 0.0, landmarks=[red(1.0 + ahead, 1.0, radius)],
                    walls=[(9, -9, 9, 9)])
    tangent = math.tan(math.asin(radius / ahead)) * FOCAL_PX
    on = np.flatnonzero(picture[MIDDLE] < mm(2.9))
    assert on[0] == math.ceil(CENTRE_X_PX - tangent)
    assert on[-1] == math.floor(CENTRE_X_PX + tangent)


@pytest.mark.parametrize('others, column, wanted', [
    (robot(2.0, 1.0), WIDTH // 2, 0.8), (robot(3.5, 1.0), WIDTH // 2, 1.8),
    (robot(0.2, 1.0), WIDTH // 2, 1.8), (robot(1.1, 1.0), WIDTH // 2, 1.8),
    (robot(5.0, 1.0), WIDTH // 2, 1.8), (robot(1e9, 1e9), WIDTH // 2, 1.8)],
    ids=['before', 'behind it', 'behind me', 'around me', 'behind a wall', 'nowhere'])
def test_other_robots(others, column, wanted):
    picture = depth(1.0, 1.0, 0.0, others, landmarks=[red(3.0, 1.0)])
    assert picture[MIDDLE, column] == mm(wanted)


def test_red_landmark_ahead_is_red():
    picture = rgb(1.0, 1.0, 0.0, landmarks=[red(3.0, 1.0)])
    middle = is_red(picture[MIDDLE - 60:MIDDLE + 61, WIDTH // 2 - 40:WIDTH // 2 + 41])
    assert middle.all()
    assert not is_red(picture[:, :200]).any() and not is_red(picture[:, -200:]).any()


@pytest.mark.parametrize('place, share', [(2.0, 0.0), (3.6, 1.0)], ids=['before', 'behind'])
def test_robot_hides_what_is_behind_it(place, share):
    """It is lower than the landmark, whose upper part is seen above it."""
    picture = rgb(1.0, 1.0, 0.0, robot(place, 1.0, 0.22), landmarks=[red(3.0, 1.0)])
    found = is_red(picture)[:, WIDTH // 2]
    assert found[MIDDLE - 20:MIDDLE + 60].mean() == share
    assert found[MIDDLE - 120:MIDDLE - 90].all()


@pytest.mark.parametrize('others', [NOBODY, robot(1.8, 0.8, 0.2, 0.2, (200, 30, 30)),
                                    robot(1.2, 1.3, 0.2, 0.5, (200, 30, 30))],
                         ids=['nobody', 'low', 'high'])
def test_colours_are_where_the_depth_is(others):
    landmarks = [red(3.0, 1.0), red(2.2, 1.5, 0.1, 0.2)]
    colours = rgb(0.6, 1.0, 0.1, others, landmarks=landmarks).astype(int)
    nearer = depth(0.6, 1.0, 0.1, others, landmarks=landmarks) != depth(0.6, 1.0, 0.1)
    wrong = (colours[..., 0] > colours[..., 1] + 40) != nearer
    print('{} of {} pixels differ'.format(wrong.sum(), nearer.sum()))
    assert wrong.mean() < 0.002


def test_texture_moves_with_the_walls():
    """Half a block on along the wall the picture is another, a whole period on the same."""
    walls = [(-100, 2, 100, 2)]
    first, half, whole = (rgb(x, 0.0, math.pi / 2, walls=walls).astype(int)
                          for x in (1.2, 1.4, 3.6))
    assert np.abs(first - half).mean() > 2.0
    assert np.abs(first - whole).mean() < 0.5


def test_same_view_same_picture_whatever_was_seen_before():
    camera = Camera(plan(landmarks=[red(3.0, 1.0)]))
    places = [(1.0, 1.0, 0.3, robot(2.0, 1.2)), (2.0, 0.5, 2.0, NOBODY)]
    views = [camera.look(*place) for place in places]
    first = [(camera.rgb(view), camera.depth(view)) for view in views]
    for view, (colours, metres) in zip(views, first):
        assert (camera.rgb(view) == colours).all() and (camera.depth(view) == metres).all()


@pytest.mark.parametrize('wall_height', [0.1, 0.3, 2.4, 100.0])
def test_walls_of_any_height(wall_height):
    """The camera never looks over the walls: what is behind them is not seen."""
    camera = Camera(plan(wall_height_m=wall_height))
    view = camera.look(1.0, 1.0, 0.0, NOBODY)
    assert camera.height_m < wall_height
    assert camera.rgb(view).any()
    assert camera.depth(view)[MIDDLE, WIDTH // 2] == 3000
