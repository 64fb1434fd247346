# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The laser scan: ahead is up, left is left, metres are metres, and old is not live."""
import math

import numpy as np
import pytest

from mhri.base.gui import theme
from mhri.sensors.gui.scan_view import reach_for, scan_points, ScanView, Window


def scan_of(bearings_deg, range_m):
    """Return a scan of one degree a step with points in some directions only."""
    ranges = np.full(360, np.nan)
    ranges[[(180 + bearing) % 360 for bearing in bearings_deg]] = range_m
    return ranges, -math.pi, math.radians(1.0), 8.0


@pytest.fixture
def view(operator):
    widget = ScanView()
    widget.resize(400, 420)
    operator.show(widget)
    return widget


def places(view, name):
    """Return the middle of what is painted in a colour, in metres ahead and to the left."""
    image, wanted = view.grab().toImage(), theme.colour(name, view.palette()).getRgb()
    line = 1.4 * view.fontMetrics().height()
    robot_x, robot_y, scale = view.frame()
    found = [(x, y) for x in range(image.width()) for y in range(int(image.height() - line))
             if sum(abs(a - b) for a, b in zip(image.pixelColor(x, y).getRgb(), wanted)) < 40]
    if not found:
        return None
    x, y = np.mean(found, axis=0) + 0.5
    return (robot_y - y) / scale, (robot_x - x) / scale


@pytest.mark.parametrize('bearing_deg, ahead, left', [
    (0, 2.0, 0.0), (-90, 0.0, -2.0), (45, 1.41, 1.41)])
def test_a_point_is_where_it_was_measured(view, operator, bearing_deg, ahead, left):
    view.show_value(scan_of([bearing_deg], 2.0))
    operator.settle()
    assert places(view, theme.DRIVE) == pytest.approx((ahead, left), abs=0.04)
    assert view.nearest_m == 2.0


def test_what_is_near_is_orange(view, operator):
    view.show_value(scan_of([90], 0.4))
    operator.settle()
    assert places(view, theme.ATTENTION) == pytest.approx((0.0, 0.4), abs=0.04)
    assert places(view, theme.DRIVE) is None


@pytest.mark.parametrize('farthest_m, reach_m', [
    (0.3, 0.5), (1.4, 1.5), (3.9, 4.0), (5.0, 6.0), (29.0, 30.0), (400.0, 100.0)])
def test_the_reach_shows_all_points(farthest_m, reach_m):
    assert reach_for(np.array([farthest_m] * 10)) == reach_m
    assert reach_for(np.array([farthest_m] * 99 + [1000.0])) == reach_m, 'but not a stray one'
    assert reach_for(np.array([])) == 0.5


def corridor(ahead_m):
    """Return a scan in a corridor 1.4 m wide that ends ahead of the robot; nothing behind it."""
    angles = np.radians(np.arange(-90, 91))
    with np.errstate(divide='ignore'):
        ranges = np.minimum(ahead_m / np.maximum(np.cos(angles), 1e-9),
                            0.7 / np.abs(np.sin(angles)))
    return ranges, -math.pi / 2.0, math.radians(1.0), 8.0


def test_the_walls_fill_the_picture_and_the_robot_is_where_it_is_between_them(view):
    view.show_value(corridor(3.5))
    assert view.shown_m == Window(ahead=4.0, back=0.5, left=0.75, right=0.75)
    x, y, scale = view.frame()
    assert x == pytest.approx(0.5 * view.width(), abs=1.0) and y > 0.7 * view.height()
    assert scale * 4.5 == pytest.approx(view.height(), rel=0.15)
    view.show_value(scan_of([-90], 2.9))
    for _ in range(30):
        view.show_value(scan_of([-90], 2.9))
    assert view.shown_m.right == 3.0 and view.shown_m.left == 0.75


def test_an_old_scan_does_not_look_live(view, operator):
    view.show_value(scan_of([0], 2.0))
    view.show_age(0.3)
    operator.settle()
    assert view.warning == '' and places(view, theme.DRIVE)
    view.show_age(3.2)
    operator.settle()
    assert '3.2 s' in view.warning and places(view, theme.DRIVE) is None
    view.show_value(scan_of([0], 2.0))
    assert view.warning == ''


def test_points_in_metres():
    ahead, left, distance = scan_points(np.array([1.0, np.nan, 2.0]), 0.0, math.pi / 4.0)
    assert list(ahead) == pytest.approx([1.0, 0.0]) and list(left) == pytest.approx([0.0, 2.0])
    assert list(distance) == [1.0, 2.0]
