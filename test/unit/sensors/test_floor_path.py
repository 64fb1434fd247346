# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lines on the floor of a picture: a metre is where a pinhole sees it."""
import math

import numpy as np
import pytest

from mhri.base.geometry import Pose
from mhri.sensors.floor import floor_path, FloorCamera, FloorPath, level_camera
from mhri.sensors.point_cloud import Lens

# 640 x 480 pixels, 90 degrees wide.
LENS = Lens(320.0, 320.0, 319.5, 239.5, 640, 480)
CAMERA = level_camera(0.0, 0.4, LENS)
STRAIGHT = tuple(Pose(0.1 * step, 0.0, 0.0) for step in range(5))


def tilted(down_rad):
    """Return the camera tilted towards the floor."""
    cos, sin = math.cos(down_rad), math.sin(down_rad)
    tilt = np.array([[cos, 0.0, sin, 0.0], [0.0, 1.0, 0.0, 0.0], [-sin, 0.0, cos, 0.0],
                     [0.0, 0.0, 0.0, 1.0]])
    matrix = tilt @ level_camera(0.0, 0.0, LENS).matrix
    matrix[2, 3] = 0.4
    return FloorCamera(matrix, LENS)


@pytest.mark.parametrize('camera, point, expected', [
    (CAMERA, (1.0, 0.0), (0.5, 0.5 + 0.4 * 320.0 / 480.0)),
    (CAMERA, (2.0, 0.0), (0.5, 0.5 + 0.2 * 320.0 / 480.0)),
    (CAMERA, (2.0, 1.0), (0.25, 0.5 + 0.2 * 320.0 / 480.0)),
    (CAMERA, (2.0, -2.0), (1.0, 0.5 + 0.2 * 320.0 / 480.0)),
    (level_camera(-0.5, 0.4, LENS), (0.5, 0.0), (0.5, 0.5 + 0.4 * 320.0 / 480.0)),
    (tilted(math.atan2(0.4, 1.0)), (1.0, 0.0), (0.5, 0.5)),
    (CAMERA, (1e6, 0.0), (0.5, 0.5)),
    (CAMERA, (0.05, 0.0), (math.nan, math.nan)),
    (CAMERA, (-1.0, 0.0), (math.nan, math.nan))])
def test_a_point_of_the_floor_in_the_picture(camera, point, expected):
    assert camera.project(np.array([point]))[0] == pytest.approx(expected, abs=1e-5, nan_ok=True)


def test_what_is_straight_ahead_is_symmetric_and_as_wide_as_the_robot():
    path = floor_path(STRAIGHT, 0.2, CAMERA)
    left, right = path.onward
    assert left[:, 0] == pytest.approx(1.0 - right[:, 0]) and (left[:, 0] < 0.5).all()
    # 1 m ahead of the camera: 0.4 m apart, 0.4 m below the middle.
    row = 0.5 + 0.4 * 320.0 / 480.0
    at_1_m = [np.interp(-row, -line[:, 1], line[:, 0]) for line in (left, right)]
    assert np.diff(at_1_m)[0] == pytest.approx(0.4 * 320.0 / 640.0, abs=1e-3)
    assert path.visible and len(path.bar) == 1


@pytest.mark.parametrize('path, camera', [
    ((), CAMERA), ((Pose(0.0, 0.0, 0.0), Pose(-0.2, 0.0, 0.0)), CAMERA),
    (STRAIGHT, level_camera(0.0, 0.0, LENS)), (STRAIGHT, level_camera(0.0, math.nan, LENS)),
    (STRAIGHT, level_camera(0.0, 0.4, LENS._replace(fx=0.0))),
    (STRAIGHT, level_camera(0.0, 0.4, LENS._replace(width=0))),
    (STRAIGHT, level_camera(0.0, 0.4, LENS._replace(cx=math.inf)))])
def test_there_is_nothing_to_draw(path, camera):
    drawn = floor_path(path, 0.2, camera)
    assert isinstance(drawn, FloorPath) and not drawn.visible
    assert drawn.committed == drawn.bar == drawn.onward == ()


def test_a_turn_leads_out_of_the_picture():
    turned = (Pose(0.0, 0.0, 0.0), Pose(0.0, 0.0, 0.5))
    left = floor_path(turned, 0.2, CAMERA).onward[0]
    assert left[-1, 0] < left[0, 0] < 0.5 or left[-1, 0] < 0.3
    assert not floor_path((Pose(0.0, 0.0, 0.0), Pose(0.0, 0.0, 3.0)), 0.2, CAMERA).visible
