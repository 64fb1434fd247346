# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The nearest thing of a scan: how far, and in which of eight directions."""
import math

import pytest

from mhri.sensors.nearest import DIRECTIONS, nearest, Nearest

NAN, INF = math.nan, math.inf
DEGREE = math.radians(1.0)


@pytest.mark.parametrize('degrees, direction', [
    (22, 'ahead'), (23, 'ahead left'), (90, 'left'), (135, 'behind left'), (-180, 'behind'),
    (225, 'behind right'), (-90, 'right'), (-23, 'ahead right'), (720, 'ahead')])
def test_eight_directions(degrees, direction):
    assert nearest([0.95], degrees * DEGREE, DEGREE) == Nearest(0.95, direction)
    assert direction in DIRECTIONS


@pytest.mark.parametrize('ranges, start, step, found', [
    ([3.0, 1.0, 2.0], -90, 90, (1.0, 'ahead')),
    # All around, as a TurtleBot3 does it; upside down.
    ([2.0] * 90 + [0.5] + [2.0] * 269, 0, 1, (0.5, 'left')),
    ([2.0] * 90 + [0.5] + [2.0] * 269, 0, -1, (0.5, 'right')),
    # What is no measurement is no thing: NaN first, nothing within reach, behind the sensor.
    ([NAN, 0.8, NAN], 0, 90, (0.8, 'left')),
    ([INF, 4.0], 0, 180, (4.0, 'behind')),
    ([-1.0, 4.0], 0, 180, (4.0, 'behind')),
    ([1e30, 4.0], 0, 180, (4.0, 'behind')),
    # Of two alike the first.
    ([1.0, 1.0], 0, 90, (1.0, 'ahead')),
])
def test_the_nearest(ranges, start, step, found):
    assert nearest(ranges, start * DEGREE, step * DEGREE) == Nearest(*found)


@pytest.mark.parametrize('ranges, start, step', [
    ([], 0.0, 0.1), ([NAN, NAN], 0.0, 0.1), ([INF], 0.0, 0.1), ([1.0], NAN, 0.1),
    ([1.0, 0.5], 0.0, INF), ([1.0, 0.5], 0.0, NAN)])
def test_nothing_is_said(ranges, start, step):
    assert nearest(ranges, start, step) is None
