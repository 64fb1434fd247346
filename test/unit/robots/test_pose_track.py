# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""When a scan was made and where the robot was then, by the stamps of its odometry."""

import pytest

from mhri.base.geometry import Pose
from mhri.robots.pose_track import KEPT_S, Moment, PoseTrack, SAME_CLOCK_S
from mhri.sensors.brake import SCAN_OLD_S

# The robot's clock, when ours says 0.
NOW = 1.8e9


def track(*rows, began=0.0, delay_s=0.0):
    """Return a track of (stamp, x, heading) by a clock that began at a time, heard with a delay."""
    made = PoseTrack()
    for stamp, x, heading in rows:
        made.add(began + stamp, Pose(x, 0.0, heading), stamp + delay_s)
    return made


def moment(made, stamp, heard_s=1.0):
    """Return (when, x or None) of a scan."""
    at_s, pose = made.moment(stamp, heard_s)
    return at_s, pose and pytest.approx(pose.x_m)


@pytest.mark.parametrize('rows, stamp, x', [
    ([], 1.0, None), ([(1.0, 5.0, 0.0)], 1.0, None),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 1.05, 0.5),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 1.1, 1.0),
    # Before or after what is known, not far.
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 1.2, None),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 0.9, None),
    # Another clock.
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], -500.0, None),
    ([(1.0, 0.0, 0.0), (1.1, 1.0, 0.0)], 500.0, None),
    ([(0.0, 0.0, 0.0)], NOW, None),
    # One that went back.
    ([(9.0, 0.0, 0.0), (1.0, 2.0, 0.0), (1.1, 3.0, 0.0)], 1.05, 2.5),
    ([(9.0, 0.0, 0.0), (1.0, 2.0, 0.0), (1.1, 3.0, 0.0)], 9.0, None)])
def test_where_it_was(rows, stamp, x):
    assert moment(track(*rows), stamp)[1] == x


def rows(count=51):
    """Return odometry at 50 Hz up to 1 s (of 51), at 1 m/s."""
    return [(0.02 * number, 0.02 * number, 0.0) for number in range(count)]


@pytest.mark.parametrize('began', [NOW, NOW - 86400.0, NOW + 0.3])
@pytest.mark.parametrize('stamp, heard_s, at_s, x', [
    # Made just now; made 0.2 s ago, late as all is by 0.05 s; heard late.
    (1.0, 1.05, 1.05, 1.0), (0.85, 1.05, 0.9, 0.85), (0.85, 1.25, 0.9, 0.85),
    # Stamped later than what was heard: nothing is made after it is heard.
    (1.03, 1.05, 1.05, None), (1.9, 1.05, 1.05, None),
    # By no clock, or another one: it counts from its receipt.
    (1.0 + SAME_CLOCK_S + 0.1, 1.05, 1.05, None), (1.0 - SAME_CLOCK_S - 0.1, 1.05, 1.05, None),
    (-1e9, 1.05, 1.05, None)])
def test_whatever_its_clock_says_a_scan_counts_from_its_stamp_where_that_is_sane(
        began, stamp, heard_s, at_s, x):
    found = track(*rows(), began=began, delay_s=0.05).moment(began + stamp, heard_s)
    assert found.at_s == pytest.approx(at_s, abs=1e-3)
    assert (found.pose and found.pose.x_m) == (x if x is None else pytest.approx(x, abs=1e-3))


@pytest.mark.parametrize('began', [0.0, NOW])
@pytest.mark.parametrize('behind_s', [KEPT_S + 0.02, 1.0, SAME_CLOCK_S - 0.1])
def test_a_scan_that_is_late_beyond_use_says_so(began, behind_s):
    with pytest.raises(ValueError, match='stamped {:.1f} s before the odom'.format(behind_s)):
        track(*rows(201), began=began).moment(began + 4.0 - behind_s, 4.0)


def test_the_brake_trusts_no_scan_whose_stamp_is_old():
    """A laser that lags: each of its scans is heard at once after the last, and all are old."""
    found = track(*rows(), began=NOW).moment(NOW + 0.6, 1.0)
    assert 1.0 - found.at_s > SCAN_OLD_S


def test_no_stamps_at_all():
    made = PoseTrack()
    assert made.moment(0.0, 3.0) == Moment(3.0, None)
    for heard_s in (1.0, 1.1):
        made.add(0.0, Pose(heard_s, 0.0, 0.0), heard_s)
    assert made.moment(0.0, 3.0) == made.moment(NOW, 3.0) == Moment(3.0, None)


@pytest.mark.parametrize('metres, radians, after_s, anew', [
    (0.02, 0.1, 0.04, False), (0.65, 1.0, 1.0, False), (0.15, 0.4, 0.0, False),
    (0.35, 0.0, 0.04, True), (5.0, 0.0, 60.0, True), (0.0, 1.5, 0.04, True),
    (0.6, 2.0, 60.0, False)])
def test_odometry_that_leaps_has_begun_anew(metres, radians, after_s, anew):
    """However long it was silent: a robot that nobody hears does not go far."""
    track = PoseTrack(0.65)
    assert not track.follow(Pose(3.0, 1.0, 3.1), 10.0)
    assert track.follow(Pose(3.0 + metres, 1.0, 3.1 + radians), 10.0 + after_s) == anew


def test_odometry_that_is_heard_late_has_not_leapt():
    track = PoseTrack(0.65)
    track.follow(Pose(0.0, 0.0, 0.0), 10.0, None, NOW)
    assert not track.follow(Pose(0.5, 0.0, 0.0), 10.04, None, NOW + 0.8)
    assert track.follow(Pose(1.0, 0.0, 0.0), 10.08, None, NOW + 0.84)


def test_odometry_from_another_publisher_has_begun_anew():
    track, one, other, here = PoseTrack(0.65), object(), object(), Pose(0.1, 0.0, 0.0)
    told = [track.follow(here, number * 0.1, source)
            for number, source in enumerate((one, one, other, other, one))]
    assert told == [False, False, True, False, False]
