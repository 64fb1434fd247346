# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a sensor can say at all, kind by kind."""
import math

import numpy as np
import pytest

from mhri.base.plausible import (
    ACCELERATION, ANGLE, ANGULAR_VELOCITY, BATTERY, beams_problem, BOUNDS, can_be, MAX_BEAMS,
    PLACE, QUATERNION, RANGE, SENSOR, sifted, SPEED, thinned)

# What real sensors say, the extremes of their data sheets among them.
REAL = {QUATERNION: (-1.0, 0.0, 1.0), ANGLE: (-math.pi, 1000.0), ANGULAR_VELOCITY: (-350.0, 70.0),
        ACCELERATION: (9.81, -2000.0), SPEED: (-2.0, 60.0), PLACE: (-0.5, 5_900_000.0),
        RANGE: (0.0, 0.12, 600.0), BATTERY: (0.0, 0.82, 1.02, 100.0),
        SENSOR: (-273.15, 1e6, 1e12)}
ABSURD = (1e30, -1e30, 1.6e308, math.inf, -math.inf)


def test_the_table_of_this_test_is_whole():
    assert set(REAL) == set(BOUNDS)


@pytest.mark.parametrize('kind', sorted(BOUNDS))
def test_what_can_be(kind):
    assert all(can_be(kind, value) for value in REAL[kind])
    assert not any(can_be(kind, value) for value in (*ABSURD, math.nan))


@pytest.mark.parametrize('kind', sorted(BOUNDS))
def test_what_cannot_be_is_no_value_and_is_named(kind):
    for value in ABSURD:
        (first, second), problem = sifted((SPEED, kind), (0.3, value))
        assert first == 0.3 and math.isnan(second)
        assert problem.startswith('{} of {:.3g}'.format(kind, value)) and len(problem) < 60
    kept, problem = sifted((kind,) * len(REAL[kind]), REAL[kind])
    assert tuple(kept) == REAL[kind] and problem is None


def test_nan_is_what_a_sensor_does_not_measure():
    kept, problem = sifted((ACCELERATION,), (math.nan,))
    assert math.isnan(kept[0]) and problem is None


@pytest.mark.parametrize('count, first, step, problem', [
    (0, 0.0, 0.0, None), (360, -math.pi, 0.0175, None), (MAX_BEAMS, 0.0, 6e-5, None),
    (MAX_BEAMS + 1, 0.0, 6e-5, '100001 beams'), (360, math.nan, 0.1, 'beams at an angle of nan'),
    (360, 0.0, math.inf, 'beams at an angle of inf'),
    (360, 1e30, 0.1, 'beams at an angle of 1e+30')])
def test_scans(count, first, step, problem):
    found = beams_problem(count, first, step)
    assert found is None if problem is None else found.startswith(problem)


@pytest.mark.parametrize('count, most, left, together', [
    (0, 10, 0, 1), (9, 10, 9, 1), (10, 10, 10, 1), (11, 10, 6, 2), (100_000, 4000, 4000, 25)])
def test_thinned(count, most, left, together):
    ranges = np.full(count, 5.0)
    if count:
        ranges[count // 2] = 0.4
        ranges[0] = np.nan
    found, by = thinned(ranges, most)
    assert (len(found), by) == (left, together)
    if count > 10:
        assert found[count // 2 // by] == 0.4, 'what is nearest stays, in its direction'
        assert np.isfinite(found).all()
