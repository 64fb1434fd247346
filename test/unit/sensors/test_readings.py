# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a beam says, driver by driver; and drives by the stick's brake with such lasers."""
import math

import numpy as np
import pytest

from mhri.base.brake_view import NO_SCAN, ON, UNSEEN
from mhri.base.geometry import Pose
from mhri.sensors.readings import no_return_of, read_ranges

from support.beam_world import (
    corridor, Drive, Kind, KINDS, RPLIDAR, TURTLEBOT2, TURTLEBOT3, wall_at)

NAN, INF = math.nan, math.inf
MEASURED, FREE, UNSURE, NOTHING = 'measured', 'free', 'unsure', 'nothing'
LDS = {3.5: (0.0, INF), 100.0: (0.0, NAN, INF)}


def classes(ranges, limits, no_return):
    """Return what each beam says, in a word."""
    found = read_ranges(ranges, *limits, no_return=no_return_of(no_return, limits[1]))
    assert not (np.isfinite(found.ranges) & (found.free | found.unsure)).any()
    return [MEASURED if np.isfinite(far) else FREE if free else UNSURE if unsure else NOTHING
            for far, free, unsure in zip(*found)]


@pytest.mark.parametrize('value, limits, no_return, said', [
    (1.0, (0.1, 3.5), {}, MEASURED), (0.1, (0.1, 3.5), {}, MEASURED),
    (INF, (0.1, 3.5), {}, FREE), (-INF, (0.1, 3.5), {}, NOTHING), (NAN, (0.1, 3.5), {}, NOTHING),
    (0.0, (0.1, 3.5), {}, NOTHING), (0.0, (0.0, 3.5), {}, NOTHING), (-1.0, (0.1, 3.5), {}, NOTHING),
    (0.05, (0.1, 3.5), {}, NOTHING), (3.5, (0.1, 3.5), {}, FREE), (3.6, (0.1, 3.5), {}, NOTHING),
    (0.0, (0.0, 0.0), {}, NOTHING), (1.0, (0.0, 0.0), {}, NOTHING), (1.0, (9.0, 3.5), {}, NOTHING),
    (1.0, (NAN, NAN), {}, MEASURED), (9000.0, (-1e31, INF), {}, MEASURED),
    (1e30, (-1e31, 1e31), {}, NOTHING), (-1e30, (-1e31, 1e31), {}, NOTHING),
    # A TurtleBot3 with an LDS-01, simulated with inf, and with an LDS-02.
    (0.0, (0.12, 3.5), LDS, UNSURE), (INF, (0.12, 3.5), LDS, FREE),
    (NAN, (0.12, 3.5), LDS, NOTHING),
    (NAN, (0.0, 100.0), LDS, UNSURE), (0.0, (0.0, 100.0), LDS, UNSURE),
    (INF, (0.0, 100.0), LDS, FREE),
    (0.0, (0.02, 12.0), LDS, NOTHING), (INF, (0.02, 12.0), LDS, FREE),
    # A driver with a number of its own; it comes as a float32.
    (float(np.float32(5.6)), (0.1, 5.0), {None: (5.6,)}, UNSURE),
    (INF, (0.1, 5.0), {None: (0.0,)}, NOTHING)])
def test_what_a_beam_says(value, limits, no_return, said):
    assert classes([value, value], limits, no_return) == [said, said]


BLIND = {'all NaN': NAN, 'all 0.0': 0.0, 'all -inf': -INF, 'negative': -1.0, 'below': 0.01,
         'above': 1e6}
SPEAKS = [(kind, what) for kind in KINDS for what in sorted(BLIND)
          if not (kind == 'Stage' and what == 'below')]


@pytest.mark.parametrize('kind, what', SPEAKS)
def test_a_laser_that_measures_nothing_shows_no_way(kind, what):
    drive = Drive(KINDS[kind], wall_at(0.8))
    drive.sends = lambda ranges: np.full(len(ranges), BLIND[what])
    assert drive.go(1.0) == 0.0 and drive.says() == NO_SCAN
    assert -0.25 < drive.go(2.0, -0.3) < -0.1, 'a crawl back'
    drive.brake.ask(False)
    assert drive.go(1.0) > 0.05, 'with the brake off it drives'


@pytest.mark.parametrize('kind', sorted(KINDS))
def test_a_least_range_above_everything_shows_no_way(kind):
    one = KINDS[kind]
    drive = Drive(Kind(one.radius_m, one.x_m, (99.0, 100.0), one.no_return, one.nothing, one.near,
                       reach_m=100.0), wall_at(0.8))
    drive.laser.range_min_m = 0.0
    assert drive.go(3.0) == 0.0


@pytest.mark.parametrize('kind, what', SPEAKS)
def test_a_good_laser_that_turns_into_one_stops_the_robot(kind, what):
    drive = Drive(KINDS[kind], [*wall_at(2.4), *corridor(4.0)])
    drive.go(1.5)
    assert drive.fastest_mps > 0.2 and drive.says() == ON
    drive.sends = lambda ranges: np.full(len(ranges), BLIND[what])
    drive.go(2.0)
    assert drive.gap_m() > 0.5 and drive.speed_mps == 0.0
    drive.sends = lambda ranges: ranges
    drive.go(0.5)
    assert drive.fastest_mps > 0.2, 'it measures again'


@pytest.mark.parametrize('kind', ['TurtleBot3', 'TurtleBot2'])
@pytest.mark.parametrize('brake_is_off', [True, False])
def test_a_laser_that_was_not_heard_for_a_while_has_to_measure_anew(kind, brake_is_off):
    """It dies meanwhile: what it sends then may as well mean an empty hall."""
    drive = Drive(KINDS[kind], [*wall_at(6.0), *corridor(9.0, 1.6)])
    drive.go(1.5)
    assert drive.says() == ON
    drive.brake.ask(not brake_is_off)
    drive.every = 10 ** 9
    assert (drive.go(2.0) > 0.5) == brake_is_off
    drive.brake.ask(True)
    drive.every = 2
    drive.sends = lambda ranges: np.full(len(ranges), KINDS[kind].nothing)
    drive.go(2.0)
    assert drive.speed_mps == 0.0 and drive.says() == NO_SCAN
    drive.sends = lambda ranges: ranges
    drive.go(1.0)
    assert drive.fastest_mps > 0.2


@pytest.mark.parametrize('kind, side', list(zip(sorted(KINDS), (-1, 1, -1, 1))))
def test_a_laser_that_is_covered_on_one_side_stops_the_robot_before_what_it_hides(kind, side):
    """From the start, and while it drives at a pole before that shoulder."""
    drive = Drive(KINDS[kind], corridor(8.0, 2.6), discs=[(2.0, 0.12 * side, 0.03)])

    def cover(ranges):
        angles = (np.arange(len(ranges)) - len(ranges) // 2) * drive.laser.increment_rad
        return np.where(side * angles > math.radians(3.0), -INF, ranges)

    drive.sends = cover
    assert drive.go(2.0) == 0.0 and drive.says() == UNSEEN
    drive.sends = lambda ranges: ranges
    drive.go(1.0)
    assert drive.fastest_mps > 0.2
    drive.sends = cover
    drive.go(6.0)
    assert drive.speed_mps == 0.0 and drive.closest_m > 0.05


@pytest.mark.parametrize('kind', ['TurtleBot3', 'TurtleBot2'])
@pytest.mark.parametrize('width', [1.6, 2.6])
def test_a_corridor_and_an_empty_hall_are_driven_at_full_speed(kind, width):
    drive = Drive(KINDS[kind], corridor(10.0, width))
    drive.go(2.0)
    speed = KINDS[kind].speed_mps
    drive.every = 4
    for _ in range(int(13.0 / speed / 2.0)):
        drive.go(2.0)
        assert drive.speed_mps == pytest.approx(speed), drive.pose
    assert drive.pose.x_m > 12.0


@pytest.mark.parametrize('kind', ['RPLidar', 'Stage'])
def test_a_laser_that_says_so_surely_starts_in_the_open(kind):
    drive = Drive(KINDS[kind], wall_at(90.0))
    assert drive.go(2.0) > 0.5 and drive.says() == ON


@pytest.mark.parametrize('kind', sorted(KINDS))
def test_no_wall_is_touched_that_was_seen(kind):
    drive = Drive(KINDS[kind], wall_at(3.0))
    drive.go(16.0)
    assert 0.0 < drive.gap_m() < 0.3
    drive.go(3.0, 0.0, 0.5)
    drive.go(3.0)
    drive.go(3.0, 0.0, -0.5)
    drive.go(5.0)
    assert drive.closest_m > 0.0


def test_a_camera_turns_away_from_a_wall_and_drives():
    drive = Drive(TURTLEBOT2, wall_at(1.6))
    drive.go(2.5, 0.3)
    drive.go(4.5, 0.0, 0.7)
    assert abs(drive.pose.heading_rad) > 3.0
    assert drive.go(1.0) > 0.3 and drive.says() == ON, 'it has come that way'
    assert drive.closest_m > 0.0


def test_a_laser_that_is_covered_little_by_little_is_a_hall():
    """What stays open: nobody can tell the one from the other."""
    drive = Drive(TURTLEBOT3, corridor(30.0))
    drive.go(1.0)
    for kept in range(360, -1, -20):
        drive.sends = lambda ranges, kept=kept: np.where(
            np.arange(len(ranges)) < kept, ranges, 0.0)
        drive.go(0.2)
    assert drive.speed_mps > 0.2


@pytest.mark.parametrize('beams', [1, 2])
def test_a_few_beams_that_were_lost_hide_nothing(beams):
    drive = Drive(RPLIDAR, wall_at(9.0))
    drive.sends = lambda ranges: np.where(
        np.abs(np.arange(len(ranges)) - len(ranges) // 2) < beams, NAN, ranges)
    assert drive.go(1.0) > 0.2


def test_a_gap_as_wide_as_the_robot_is_no_way():
    drive = Drive(RPLIDAR, wall_at(9.0))
    drive.sends = lambda ranges: np.where(
        np.abs(np.arange(len(ranges)) - len(ranges) // 2) < 15, NAN, ranges)
    assert drive.go(1.0) == 0.0 and drive.says() == UNSEEN


# How the one who stands before a wall comes to have a brake that saw nothing of it.
def test_it_stands_before_a_wall_that_is_too_near_to_be_seen():
    for turned in (0.0, 0.3, 0.6, 0.9):
        drive = Drive(TURTLEBOT2, wall_at(1.5), Pose(1.5 - 0.28, 0.0, turned))
        assert drive.gap_m() < 0.11
        drive.go(2.0)
        assert drive.closest_m > 0.0, turned
        assert drive.go(3.0, -0.3) < -0.2
        drive.go(3.0)
        assert drive.closest_m > 0.0, turned


@pytest.mark.parametrize('turned', (-2.5, -0.4, 0.5, 1.3))
def test_it_turns_before_a_wall_after_a_start_and_touches_nothing(turned):
    drive = Drive(TURTLEBOT2, wall_at(1.5), Pose(1.5 - 0.28, 0.0, turned))
    for _ in range(6):
        drive.go(1.0, 0.0, 0.8)
        drive.go(1.5, 0.3)
    assert drive.closest_m > 0.0


def test_switched_off_and_on_it_remembers_what_it_saw():
    drive = Drive(TURTLEBOT2, wall_at(2.0))
    drive.go(12.0, 0.3)
    gap_m = drive.gap_m()
    assert gap_m < 0.2
    drive.brake.ask(False)
    drive.go(1.0, 0.0)
    drive.brake.ask(True)
    drive.go(5.0)
    assert drive.closest_m > 0.0


def test_odometry_that_jumps_ends_what_was_remembered():
    drive = Drive(TURTLEBOT2, wall_at(2.0))
    drive.go(12.0, 0.3)
    drive.brake.move(drive.pose, anew=True)
    assert drive.go(3.0) < 0.01 and drive.closest_m > 0.0
