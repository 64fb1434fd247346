# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Odometry against motion capture: frames that differ, and odometry that slips."""
import math

import pytest

from mhri.base.geometry import Pose
from mhri.base.mocap import Drift, DriftMeter


def in_room(pose, x_m=3.0, y_m=-2.0, turn=1.1):
    """Return a pose of odom in a room whose frame lies elsewhere, turned."""
    return Pose(x_m + pose.x_m * math.cos(turn) - pose.y_m * math.sin(turn),
                y_m + pose.x_m * math.sin(turn) + pose.y_m * math.cos(turn),
                pose.heading_rad + turn)


def test_frames_that_differ_are_no_drift():
    """Whatever the frames, a robot whose odometry is right has no difference."""
    meter = DriftMeter()
    for step in range(50):
        pose = Pose(0.1 * step, 0.02 * step * step / 10.0, 0.13 * step)
        drift = meter.drift(pose, in_room(pose))
        assert drift.distance_m == pytest.approx(0.0, abs=1e-9)
        assert drift.heading_rad == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize('slip, expected', [
    (Pose(0.3, 0.4, 0.0), Drift(0.5, 0.0)), (Pose(0.0, 0.0, 0.2), Drift(0.0, 0.2)),
    (Pose(0.0, 0.0, -3.0), Drift(0.0, -3.0))])
def test_what_odometry_slips_is_the_difference(slip, expected):
    meter = DriftMeter()
    meter.drift(Pose(1.0, 1.0, 0.5), in_room(Pose(1.0, 1.0, 0.5)))
    truth = Pose(2.0, 0.5, -0.4)
    measured = Pose(truth.x_m + slip.x_m, truth.y_m + slip.y_m,
                    truth.heading_rad + slip.heading_rad)
    drift = meter.drift(measured, in_room(truth))
    assert drift.distance_m == pytest.approx(expected.distance_m)
    assert drift.heading_rad == pytest.approx(expected.heading_rad)


def test_half_a_turn_is_pi_and_never_minus_pi():
    meter = DriftMeter()
    meter.drift(Pose(0.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0))
    for heading in (math.pi, -math.pi, 3 * math.pi):
        assert meter.drift(Pose(0.0, 0.0, heading),
                           Pose(0.0, 0.0, 0.0)).heading_rad == pytest.approx(math.pi)


@pytest.mark.parametrize('odometry, captured', [
    (None, Pose(0, 0, 0)), (Pose(0, 0, 0), None), (Pose(math.nan, 0, 0), Pose(0, 0, 0)),
    (Pose(0, 0, 0), Pose(0, math.inf, 0))])
def test_nothing_is_said_while_one_is_missing(odometry, captured):
    """And a pair that cannot be used does not become the first one."""
    meter = DriftMeter()
    assert meter.drift(odometry, captured) is None
    assert meter.drift(Pose(1, 0, 0), Pose(5, 5, 0)) == Drift(0.0, 0.0)
