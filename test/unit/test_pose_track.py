# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where a robot was, by the stamps of its odometry."""
import math

import pytest

from mhri.core.robots.mocap import Pose
from mhri.core.robots.pose_track import PoseTrack


def track(*rows):
    """Return a track of (stamp, x, heading)."""
    made = PoseTrack()
    for stamp, x, heading in rows:
        made.add(stamp, Pose(x, 0.0, heading))
    return made


@pytest.mark.parametrize('rows, stamp, x', [
    ([], 1.0, None), ([(1.0, 5.0, 0.0)], 1.0, None),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 1.05, 0.5),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 1.1, 1.0),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 1.2, None),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 0.9, None),
    # Another clock.
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], -500.0, None),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 500.0, None),
    # One that went back.
    ([(9.0, 0.0, 0.0), (1.0, 2.0, 0.0), (1.1, 3.0, 0.0)], 1.05, 2.5),
    ([(9.0, 0.0, 0.0), (1.0, 2.0, 0.0), (1.1, 3.0, 0.0)], 9.0, None),
    # A silence says nothing of what was in it, but that it is not long.
    ([(1.0, 0.0, 0.0), (9.0, 8.0, 0.0)], 8.0, None)])
def test_where_it_was(rows, stamp, x):
    pose = track(*rows).at(stamp)
    assert (pose and pose.x_m) == (None if x is None else pytest.approx(x))


def test_the_heading_takes_the_short_way():
    pose = track((1.0, 0.0, 3.1), (1.1, 0.0, -3.1)).at(1.05)
    assert abs(math.remainder(pose.heading_rad - math.pi, 2.0 * math.pi)) < 1e-9


def test_only_the_last_half_second_is_kept():
    made = track(*[(0.02 * number, float(number), 0.0) for number in range(200)])
    assert made.at(0.02 * 199 - 0.6) is None
    assert made.at(0.02 * 199 - 0.4).x_m == pytest.approx(179.0)
