# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth pictures as the obstacle brake takes them: tables, and drives by a simulated camera."""
import math

import numpy as np
import pytest

from mhri.sensors.brake import KEEP_M
from mhri.sensors.depth_beams import DepthBeams, MAX_RANGE_M, MIN_RANGE_M
from mhri.sensors.point_cloud import CloudError, Lens

from support.depth_world import drive_by_depth

LENS = Lens(280.0, 280.0, 159.5, 119.5, 320, 240)
HEIGHT_M = 0.3
RIGHT, DOWN = np.meshgrid((np.arange(320) - 159.5) / 280.0, (np.arange(240) - 119.5) / 280.0)


def mount(x_m=0.0, height_m=HEIGHT_M, pitch=0.0, yaw=0.0):
    """Return the place of a camera that looks ahead, then turned down and to the left [rad]."""
    level = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    nod = np.array([[math.cos(pitch), 0.0, math.sin(pitch)], [0.0, 1.0, 0.0],
                    [-math.sin(pitch), 0.0, math.cos(pitch)]])
    turn = np.array([[math.cos(yaw), -math.sin(yaw), 0.0], [math.sin(yaw), math.cos(yaw), 0.0],
                     [0.0, 0.0, 1.0]])
    matrix = np.eye(4)
    matrix[:3, :3] = turn @ nod @ level
    matrix[:3, 3] = x_m, 0.0, height_m
    return matrix


def picture(place, things=()):
    """Return the depth [m] of an endless floor with upright squares that face the robot.

    :param things: (x, from y, to y, from z, to z) [m] of each, in the robot's frame
    """
    rays = np.stack((RIGHT, DOWN, np.ones_like(RIGHT)), axis=-1) @ place[:3, :3].T
    with np.errstate(divide='ignore', invalid='ignore'):
        depth = np.where(rays[..., 2] < 0.0, -place[2, 3] / rays[..., 2], np.inf)
        for x, right, left, low, high in things:
            there = (x - place[0, 3]) / rays[..., 0]
            y, z = there * rays[..., 1], place[2, 3] + there * rays[..., 2]
            met = (there > 0.0) & (y > right) & (y < left) & (z > low) & (z < high)
            depth = np.where(met & (there < depth), there, depth)
    return np.where(depth < 10.0, depth, np.nan).astype(np.float32)


def met(scan):
    """Return how far away the nearest thing is that a scan meets [m], inf for nothing."""
    points = scan.points()
    return float(np.hypot(*points.T).min()) if len(points) else math.inf


def box(x_m, low=0.0, high=1.0):
    return x_m, -0.1, 0.1, low, high


@pytest.mark.parametrize('place', [mount(), mount(0.1), mount(-0.09, 0.25), mount(pitch=0.15)])
@pytest.mark.parametrize('things, found', [
    ([], math.inf), ([box(1.0)], 1.0), ([box(1.0), box(2.0)], 1.0), ([box(1.5, 0.0, 0.2)], 1.5),
    ([box(1.0, 0.0, 0.03)], math.inf), ([box(1.0, 0.7, 1.0)], math.inf), ([box(3.0)], 3.0)])
def test_the_nearest_thing_that_is_neither_floor_nor_above(place, things, found):
    scan = DepthBeams().scan(picture(place, things), LENS, place)
    assert met(scan) == pytest.approx(found, abs=0.02)
    assert scan.faces(np.array([[1.0, 0.0], [1.0, 0.4], [-1.0, 0.0], [0.0, 1.0]])).tolist() == [
        True, True, False, False]


def test_a_thing_lies_where_it_is_seen():
    place = mount(0.1, yaw=0.4)
    scan = DepthBeams().scan(picture(place, [(1.2, 0.35, 0.65, 0.0, 1.0)]), LENS, place)
    points = scan.points()
    assert points[:, 0] == pytest.approx(1.2, abs=0.02)
    assert (points[:, 1].min(), points[:, 1].max()) == pytest.approx((0.35, 0.65), abs=0.03)


def test_a_camera_that_is_lower_than_it_is_said_to_be_sees_the_floor_and_not_less():
    place, said = mount(height_m=0.2), mount(height_m=0.35)
    assert met(DepthBeams().scan(picture(place), LENS, said)) < 2.0


def test_of_an_unknown_height_only_what_is_as_high_as_the_camera_counts():
    place = mount()
    for thing, found in ((box(1.0), 1.0), (box(1.0, 0.0, 0.2), math.inf)):
        assert met(DepthBeams().scan(picture(place, [thing]), LENS, mount(height_m=0.0),
                                     False)) == pytest.approx(found, abs=0.02)


@pytest.mark.parametrize('nothing', [np.nan, 0.0, np.inf])
def test_a_picture_that_measured_nothing_is_no_scan(nothing):
    with pytest.raises(CloudError, match='measured nothing in 100 %'):
        DepthBeams().scan(np.full((240, 320), nothing, np.float32), LENS, mount())


def test_where_nothing_was_measured_nothing_was_looked_at():
    depth = picture(mount())
    depth[:, 160:] = np.nan
    scan = DepthBeams().scan(depth, LENS, mount())
    assert scan.faces(np.array([[1.0, 0.3], [1.0, -0.3]])).tolist() == [True, False]


def test_what_goes_out_of_the_picture_below_is_not_seen_to_be_gone():
    scan = DepthBeams().scan(picture(mount()), LENS, mount())
    # The floor begins at 0.3 m / (119.5 / 280).
    assert scan.looks_at(np.array([[0.6, 0.0], [1.0, 0.0]])).tolist() == [False, True]
    up = DepthBeams().scan(picture(mount(pitch=-0.5), [(2.0, -3, 3, 0, 3)]), LENS,
                           mount(pitch=-0.5))
    assert up.range_min_m == KEEP_M and up.range_max_m == MAX_RANGE_M
    assert MIN_RANGE_M < scan.range_min_m < 0.9


@pytest.mark.parametrize('lens, place', [
    (LENS._replace(fx=0.0), mount()), (LENS._replace(cx=math.nan), mount()),
    (LENS, mount(pitch=1.2))])
def test_an_impossible_camera_is_refused(lens, place):
    with pytest.raises(CloudError):
        DepthBeams().scan(picture(mount()), lens, place)


def test_another_size_of_the_picture_sees_the_same():
    small = picture(mount(), [box(1.0)])[::4, ::4]
    scan = DepthBeams().scan(small, LENS, mount())
    assert met(scan) == pytest.approx(1.0, abs=0.03)
    assert not scan.blind_m.any()


@pytest.mark.parametrize('seed', range(3))
def test_drives_by_a_depth_camera_end_without_contact(seed):
    assert drive_by_depth(seed, 12.0, True).contacts == 0


def test_the_same_drives_without_the_brake_meet_something():
    assert any(drive_by_depth(seed, 12.0, False).contacts for seed in range(3))
