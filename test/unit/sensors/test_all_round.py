# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Several lasers as one scan: ahead stays ahead, however they are mounted."""
import math

import numpy as np
import pytest

from mhri.base.geometry import Pose
from mhri.sensors.all_round import all_round, Sweep, turned
from mhri.sensors.nearest import nearest

DEGREE = math.radians(1.0)


def sweep(bearing_deg, range_m):
    """Return a scan of 180 degrees that meets one thing, as its laser counts."""
    ranges = np.full(181, np.nan)
    ranges[90 + bearing_deg] = range_m
    return Sweep(ranges, -90 * DEGREE, DEGREE, 8.0)


@pytest.mark.parametrize('bearing, heading, upside_down, direction', [
    (30, 0, False, 'ahead left'), (30, 0, True, 'ahead right'), (0, 180, False, 'behind'),
    (45, 90, False, 'behind left'), (45, 180, True, 'behind left')])
def test_one_laser_is_counted_from_the_robots_ahead(bearing, heading, upside_down, direction):
    found = turned(sweep(bearing, 2.0), (Pose(0.3, 0.0, heading * DEGREE), upside_down))
    found_nearest = nearest(*found[:3])
    assert (found_nearest.distance_m, found_nearest.direction) == (2.0, direction)


def test_several_lasers_are_measured_from_the_robots_middle():
    found = all_round([(sweep(0, 1.0), (Pose(0.2, 0.0, 0.0), False)),
                       (sweep(0, 0.5), (Pose(-0.2, 0.1, math.pi), False))])
    assert np.count_nonzero(np.isfinite(found.ranges)) == 2
    ahead, behind = found.ranges[360], np.nanmin(found.ranges)
    assert ahead == pytest.approx(1.2)
    assert behind == pytest.approx(math.hypot(0.7, 0.1))
    assert nearest(*found[:3]).direction == 'behind'


def test_the_nearest_in_a_direction_counts_and_a_blind_laser_adds_nothing():
    here = (Pose(0.0, 0.0, 0.0), False)
    blind = Sweep(np.full(5, np.nan), 0.0, DEGREE, 30.0)
    found = all_round([(sweep(0, 3.0), here), (sweep(0, 1.5), here), (blind, here)])
    assert np.nanmin(found.ranges) == pytest.approx(1.5)
    assert found.range_max == 30.0
    assert not np.isfinite(all_round([(blind, here), (blind, here)]).ranges).any()
