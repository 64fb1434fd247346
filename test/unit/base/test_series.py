# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rings of bins keep every peak in a fixed room; axes follow without jitter; angles are right."""
import math

import numpy as np
import pytest

from mhri.base.series import (
    AxisRange, BIN_S, BinRing, GAP_S, IMU_KEYS, LONGEST_S, ODOMETRY_KEYS, POINTS, roll_pitch_yaw,
    Series)

NOW = 5000.0


def ring_of(times, values, key='a'):
    ring = BinRing((key,))
    ring.add(times, np.asarray(values, float).reshape(-1, 1))
    return ring


def finite(curve):
    x, y = curve
    return x[np.isfinite(y)], y[np.isfinite(y)]


@pytest.mark.parametrize('rate_hz, window_s', [(5, 60), (50, 20), (1000, 5), (1000, 60)])
def test_a_curve_has_few_points_and_keeps_the_peaks(rate_hz, window_s):
    times = NOW - LONGEST_S + np.arange(int(LONGEST_S * rate_hz)) / rate_hz
    values = np.sin(times)
    spike = len(times) - int(0.4 * window_s * rate_hz)
    values[spike] = 7.0
    x, y = ring_of(times, values).curve('a', NOW, window_s)
    assert len(x) <= POINTS + 4
    step_s = window_s / (POINTS // 2)
    assert np.nanmax(y) == 7.0
    assert x[np.nanargmax(y)] == pytest.approx(times[spike] - NOW, abs=step_s)
    assert x[0] >= -window_s - step_s and x[-1] <= 0.0
    assert np.all(np.diff(x) >= 0.0)


def test_a_slow_source_is_drawn_sample_by_sample():
    times = NOW - np.arange(20)[::-1] * 0.2
    x, y = ring_of(times, np.arange(20.0)).curve('a', NOW, 5)
    assert list(x) == pytest.approx(list(times - NOW)) and list(y) == list(range(20))


def test_batches_add_up_to_what_one_batch_gives():
    rng = np.random.RandomState(7)
    times, values = NOW - 10.0 + np.sort(rng.rand(3000)) * 10.0, rng.randn(3000)
    whole, parts = ring_of(times, values), BinRing(('a',))
    for part in np.array_split(np.arange(3000), 97):
        parts.add(times[part], values[part].reshape(-1, 1))
    for window_s in (5, 10, 60):
        for one, other in zip(whole.curve('a', NOW, window_s), parts.curve('a', NOW, window_s)):
            np.testing.assert_array_equal(one, other)


def test_a_peak_keeps_its_shape_while_it_travels():
    ring = ring_of(NOW + np.arange(400) * 0.005, np.random.RandomState(1).randn(400))
    tops = set()
    for step in range(60):
        tops.add(tuple(np.sort(ring.curve('a', NOW + 2.0 + step * 0.05, 30)[1])[-5:]))
    assert len(tops) == 1


@pytest.mark.parametrize('silence_s, broken', [(0.2, False), (GAP_S + 0.2, True), (20.0, True)])
def test_no_line_across_a_silence(silence_s, broken):
    first = NOW - 25.0 + np.arange(0.0, 1.0, 0.01)
    times = np.concatenate((first, first + 1.0 + silence_s))
    _, y = ring_of(times, np.ones(len(times))).curve('a', NOW, 30)
    assert np.isnan(y).any() == broken


def test_an_angle_breaks_where_it_goes_around():
    times = NOW - 10.0 + np.arange(0, 10, 0.005)
    angle = (times + math.pi) % (2.0 * math.pi) - math.pi
    _, y = ring_of(times, angle, 'yaw').curve('yaw', NOW, 10)
    steps = np.abs(np.diff(y))
    assert np.isnan(y).sum() >= 1 and np.nanmax(steps) < 0.2


def test_a_hole_in_one_value_leaves_the_other_alone():
    ring = BinRing(('a', 'b'))
    ring.add(NOW - np.array([0.3, 0.2, 0.1]), [[1, 1], [math.nan, 2], [3, 3]])
    assert list(ring.curve('a', NOW, 5)[1]) == [1, 3]
    assert list(ring.curve('b', NOW, 5)[1]) == [1, 2, 3]


def test_a_clock_that_stumbles_and_a_batch_longer_than_the_ring_do_no_harm():
    ring = ring_of([NOW, NOW - 0.5, NOW - 0.4], [1, 2, 3])
    assert sorted(finite(ring.curve('a', NOW + 0.1, 5))[1]) == [1, 3]
    ring.add(NOW + 1.0 + np.arange(0.0, 500.0, 0.01), np.ones((50000, 1)))
    assert set(finite(ring.curve('a', NOW + 501.0, 60))[1]) == {1.0}


def test_the_ring_goes_around_many_times():
    ring = BinRing(('a',))
    for step in range(40):
        times = NOW + step * 7.0 + np.arange(0, 7.0, 0.02)
        ring.add(times, np.full((len(times), 1), float(step)))
    x, y = finite(ring.curve('a', NOW + 280.0, 20))
    assert set(y) == {37.0, 38.0, 39.0} and x[0] == pytest.approx(-20.0, abs=2 * BIN_S + 0.2)


def test_a_snapshot_does_not_change_and_its_latest_is_the_newest():
    ring = ring_of([NOW - 1.0], [[1.0]])
    rings = {key: BinRing(ODOMETRY_KEYS) for key in ODOMETRY_KEYS + IMU_KEYS}
    rings['a'] = ring.copy()
    series = Series(NOW, rings)
    ring.add([NOW - 0.5], [[9.0]])
    assert list(series.curve('a', 5)[1]) == [1.0]
    assert series.latest('a') == 1.0 and series.latest('linear') is None


@pytest.mark.parametrize('degrees', [
    (0, 0, 0), (10, 0, 0), (0, -20, 0), (0, 0, 170), (5, 10, -175), (-30, 40, 90), (0, 90, 0)])
def test_angles_of_a_quaternion(degrees):
    roll, pitch, yaw = (math.radians(value) / 2.0 for value in degrees)
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(v), math.sin(v)) for v in (roll, pitch, yaw))
    quaternion = np.array([[sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                            cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy]])
    found = np.degrees(roll_pitch_yaw(quaternion))[0]
    assert list(found) == pytest.approx(degrees, abs=1e-4)


@pytest.mark.parametrize('low, high, limits', [
    (math.nan, math.nan, (-0.1, 0.1)),
    (0.0, 0.0, (-0.1, 0.1)),
    (-0.02, 0.03, (-0.1, 0.1)),
    (0.0, 0.31, (-0.1, 0.4)),
    (-0.12, 0.31, (-0.2, 0.4)),
    (-0.31, 0.0, (-0.4, 0.1)),
    (-3.0, 2.0, (-4.0, 3.0)),
    (0.0, 9.9, (-0.1 * 10, 12.0)),
])
def test_an_axis_grows_at_once_to_round_numbers(low, high, limits):
    found = AxisRange(0.1).follow(low, high, 0.0)
    assert found == pytest.approx(limits)
    assert (math.isnan(low) or found[0] <= low) and (math.isnan(high) or high <= found[1])


def test_an_axis_shrinks_late_and_not_at_all_when_it_is_needed_again():
    axis = AxisRange(0.1, shrink_after_s=4.0)
    large = axis.follow(-1.0, 1.0, 0.0)
    assert axis.follow(0.0, 0.05, 1.0) == large
    assert axis.follow(0.0, 0.05, 4.9) == large
    assert axis.follow(-1.0, 1.0, 4.95) == large
    assert axis.follow(0.0, 0.05, 5.0) == large
    assert axis.follow(0.0, 0.05, 9.0) == (-0.1, 0.1)


@pytest.mark.parametrize('absurd', [1e30, -1e30, 1.6e308, math.inf, math.nan])
def test_what_cannot_be_leaves_no_trace(absurd):
    times = NOW - 10.0 + np.arange(1000) * 0.01
    values = np.zeros(1000)
    values[::2] = absurd
    with np.errstate(all='raise'):
        ring = ring_of(times, values)
        x, y = ring.curve('a', NOW, 10)
    assert len(x) and set(finite((x, y))[1]) == {0.0}
    turned = roll_pitch_yaw(np.array([[0.0, 0.0, absurd, 1.0], [0.0, 0.0, 0.0, 1.0]]))
    assert np.isnan(turned[0]).all() and not turned[1].any()
