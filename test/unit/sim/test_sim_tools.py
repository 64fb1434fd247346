# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The moving parts of a simulated robot, its gas, and what the camera sees with its head turned."""
import math
from pathlib import Path

import numpy as np
import pytest

from mhri.base.config import parse_yaml
from mhri.base.accessories import read_accessories
from mhri.sim.camera import Camera
from mhri.sim.lens import CENTRE_Y_PX, FOCAL_PX, HEIGHT
from mhri.sim.plan import parse_plan
from mhri.sim.tools import Actuator, CLEAN_PPM, DIM, gas_ppm, MAX_TILT_RAD, rows_of_tilt

SIM = Path(__file__).resolve().parents[3] / 'resource' / 'sim'
NOBODY = np.zeros(0, [('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                      ('colour', 'u1', 3)])
MAX_SHIFT = rows_of_tilt(MAX_TILT_RAD)


@pytest.fixture(scope='module')
def lab():
    return parse_plan((SIM / 'plan.yaml').read_text(), 'plan.yaml')


def test_the_rows_are_good():
    text = 'accessories:\n' + ''.join(
        '  ' + line + '\n' for line in (SIM / 'accessories.yaml').read_text().splitlines())
    rows = read_accessories(parse_yaml(text, 'accessories.yaml'))
    assert [row.key for row in rows] == ['lamp', 'head', 'gripper', 'gas']


@pytest.mark.parametrize('target, seconds, place, there', [
    ((1.0, 0.1), 0.5, (0.75, 0.1), False), ((1.0, 0.1), 1.0, (1.0, 0.1), True),
    ((-9.0, 9.0), 9.0, (-1.5, 0.3), True), ((0.0, 0.0), 1.0, (0.0, 0.0), True)])
def test_a_part_goes_to_its_target_at_its_speed(target, seconds, place, there):
    head = Actuator(1.5, ((-1.5, 1.5), (-0.3, 0.3)))
    head.go(target)
    for _ in range(round(seconds / 0.01)):
        head.step(0.01)
    assert head.place == pytest.approx(place) and head.there == there
    head.halt()
    assert head.there and not head.step(0.01)


@pytest.mark.parametrize('target', [(), (1.0,), (1.0, math.nan), (math.inf, 0.0)])
def test_a_target_that_cannot_be_is_refused(target):
    head = Actuator(1.5, ((-1.5, 1.5), (-0.3, 0.3)))
    with pytest.raises(ValueError):
        head.go(target)
    assert head.there


def test_gas_rises_at_the_leak(lab):
    x, y = lab.gas
    assert lab.distance(x, y) > 0.5, 'a robot gets there'
    readings = [gas_ppm(lab.gas, x - away, y) for away in (0.0, 1.0, 2.0, 5.0)]
    assert readings == sorted(readings, reverse=True) and readings[0] > 400.0
    assert readings[-1] < 50.0 and gas_ppm((), x, y) == CLEAN_PPM
    assert all(gas_ppm(lab.gas, *start[:2]) < 50.0 for start in lab.starts), 'no warning at first'


@pytest.mark.parametrize('tilt', [MAX_TILT_RAD, 0.1, -0.2, -MAX_TILT_RAD])
def test_a_tilt_shows_the_same_building_higher_or_lower(lab, tilt):
    """Row by row that of the level camera, where both see it."""
    camera, shift = Camera(lab, MAX_SHIFT), rows_of_tilt(tilt)
    assert math.atan2(shift, FOCAL_PX) == pytest.approx(tilt, abs=0.001)
    others = np.array([(7.5, 1.2, 0.2, 0.42, (60, 60, 64))], NOBODY.dtype)
    level, tilted = (camera.look(6.0, 1.0, 0.2, others, rows) for rows in (0, shift))
    own, other = slice(max(0, shift), HEIGHT + min(0, shift)), slice(
        max(0, -shift), HEIGHT - max(0, shift))
    for draw in (camera.depth, camera.rgb):
        whole, moved = draw(level), draw(tilted)
        assert moved.shape == whole.shape
        assert np.array_equal(moved[own], whole[other])
    # What the level one does not see: the floor nearer to the robot, and the ceiling.
    row = HEIGHT - 1 if shift < 0 else 0
    down = (row - CENTRE_Y_PX - shift) / FOCAL_PX
    metres = camera.height_m / down if down > 0.0 else (lab.wall_height_m - camera.height_m) / -down
    assert camera.depth(tilted)[row, 320] == pytest.approx(1000.0 * metres, abs=1.0)


def test_without_a_tilt_the_picture_is_that_of_a_camera_without_a_head(lab):
    plain, tilts = Camera(lab), Camera(lab, MAX_SHIFT)
    for pose in ((6.0, 1.0, 0.0), (2.0, 7.0, 2.0)):
        views = plain.look(*pose, NOBODY), tilts.look(*pose, NOBODY)
        assert np.array_equal(plain.rgb(views[0]), tilts.rgb(views[1]))
        assert np.array_equal(plain.depth(views[0]), tilts.depth(views[1]))


def test_without_the_lamp_it_is_a_little_darker(lab):
    camera = Camera(lab)
    view = camera.look(6.0, 1.0, 0.0, NOBODY)
    bright, dark = camera.rgb(view).astype(float), camera.rgb(view, DIM)
    assert np.abs(dark - DIM * bright).max() <= 0.5
