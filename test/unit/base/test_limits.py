# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Speeds and limits."""
import math
import random

import pytest

from mhri.base.limits import (
    clamp_keeping_curvature, Velocity, within_limits, ZERO)
from mhri.base.robot_types import Limits

BURGER = Limits(0.22, 2.84)
MECANUM = Limits(0.5, 2.0, holonomic=True)

CLAMPED = {
    'within': ((0.1, 1.0), (0.1, 1.0)),
    'at_the_limit': ((0.22, 2.84), (0.22, 2.84)),
    'linear_over': ((0.44, 1.0), (0.22, 0.5)),
    'angular_over': ((0.1, 5.68), (0.05, 2.84)),
    'both_over_linear_leads': ((0.88, 5.68), (0.22, 1.42)),
    'backwards': ((-0.44, -1.0), (-0.22, -0.5)),
    'turn_on_the_spot': ((0.0, -10.0), (0.0, -2.84)),
    'zero': ((0.0, 0.0), (0.0, 0.0)),
}


@pytest.mark.parametrize('case', sorted(CLAMPED))
def test_clamp(case):
    """One factor for both."""
    asked, expected = CLAMPED[case]
    clamped = clamp_keeping_curvature(Velocity(*asked), BURGER)
    assert (clamped.linear_mps, clamped.angular_rad_s) == pytest.approx(expected)


@pytest.mark.parametrize('asked, mecanum, burger', [
    ((0.0, 0.0, 0.3), (0.0, 0.0, 0.3), (0.0, 0.0, 0.0)),
    ((0.6, 1.0, -0.8), (0.3, 0.5, -0.4), (0.22, 0.22 / 0.6, 0.0)),
    ((0.3, 4.0, 0.4), (0.15, 2.0, 0.2), (0.213, 2.84, 0.0)),
    ((0.1, 0.0, math.nan), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))])
def test_one_factor_for_all_three_and_nothing_sideways_for_who_cannot(asked, mecanum, burger):
    """The limit is on the speed in whatever direction: at an angle it is no faster."""
    for limits, expected in ((MECANUM, mecanum), (BURGER, burger)):
        assert clamp_keeping_curvature(Velocity(*asked), limits) == pytest.approx(expected)


@pytest.mark.parametrize('asked, expected', [
    ((0.3, 0.5, 0.4), (0.3, 0.5, 0.4)), ((0.6, 1.0, -0.8), (0.3, 0.5, -0.4)),
    ((0.0, 2.0, 0.5), (0.0, 1.0, 0.25)), ((-2.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((1e300, 1e300, 0.0), (0.5, 0.5, 0.0))])
def test_the_operators_limit_scales_all_three(asked, expected):
    assert within_limits(Velocity(*asked), 0.5, 1.0) == pytest.approx(expected)
    assert within_limits(Velocity(0.0, 0.5), 0.0, 1.0) == Velocity(0.0, 0.5)
    assert within_limits(Velocity(0.3, 0.5), 0.0, 1.0) == ZERO


@pytest.mark.parametrize('bad', [float('nan'), float('inf'), float('-inf')])
def test_not_finite_becomes_standstill(bad):
    """Either component."""
    assert clamp_keeping_curvature(Velocity(bad, 1.0), BURGER) == ZERO
    assert clamp_keeping_curvature(Velocity(0.1, bad), BURGER) == ZERO


def test_clamp_keeps_curvature_and_limits_for_anything():
    """Random velocities over forty orders of magnitude."""
    dice = random.Random(7)
    for _ in range(2000):
        linear, angular = (dice.choice((-1, 1)) * 10.0 ** dice.uniform(-20, 20) for _ in '12')
        clamped = clamp_keeping_curvature(Velocity(linear, angular), BURGER)
        assert abs(clamped.linear_mps) <= BURGER.linear_mps * (1 + 1e-12)
        assert abs(clamped.angular_rad_s) <= BURGER.angular_rad_s * (1 + 1e-12)
        assert clamped.linear_mps * angular == pytest.approx(clamped.angular_rad_s * linear)


def test_the_largest_numbers_do_not_overflow_into_motion():
    """1e308 / 0.22 is infinite; the answer is still finite."""
    assert clamp_keeping_curvature(Velocity(1e308, 1.0), BURGER).is_finite()


@pytest.mark.parametrize('velocity, zero, finite', [
    (ZERO, True, True), (Velocity(-0.0, 0.0), True, True), (Velocity(1e-9, 0.0), False, True),
    (Velocity(0.0, -1e-9), False, True), (Velocity(0.0, 0.0, 1e-9), False, True),
    (Velocity(0.0, 0.0, math.inf), False, False), (Velocity(math.nan, 0.0), False, False)])
def test_velocity_says_what_it_is(velocity, zero, finite):
    """Standstill is exact."""
    assert (velocity.is_zero(), velocity.is_finite()) == (zero, finite)
