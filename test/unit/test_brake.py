# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake: tables, and random drives in a small world that end without contact."""
import math
from pathlib import Path
import sys

import numpy as np
import pytest

from mhri.base.limits import Velocity
from mhri.base.mocap import Pose
from mhri.sensors.brake import (
    braked, BRAKES_MPS2, CRAWL_MPS, free_way, reach_of, Scan, stopping_speed, Surroundings)

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from support.task_world import random_drive  # noqa: E402

RADIUS_M = 0.2
AHEAD, ASIDE, BEHIND = (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)


@pytest.mark.parametrize('points, velocity, way', [
    ([], (0.5, 0.0), math.inf),
    ([AHEAD], (0.5, 0.0), 0.8),
    ([AHEAD], (0.0, 1.0), math.inf),
    ([AHEAD], (-0.5, 0.0), math.inf),
    ([BEHIND], (-0.5, 0.0), 0.8),
    ([ASIDE], (0.5, 0.0), math.inf),
    ([(1.0, 0.19)], (0.5, 0.0), 1.0 - math.sqrt(0.2 ** 2 - 0.19 ** 2)),
    ([(1.0, 0.21)], (0.5, 0.0), math.inf),
    ([(0.1, 0.0)], (0.5, 0.0), 0.0),
    ([(-0.1, 0.0)], (0.5, 0.0), math.inf),
    # A left turn of 1 m radius meets what is a quarter of it away, and not what is ahead.
    ([(1.0, 1.0)], (0.5, 0.5), math.pi / 2 - 2 * math.asin(0.1)),
    ([(1.0, -1.0)], (0.5, 0.5), math.inf),
    ([(1.0, -1.0)], (0.5, -0.5), math.pi / 2 - 2 * math.asin(0.1)),
    ([(-1.0, 1.0)], (-0.5, -0.5), math.pi / 2 - 2 * math.asin(0.1)),
    ([(2.0, 0.0), AHEAD], (0.5, 0.0), 0.8)])
def test_the_free_way_of_a_disc(points, velocity, way):
    found = free_way(np.array(points, dtype=float).reshape(-1, 2), 0.2, Velocity(*velocity))
    assert found == pytest.approx(way, abs=1e-6)


@pytest.mark.parametrize('way', [0.0, 0.01, 0.1, 0.5, 2.0])
@pytest.mark.parametrize('delay', [0.0, 0.2, 0.5])
def test_the_speed_is_lost_within_the_way(way, delay):
    speed = stopping_speed(way, delay)
    assert speed * delay + speed ** 2 / (2 * BRAKES_MPS2) == pytest.approx(way, abs=1e-9)


@pytest.mark.parametrize('wanted, age, allowed', [
    ((0.5, 0.3), None, (0.0, 0.3)),
    ((0.5, 0.3), 0.31, (0.0, 0.3)),
    ((-0.5, 0.3), 0.31, (-CRAWL_MPS, 0.3)),
    ((-0.5, 0.0), 0.1, (-0.5, 0.0)),
    ((0.0, 1.0), 0.1, (0.0, 1.0)),
    ((0.05, 0.0), 0.1, (0.05, 0.0))])
def test_what_is_allowed(wanted, age, allowed):
    found = braked(Velocity(*wanted), np.array([[0.6, 0.0]]), RADIUS_M, age)
    assert (found.linear_mps, found.angular_rad_s) == pytest.approx(allowed)


def test_the_speed_falls_with_the_distance_to_zero_before_contact():
    speeds = [braked(Velocity(1.0, 0.0), np.array([[x, 0.0]]), RADIUS_M, 0.1).linear_mps
              for x in np.arange(0.2, 3.0, 0.05)]
    assert speeds == sorted(speeds)
    assert speeds[0] == 0.0 and speeds[1] == 0.0 and speeds[-1] == 1.0


def scan(ranges, range_min=0.45):
    """Return a scan of a full turn."""
    return Scan(np.array(ranges, dtype=float), 0.0, 2 * math.pi / len(ranges), range_min, 10.0)


def test_what_came_too_near_to_be_seen_is_remembered_until_it_is_looked_at_again():
    seen, nothing = Surroundings(), [math.nan] * 360
    seen.see(scan([0.6] + nothing[1:]), Pose(0.0, 0.0, 0.0))
    near = Pose(0.3, 0.0, 0.0)
    seen.see(scan(nothing), near)
    assert seen.around(near)[0] == pytest.approx((0.3, 0.0), abs=0.03)
    seen.see(scan(nothing), near)
    assert len(seen.around(near)) == 1
    # Turned on the spot it is still there, on the other side; from further off it is gone.
    turned = Pose(0.3, 0.0, math.pi)
    seen.see(scan(nothing), turned)
    assert seen.around(turned)[0] == pytest.approx((-0.3, 0.0), abs=0.05)
    seen.see(scan(nothing), Pose(-0.1, 0.0, 0.0))
    assert len(seen.around(near)) == 0


def sector(degrees, met=math.nan, mount=Pose(0.0, 0.0, 0.0), looked=None):
    """Return a scan of a sector around straight ahead, in which everything is as far."""
    half = math.radians(degrees) / 2
    return Scan(np.full(61, met), -half, 2 * half / 61, 0.1, 10.0, mount,
                None if looked is None else np.where(looked, 0.0, np.inf))


@pytest.mark.parametrize('degrees, wanted, allowed', [
    (360, (-0.5, 0.0), -0.5), (358, (-0.5, 0.0), -0.5), (180, (-0.5, 0.0), -CRAWL_MPS),
    (180, (-0.5, 3.0), -CRAWL_MPS), (180, (-0.06, 0.0), -0.06), (57, (0.5, 0.0), 0.5),
    (57, (0.3, 0.3), 0.3), (180, (0.3, 1.0), 0.3), (57, (0.3, 3.0), 0.0), (57, (0.0, 3.0), 0.0)])
def test_who_does_not_see_a_way_crawls_back_and_does_not_go_ahead(degrees, wanted, allowed):
    seen, here = Surroundings(), Pose(2.0, 1.0, 0.5)
    seen.see(sector(degrees), here)
    found = braked(Velocity(*wanted), seen.around(here), RADIUS_M, 0.1, seen.looks(here))
    assert (found.linear_mps, found.angular_rad_s) == pytest.approx((allowed, wanted[1]))


def test_a_bend_out_of_sight_is_driven_more_slowly():
    seen, here = Surroundings(), Pose(0.0, 0.0, 0.0)
    seen.see(sector(57), here)
    found = braked(Velocity(0.6, 1.0), seen.around(here), RADIUS_M, 0.1, seen.looks(here))
    assert 0.0 < found.linear_mps < 0.6


@pytest.mark.parametrize('degrees, all_round', [
    (360, True), (355, True), (353, False), (57, False), (0, False)])
def test_who_looks_all_round_is_not_asked_for_each_way(degrees, all_round):
    assert sector(degrees).all_round == all_round
    if all_round:
        angles = np.linspace(-math.pi, math.pi, 721)
        assert sector(degrees).faces(np.column_stack((np.cos(angles), np.sin(angles)))).all()
    assert not sector(degrees, looked=np.ones(61, dtype=bool)).all_round


def test_where_it_looked_turns_with_the_robot():
    seen = Surroundings()
    seen.see(sector(57), Pose(0.0, 0.0, 0.0))
    looks = seen.looks(Pose(0.0, 0.0, math.pi / 2))
    assert list(looks(np.array([[1.0, 0.0], [0.0, -1.0]]))) == [False, True]


FRONT, REAR = Pose(0.2, 0.0, 0.0), Pose(-0.2, 0.0, math.pi)


def test_two_lasers_see_what_each_of_them_meets():
    seen, here = Surroundings(), Pose(1.0, 0.0, 0.3)
    seen.see(sector(180, 2.0, FRONT), here, 0.00, 'front')
    seen.see(sector(180, 3.0, REAR), here, 0.05, 'rear')
    ends = np.array([[1.0, 0.0], [-1.0, 0.0]])
    assert list(seen.looks(here)(ends)) == [True, True]
    met = seen.around(here)
    assert met[:, 0].max() == pytest.approx(2.2, abs=0.01)
    assert met[:, 0].min() == pytest.approx(-3.2, abs=0.01)
    for at_s in (0.1, 0.2, 0.25):
        seen.see(sector(180, 2.0, FRONT), here, at_s, 'front')
    assert len(seen.around(here)) == len(met)


def test_of_two_lasers_one_that_falls_silent_looks_no_more():
    seen, here = Surroundings(), Pose(0.0, 0.0, 0.0)
    seen.see(sector(180, 0.8, FRONT), here, 0.0, 'front')
    for at_s in (0.1, 0.2, 0.31, 0.4):
        seen.see(sector(180, 3.0, REAR), here, at_s, 'rear')
    assert list(seen.looks(here)(np.array([[1.0, 0.0], [-1.0, 0.0]]))) == [False, True]
    # What it met near by is remembered.
    ahead = braked(Velocity(0.3, 0.0), seen.around(here), RADIUS_M, 0.1, seen.looks(here))
    assert ahead.linear_mps == 0.0
    assert (seen.around(here)[:, 0] > 0.9).any()


def test_beams_that_measured_nothing_do_not_look():
    looked = np.arange(61) < 20
    scan = sector(60, looked=looked)
    assert list(scan.faces(np.array([[1.0, -0.4], [1.0, 0.0], [1.0, 0.4]]))) == [True, False, False]


@pytest.mark.parametrize('mount, met', [
    (Pose(-0.064, 0.0, 0.0), (0.436, 0.0)), (Pose(0.1, 0.05, math.pi), (-0.4, 0.05)),
    (Pose(0.0, 0.2, math.pi / 2), (0.0, 0.7))])
def test_a_scan_is_taken_from_where_the_laser_sits(mount, met):
    scan = Scan(np.array([0.5] + [math.nan] * 359), 0.0, 2 * math.pi / 360, 0.1, 10.0, mount)
    assert scan.points()[0] == pytest.approx(met)
    seen = Surroundings()
    seen.see(scan, Pose(0.0, 0.0, 0.0))
    # Looked at again from where it sits, it is gone.
    seen.see(Scan(np.full(360, np.nan), 0.0, scan.step, 0.1, 10.0, mount), Pose(0.0, 0.0, 0.0))
    assert len(seen.around(Pose(0.0, 0.0, 0.0))) == 0


@pytest.mark.parametrize('seed', range(5))
def test_random_drives_end_without_contact(seed):
    assert random_drive(seed, 15.0, True).contacts == 0


def test_the_same_drives_without_the_brake_meet_something():
    assert any(random_drive(seed, 15.0, False).contacts for seed in range(5))


@pytest.mark.parametrize('seed', range(20))
def test_what_is_left_out_for_being_too_far_changes_nothing(seed):
    chance, seen, left_out = np.random.RandomState(seed), Surroundings(), 0
    for _ in range(50):
        there = Pose(*chance.uniform(-1.0, 1.0, 2), chance.uniform(-math.pi, math.pi))
        ranges = np.where(chance.rand(90) < 0.5, math.nan, chance.uniform(0.2, 3.0, 90))
        seen.see(Scan(ranges * chance.choice((1.0, 3.0)), -math.pi, math.radians(4.0), 0.1, 10.0),
                 there)
        here = Pose(there.x_m + chance.uniform(-0.3, 0.3), there.y_m + chance.uniform(-0.3, 0.3),
                    chance.uniform(-math.pi, math.pi))
        wanted, age_s = Velocity(*chance.uniform(-0.7, 0.7, 2)), chance.uniform(0.0, 0.3)
        looks = seen.looks(here)
        near = seen.around(here, reach_of(wanted.linear_mps, RADIUS_M, age_s))
        left_out += not len(near)
        assert braked(wanted, near, RADIUS_M, age_s, looks) == braked(
            wanted, seen.around(here), RADIUS_M, age_s, looks)
    assert left_out
