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


def test_centre_agrees_with_the_laser_in_the_lab():
    path = Path(__file__).resolve().parents[3] / 'resource' / 'sim' / 'plan.yaml'
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


@pytest.mark.parametrize('others, column, wanted', [
    (robot(2.0, 1.0), WIDTH // 2, 0.8), (robot(3.5, 1.0), WIDTH // 2, 1.8),
    (robot(0.2, 1.0), WIDTH // 2, 1.8), (robot(1.1, 1.0), WIDTH // 2, 1.8),
    (robot(5.0, 1.0), WIDTH // 2, 1.8), (robot(1e9, 1e9), WIDTH // 2, 1.8)],
    ids=['before', 'behind it', 'behind me', 'around me', 'behind a wall', 'nowhere'])
def test_other_robots(others, column, wanted):
    picture = depth(1.0, 1.0, 0.0, others, landmarks=[red(3.0, 1.0)])
    assert picture[MIDDLE, column] == mm(wanted)
