# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake: tables, and random drives in a small world that end without contact."""
import math
import random

import numpy as np
import pytest

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.sensors.brake import (
    braked, BRAKES_MPS2, CRAWL_MPS, free_way, reach_of, Scan, stopping_speed, Surroundings)

from support.task_world import random_drive

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


def test_the_free_way_is_that_of_the_disc_in_small_steps():
    """Ahead, back, sideways and in a bend."""
    dice = random.Random(0)
    for _ in range(100):
        velocity = Velocity(dice.uniform(-0.5, 0.5), dice.choice((0.0, dice.uniform(-1.0, 1.0))),
                            dice.choice((0.0, dice.uniform(-0.5, 0.5))))
        points = np.array([(dice.uniform(-2.0, 2.0), dice.uniform(-2.0, 2.0)) for _ in range(4)])
        points = points[np.hypot(*points.T) > 0.25]
        ways = np.arange(0.0, 3.0, 0.002)
        turns = velocity.angular_rad_s * ways / velocity.speed_mps
        ways, turns = ways[abs(turns) < 2.5], turns[abs(turns) < 2.5]
        course = math.atan2(velocity.lateral_mps, velocity.linear_mps) + turns
        path = np.cumsum(0.002 * np.column_stack((np.cos(course), np.sin(course))), axis=0)
        met = (np.hypot(*(path[:, None] - points).T) < 0.2).any(axis=0)
        found = free_way(points, 0.2, velocity)
        if met.any():
            assert found == pytest.approx(ways[int(np.argmax(met))], abs=0.02)
        else:
            assert found > ways[-1] - 0.02


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
    ((0.05, 0.0), 0.1, (0.05, 0.0)),
    ((0.001, 0.3), 0.1, (0.001, 0.3)), ((0.0012, 0.0), 0.1, (0.0012, 0.0)),
    ((0.0009, 0.3), 0.1, (0.0, 0.3)),
    # 0.32 m are free; 0.2 s and the age of the scan go by before it brakes at 0.5 m/s^2.
    ((1.0, 0.0), 0.1, (math.sqrt(0.15 ** 2 + 0.32) - 0.15, 0.0)),
    ((1.0, 0.0), 0.3, (math.sqrt(0.25 ** 2 + 0.32) - 0.25, 0.0)),
    ((0.0, 0.3, 0.5), 0.1, (0.0, 0.3, 0.5)),
    ((0.0, 0.3, 0.5), 0.31, (0.0, 0.3, 0.0)),
    ((-0.5, 0.3, 0.1), None, (0.0, 0.3, 0.0))])
def test_what_is_allowed(wanted, age, allowed):
    found = braked(Velocity(*wanted), np.array([[0.6, 0.0]]), RADIUS_M, age)
    assert found == pytest.approx(Velocity(*allowed))


@pytest.mark.parametrize('degrees', [0, 45, 90, 135, 180, -90])
def test_whichever_way_it_goes_it_stands_before_what_is_there(degrees):
    """A quarter of the way round from what it meets, it is free."""
    turn = math.radians(degrees)
    met = np.array([[0.6 * math.cos(turn), 0.6 * math.sin(turn)]])
    one, other = (Velocity(0.6 * math.cos(turn + more), 0.0, 0.6 * math.sin(turn + more))
                  for more in (0.0, 0.5 * math.pi))
    held = braked(one, met, RADIUS_M, 0.1)
    assert held.speed_mps == pytest.approx(braked(
        Velocity(0.6), np.array([[0.6, 0.0]]), RADIUS_M, 0.1).linear_mps)
    assert held.linear_mps * one.lateral_mps == pytest.approx(held.lateral_mps * one.linear_mps)
    assert braked(other, met, RADIUS_M, 0.1) == other


def test_it_goes_sideways_only_where_its_laser_looks():
    """To the left it looks, to the right it does not; and there it does not crawl."""
    seen, here = Surroundings(RADIUS_M), Pose(0.0, 0.0, 0.0)
    seen.see(Scan(np.full(91, 9.0), 0.0, math.pi / 90, 0.1, 10.0), here)
    left, right = (braked(Velocity(0.0, 0.0, y), seen.around(here), RADIUS_M, 0.1,
                          seen.looks(here)) for y in (0.3, -0.3))
    assert left.lateral_mps == 0.3 and right.is_zero()


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


@pytest.mark.parametrize('pose', [Pose(0.0, 0.0, 0.0), Pose(3.0, -2.0, 0.75 * math.pi)])
@pytest.mark.parametrize('robots, kept', [
    ([], [0.6, 0.8]), ([(9.0, 9.0, 0.2)], [0.6, 0.8]), ([(0.6, 0.34, 0.2)], [0.8]),
    ([(0.6, 0.36, 0.2)], [0.6, 0.8]), ([(0.0, -0.8, 0.1), (0.6, 0.1, 0.1)], [])])
def test_where_a_robot_was_nothing_is_remembered(pose, robots, kept):
    """Something 0.6 m ahead and something 0.8 m to the right, at neither of which it looks now."""
    seen = Surroundings()
    seen.see(scan([0.6] + 269 * [math.nan] + [0.8] + 89 * [math.nan]), pose)
    seen.see(sector(20, 2.0, Pose(0.0, 0.0, math.pi)), pose)
    fresh = len(seen.around(pose)) - 2
    seen.forget(pose, robots)
    assert sorted(np.hypot(*seen.around(pose)[fresh:].T)) == pytest.approx(kept)
    assert fresh == 61


def test_what_the_newest_scan_met_stays_where_a_robot_was():
    seen, here = Surroundings(), Pose(0.0, 0.0, 0.0)
    seen.see(scan([0.6] + 359 * [math.nan]), here)
    seen.forget(here, [(0.6, 0.0, 0.3)])
    assert len(seen.around(here)) == 1


@pytest.mark.parametrize('there, kept', [
    ((0.0, -1.19), True), ((0.0, -1.21), False), ((1.19, 0.0), True), ((1.21, 0.0), False)])
def test_what_is_further_than_1_2_m_from_the_robot_is_forgotten(there, kept):
    """Where nothing looks; what is nearer to the laser that does not see it, too."""
    seen, here = Surroundings(), Pose(0.0, 0.0, math.atan2(there[1], there[0]))
    seen.see(scan([math.hypot(*there)] + [math.nan] * 359), here)
    for _ in range(3):
        seen.see(sector(20, mount=Pose(0.0, 0.0, math.pi)), here)
    assert len(seen.around(here)) == kept


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


@pytest.mark.parametrize('wanted, age, share', [
    ((0.5, 0.8), 0.1, 1.0), ((0.6, 1.0), 0.1, 0.75), ((1.0, 1.0), 0.0, 0.5),
    ((1.0, 1.0), 0.1, 0.25), ((0.6, 1.0), 0.3, 0.1), ((1.0, 1.0), 0.3, 0.0)])
def test_a_bend_out_of_sight_is_driven_more_slowly_the_older_the_scan(wanted, age, share):
    seen, here = Surroundings(), Pose(0.0, 0.0, 0.0)
    seen.see(sector(57), here)
    found = braked(Velocity(*wanted), seen.around(here), RADIUS_M, age, seen.looks(here))
    assert found.linear_mps == pytest.approx(share * wanted[0])


@pytest.mark.parametrize('degrees, all_round', [
    (360, True), (355, True), (353, False), (57, False), (0, False)])
def test_who_looks_all_round_is_not_asked_for_each_way(degrees, all_round):
    assert sector(degrees).all_round == all_round
    if all_round:
        angles = np.linspace(-math.pi, math.pi, 721)
        assert sector(degrees).faces(np.column_stack((np.cos(angles), np.sin(angles)))).all()
    assert not sector(degrees, looked=np.ones(61, dtype=bool)).all_round


@pytest.mark.parametrize('far_m, blind_m, faces, clears, looks', [
    (0.49, 0.0, True, True, False), (0.5, 0.0, True, True, False), (0.51, 0.0, True, True, True),
    (9.99, 0.0, True, True, True), (10.0, 0.0, True, True, False), (10.1, 0.0, False, False, False),
    (0.6, 0.6, True, True, True), (0.59, 0.6, False, False, False), (1.0, math.inf, 0, 0, 0)])
def test_up_to_where_a_scan_looks(far_m, blind_m, faces, clears, looks):
    """It measures from 0.45 to 10 m, and has met nothing."""
    scan = Scan(np.full(360, np.nan), 0.0, math.pi / 180, 0.45, 10.0,
                blind_m=np.full(360, blind_m))
    point = np.array([[far_m, 0.0]])
    assert (scan.faces(point)[0], scan.clears(point)[0], scan.looks_at(point)[0]) == (
        faces, clears, looks)
    assert scan.faces_past(point)[0] == (blind_m < math.inf) == scan.looks_anywhere


def test_a_place_is_clear_by_the_beam_that_goes_there():
    """Of 351 beams, a degree apart, the first met something at 1 m, the last one at 2 m."""
    scan = Scan(np.array([1.0] + 349 * [math.nan] + [2.0]), math.radians(-175), math.pi / 180,
                0.1, 10.0)
    points = [(far * math.cos(turn), far * math.sin(turn)) for far in (1.5, 2.5)
              for turn in np.radians((-175, 0, 175))]
    assert list(scan.clears(np.array(points))) == [False, True, True, False, True, False]
    whole = Scan(np.array([1.0] + 359 * [math.nan]), 0.0, math.pi / 180, 0.1, 10.0)
    assert list(whole.clears(np.array([(1.5, -0.01), (1.5, -0.02)]))) == [False, True]


@pytest.mark.parametrize('count, step', [(0, 0.1), (5, 0.0)])
def test_a_scan_without_beams_or_without_angles_looks_nowhere(count, step):
    scan = Scan(np.full(count, np.nan), 0.0, step, 0.1, 10.0)
    assert list(scan.faces(np.array([[1.0, 0.0]]))) == [False]


def test_ground_that_was_seen_or_stood_on_counts_a_little_beyond_what_is_too_near():
    """A laser that may be blind up to 0.45 m, at 0, then 0.5 m ahead, where it sees nothing."""
    def blind(up_to_m):
        return Scan(np.full(61, np.nan), -0.5, 1.0 / 61, 0.45, 10.0, near_m=0.45,
                    blind_m=np.full(61, up_to_m))
    seen, ahead = Surroundings(RADIUS_M), Pose(0.5, 0.0, 0.0)
    points = np.array([[x, 0.01] for x in (0.02, 0.1, 0.24, 0.26, 0.4, 0.46)])
    seen.see(blind(0.0), Pose(0.0, 0.0, 0.0))
    seen.see(blind(0.45), ahead, 0.1)
    assert list(seen.looks(ahead).sees(points)) == [True, True, True, False, False, True]
    seen.see(blind(0.45), ahead, 10.1)
    assert seen.looks(ahead).sees(points[:1])[0], 'after 10 s'
    seen.see(blind(0.45), ahead, 20.2)
    assert list(seen.looks(ahead).sees(points)) == [True, True, False, False, False, True]


def test_where_it_looked_turns_with_the_robot():
    seen = Surroundings()
    seen.see(sector(57), Pose(0.0, 0.0, 0.0))
    looks = seen.looks(Pose(0.0, 0.0, math.pi / 2))
    assert list(looks.sees(np.array([[1.0, 0.0], [0.0, -1.0]]))) == [False, True]


FRONT, REAR = Pose(0.2, 0.0, 0.0), Pose(-0.2, 0.0, math.pi)


def test_two_lasers_see_what_each_of_them_meets():
    seen, here = Surroundings(), Pose(1.0, 0.0, 0.3)
    seen.see(sector(180, 2.0, FRONT), here, 0.00, 'front')
    seen.see(sector(180, 3.0, REAR), here, 0.05, 'rear')
    ends = np.array([[1.0, 0.0], [-1.0, 0.0]])
    assert list(seen.looks(here).sees(ends)) == [True, True]
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
    assert list(seen.looks(here).sees(np.array([[1.0, 0.0], [-1.0, 0.0]]))) == [False, True]
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
