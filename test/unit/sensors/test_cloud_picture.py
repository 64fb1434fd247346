# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Known clouds and the pixels that they have to be."""
from dataclasses import replace
import math

import numpy as np
import pytest

from mhri.sensors.cloud_picture import (
    CloudArtist, COLOUR, DISTANCE, GROUND, HEIGHT, INTENSITY, TABLE)
from mhri.sensors.orbit import fitted, focal_px, Orbit, projected, read_orbit
from mhri.sensors.point_cloud import Cloud
from support.clouds import room

SIZE = (200, 100)
RED, GREEN, BLUE = 0xffff0000, 0xff00ff00, 0xff0000ff
# So high that neither floor nor robot is in the picture, with a point of the floor behind.
LEVEL = Orbit((10.0, 0.0, 50.0), 0.0, 0.0, 5.0)
FLOOR = (-20.0, 0.0, -50.0)


def cloud_of(places, colours=None, **more):
    points = np.array(places, 'f4').reshape(-1, 3)
    return Cloud(points, None if colours is None else np.array(colours, 'u4'), sent=len(points),
                 **more)


def on_floor(cloud):
    """Return a cloud with a point of the floor."""
    points = np.vstack((cloud.points, np.array([FLOOR], 'f4')))
    colours = None if cloud.colours is None else np.append(cloud.colours, np.uint32(BLUE))
    return replace(cloud, points=points, colours=colours)


def drawn(cloud, orbit=LEVEL, colouring=COLOUR, size=SIZE):
    return CloudArtist().draw(cloud, orbit, size, colouring).pixels


def where(pixels, colour):
    """Return (first column, first row, width, height) of a colour; None where it is not."""
    rows, columns = np.nonzero(pixels == colour)
    if not len(rows):
        return None
    return (columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1)


def middle(box):
    return box[0] + box[2] / 2.0, box[1] + box[3] / 2.0


# In a picture 100 px high and 5 m away, 1 m is so many pixels.
METRE = focal_px(100) / 5.0


@pytest.mark.parametrize('place, across, down', [
    ((10, 0, 50), 0, 0), ((10, 1, 50), -METRE, 0), ((10, -1, 50), METRE, 0),
    ((10, 0, 51), 0, -METRE), ((10, 0, 49), 0, METRE), ((15, 2, 50), -METRE, 0)])
def test_a_point_is_where_it_has_to_be(place, across, down):
    found = middle(where(drawn(cloud_of([place], [RED])), RED))
    assert found == pytest.approx((100 + across, 50 + down), abs=1.5)


@pytest.mark.parametrize('order', [1, -1])
def test_what_is_near_covers_what_is_far(order):
    places = [(10, 0, 50), (9.9, 0, 50), (11, 0, 50)][::order]
    pixels = drawn(cloud_of(places, [GREEN, RED, BLUE][::order]))
    assert where(pixels, RED) and not where(pixels, GREEN) and not where(pixels, BLUE)


def test_a_far_wall_does_not_show_through_a_near_dense_one():
    y, z = (side.ravel() for side in np.meshgrid(np.linspace(-2, 2, 300), np.linspace(48, 52, 300)))
    near = np.column_stack((np.full(y.size, 9.0), y, z))
    far = near + (2.0, 0.0, 0.0)
    pixels = drawn(cloud_of(np.vstack((near, far)), [RED] * y.size + [BLUE] * y.size))
    x0, y0, width, height = where(pixels, RED)
    assert (pixels[y0:y0 + height, x0:x0 + width] == RED).all() and not where(pixels, BLUE)


@pytest.mark.parametrize('place', [(4.9, 0, 50), (5.3, 0, 50), (10, 99, 50), (10, 0, 99),
                                   (-9999, 9999, -9999), (5.0, 0.0, 50.0)])
def test_what_is_behind_or_beside_is_not_drawn(place):
    pixels = drawn(on_floor(cloud_of([place], [RED])))
    assert (pixels == GROUND).all() or place == (5.3, 0, 50)


def test_optical_frames_are_turned_upright():
    """Their z is ahead, x to the right, y down."""
    upright = drawn(cloud_of([(10, 1, 51)], [RED]))
    optical = drawn(cloud_of([(-1, -51, 10)], [RED], optical=True))
    assert where(upright, RED) and np.array_equal(upright, optical)


def spread(values):
    """Return a row of places at the height of the eye, one for each value."""
    return [(10, index - len(values) / 2.0, 50) for index in range(len(values))]


def test_colours_by_height():
    heights = np.linspace(48.0, 52.0, 101)
    artist = CloudArtist()
    picture = artist.draw(cloud_of([(10, 0, z) for z in heights]), LEVEL, SIZE, HEIGHT)
    assert picture.scale == pytest.approx((48.08, 51.92), abs=0.01)
    column = picture.pixels[:, 100]
    column = column[np.isin(column, TABLE)]
    shades = [int(np.flatnonzero(TABLE == colour)[0]) for colour in column]
    assert shades == sorted(shades, reverse=True) and shades[0] == 255 and shades[-1] == 0


def test_colours_by_distance_are_light_when_near():
    cloud = cloud_of([(8, -2, 0.5), (12, 2, 0.5)])
    picture = CloudArtist().draw(cloud, Orbit((10.0, 0.0, 0.5), 0.0, 0.0, 6.0), SIZE, DISTANCE)
    assert where(picture.pixels, TABLE[255])[0] > 100 > where(picture.pixels, TABLE[0])[0]
    assert picture.scale[0] == pytest.approx(8.2, abs=0.2)


def test_scales_follow_without_flickering():
    artist, places = CloudArtist(), np.array(spread(range(50)), float)
    first = artist.draw(cloud_of(places), LEVEL, SIZE, HEIGHT).scale
    places[:, 2] += 10.0
    second = artist.draw(cloud_of(places, received_s=0.1), LEVEL, SIZE, HEIGHT).scale
    last = artist.draw(cloud_of(places, received_s=60.0), LEVEL, SIZE, HEIGHT).scale
    assert first[0] < second[0] < first[0] + 2.0 and last[0] == pytest.approx(first[0] + 10.0)


@pytest.mark.parametrize('colouring', [HEIGHT, DISTANCE, INTENSITY, COLOUR])
@pytest.mark.parametrize('places', [[], [(1, 0, 0)], [(1e4, 1e4, 1e4), (-1e4, 0, 0)]])
def test_any_cloud_can_be_drawn(places, colouring):
    cloud = cloud_of(places, [RED] * len(places), intensity=np.full(len(places), 1e30, 'f4'))
    for orbit in (LEVEL, fitted(cloud.points), Orbit((1.0, 0.0, 0.0), 1.0, -1.0, 0.3)):
        for size in ((1, 1), (3, 200), SIZE):
            assert drawn(cloud, orbit, colouring, size).shape == size[::-1]


def seen(place, orbit):
    return projected([place], orbit, SIZE)[0][:2]


def test_a_drag_turns_the_near_side_with_the_hand():
    orbit, near = Orbit((0.0, 0.0, 0.0), 0.0, 0.0, 5.0), (-1.0, 0.0, 0.0)
    assert seen(near, orbit.turned(20, 0))[0] > seen(near, orbit)[0]
    assert seen(near, orbit.turned(0, 20))[1] > seen(near, orbit)[1]
    steep = orbit.turned(0, 1e6)
    assert steep.pitch_rad == pytest.approx(math.radians(89.0))
    assert abs(orbit.turned(1e6, 0).yaw_rad) <= math.pi


def test_a_drag_moves_what_is_in_the_middle_with_the_hand():
    orbit = Orbit((3.0, 1.0, 0.5), 0.7, 0.4, 5.0)
    moved = orbit.moved(12.0, -7.0, SIZE[1])
    assert seen(orbit.target_m, moved) - seen(orbit.target_m, orbit) == pytest.approx(
        (12.0, -7.0), abs=1e-6)
    assert max(map(abs, orbit.moved(1e12, 1e12, 1).target_m)) <= 1e4


def test_fitted_shows_nearly_all_and_the_sensor():
    columns = room(20_000)
    points = np.column_stack([columns[axis] for axis in 'xyz'])
    orbit = fitted(points)
    x, y, _ = projected(np.vstack((points, [(0, 0, 0)])), orbit, (640, 480)).T
    inside = (x >= 0) & (x < 640) & (y >= 0) & (y < 480)
    assert inside.mean() > 0.95 and inside[-1]
    assert fitted(points[:0]) == Orbit()


def test_an_orbit_is_kept_as_numbers():
    orbit = Orbit((1.0, -2.0, 0.25), 0.5, -0.25, 7.5)
    assert read_orbit(orbit.to_list()) == orbit


@pytest.mark.parametrize('words', [
    None, [], [1] * 5, [1] * 7, ['1'] * 6, [math.nan] * 6, [0, 0, 0, 0, 1.6, 5],
    [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 1e9], [10 ** 400] + [1] * 5, [True] * 6])
def test_no_orbit_of_other_words(words):
    with pytest.raises(ValueError):
        read_orbit(words)


def test_a_ceiling_does_not_hide_the_room():
    """Seen from above; seen level or from below it is there."""
    cloud = cloud_of([(3, -0.8, 2.4)] * 5 + [(3, -0.8, 0.0)] * 60, [BLUE] * 5 + [RED] * 60)
    for orbit, cut in ((Orbit((3.0, 0.0, 0.0), 0.0, 1.5, 5.0), True),
                       (Orbit((3.0, 0.0, 1.0), 0.0, 0.0, 5.0), False),
                       (Orbit((3.0, 0.0, 1.0), 0.0, -0.5, 5.0), False)):
        picture = CloudArtist().draw(cloud, orbit, SIZE, COLOUR)
        assert picture.cut == cut and bool(where(picture.pixels, BLUE)) != cut
        assert where(picture.pixels, RED)
