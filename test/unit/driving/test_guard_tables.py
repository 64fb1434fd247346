# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The way back and the sight of the guard on the robot, as tables to the last digit."""
import math
from pathlib import Path

from play_guard import load
import pytest

from support.rotations import NONE, ROTATIONS

GUARD = load(str(Path(__file__).resolve().parents[3] / 'utils' / 'remote' / 'mhri_guard'))
ZERO, INF, NAN = GUARD['ZERO'], math.inf, math.nan
SOUTH = -0.5 * math.pi


class FreeSight:
    """Sees that everything is free, from where the robot is."""

    def __init__(self, pose=(0.0, 0.0, 0.0), fresh=True):
        self.place, self.is_fresh, self.asked = pose, fresh, []

    def pose(self, now):
        return self.place

    def fresh(self, now):
        return self.is_fresh

    def allow(self, velocity, now):
        self.asked.append(now)
        return velocity


def lost(trail, pose, fresh=True):
    """Return the way back of a robot that was heard at 0 s, drove a trail, and is at a pose now."""
    sight = FreeSight(pose, fresh)
    back = GUARD['WayBack'](sight, 10.0, 5.0, 0.1)
    back.hear(0.0)
    for place in trail:
        back.move(place + (0.0,))
    return back, sight


@pytest.mark.parametrize('trail, pose, velocity', [
    # Towards a place 1 m ahead: straight on, a bend, its limit, first a turn.
    ([(1.0, 0.0)], (0.0, 0.0, 0.0), (0.1, 0.0)), ([(1.0, 0.0)], (0.0, 0.0, 0.125), (0.1, -0.25)),
    ([(1.0, 0.0)], (0.0, 0.0, 0.25), (0.1, -0.4)), ([(1.0, 0.0)], (0.0, 0.0, 0.5), (0.1, -0.4)),
    ([(1.0, 0.0)], (0.0, 0.0, 0.51), (0.0, -0.4)), ([(1.0, 0.0)], (0.0, 0.0, -0.51), (0.0, 0.4)),
    ([(1.0, 0.0)], (0.0, 0.0, -3.5), (0.0, -0.4)), ([(1.0, 0.0)], (0.0, 0.0, 7.0), (0.0, -0.4)),
    # The last place is reached within 0.12 m; then comes the one before.
    ([(0.0, 0.0), (1.0, 0.0)], (1.0, 0.12, SOUTH), (0.1, 0.0)),
    ([(0.0, 0.0), (1.0, 0.0)], (1.0, 0.119, SOUTH), (0.0, -0.4)),
    ([(0.0, 5.0), (1.0, 0.0)], (1.0, 0.119, SOUTH), (0.0, -0.4)),
    ([(0.0, 0.0), (1.0, 0.0)], (0.0, 0.1, SOUTH), (0.0, 0.4)),
    ([(0.0, 0.0)], (0.1, 0.0, 0.0), None), ([], (0.0, 0.0, 0.0), None),
    # A place is noted 0.1 m behind the last one.
    ([(0.0, 0.0), (0.0, 0.1)], (0.5, 0.1, math.pi), (0.1, 0.0)),
    ([(3.0, 0.0), (3.0, 0.05)], (2.5, 0.0, 0.0), (0.1, 0.0)),
    ([(9.0, 0.0), (3.0, 0.0), (3.0, 0.05)], (2.5, 0.0, 0.0), (0.1, 0.0)),
    ([(0.0, 0.0), (0.0, 0.099)], (0.5, 0.0, math.pi), (0.1, 0.0)),
    ([(0.0, 0.0), (0.0, 0.099), (0.0, 0.101)], (0.5, 0.101, math.pi), (0.1, 0.0))])
def test_where_the_way_back_leads(trail, pose, velocity):
    back, _ = lost(trail, pose)
    found = back.velocity(10.0)
    assert found == (None if velocity is None else pytest.approx(velocity + (0.0,)))


@pytest.mark.parametrize('pose, fresh', [(None, True), ((0.0, 0.0, 0.0), False)])
def test_it_waits_where_it_does_not_see(pose, fresh):
    back, sight = lost([(1.0, 0.0)], pose, fresh)
    assert back.velocity(10.0) == ZERO and sight.asked == []
    sight.place, sight.is_fresh = (0.0, 0.0, 0.0), True
    assert back.velocity(11.0) == (0.1, 0.0, 0.0) and sight.asked == [11.0]


def test_when_it_begins_and_ends():
    """After 10 s, for 5 m, and no longer than 30 s and three times what these take."""
    back, sight = lost([(9.0, 0.0)], (0.0, 0.0, 0.0))
    assert [back.velocity(now) for now in (0.0, 9.99)] == [None, None]
    assert back.velocity(10.0) is not None
    back.move((4.0, 0.0, 0.0))  # back from 9 m: 5 m
    assert back.velocity(10.1) is None and back.velocity(10.2) is None
    back, sight = lost([(9.0, 0.0)], (0.0, 0.0, 0.0))
    back.velocity(10.0)
    back.move((9.0, 4.99, 0.0))
    assert back.velocity(190.0) is not None
    assert back.velocity(190.1) is None and back.velocity(190.2) is None


def test_heard_again_it_ends_and_the_next_time_all_of_the_way_is_left():
    back, sight = lost([(9.0, 0.0)], (0.0, 0.0, 0.0))
    back.velocity(10.0)
    back.move((6.0, 0.0, 0.0))
    back.hear(10.5)
    assert back.velocity(20.49) is None and back.velocity(20.5) is not None
    for _ in range(2):  # it stands there for a while
        back.move((6.0, 4.0, 0.0))
    assert back.velocity(20.6) is not None
    back.leave()
    assert back.velocity(99.0) is None and not back.misses(99.0)


@pytest.mark.parametrize('now, misses', [(0.5, False), (1.0, False), (1.01, True), (99.0, True)])
def test_somebody_is_missed_after_a_second(now, misses):
    back, _ = lost([], None)
    assert back.misses(now) == misses
    assert not GUARD['WayBack'](FreeSight(), 10.0).misses(now)


def seeing(*scan, pose=(0.0, 0.0, 0.0), now=0.0, **options):
    """Return a sight that has had odometry and a scan: ranges, first, step, least, most."""
    sight = GUARD['Sight'](0.2, **options)
    sight.move(pose, now)
    sight.see(*scan, now)
    return sight


@pytest.mark.parametrize('scan, counts', [
    (([1.0] * 8, 0.0, 0.75, 0.1, 10.0), True), (([1.0] * 8, 0.0, -0.75, 0.1, 10.0), True),
    (([], 0.0, 0.75, 0.1, 10.0), False), (([1.0] * 8, NAN, 0.75, 0.1, 10.0), False),
    (([1.0] * 8, 1e3, 0.75, 0.1, 10.0), False), (([1.0] * 8, 0.0, 0.0, 0.1, 10.0), False),
    (([1.0] * 8, 0.0, NAN, 0.1, 10.0), False), (([1.0] * 8, 0.0, 1e3, 0.1, 10.0), False),
    (([1.0] * 8, 0.0, 0.75, 0.1, NAN), True), (([1.0] * 8, 0.0, 0.75, NAN, INF), True),
    (([NAN] * 8, 0.0, 0.75, 0.1, 10.0), False), (([NAN] * 7 + [1.0], 0.0, 0.75, 0.1, 10.0), True)])
def test_which_scans_count(scan, counts):
    assert seeing(*scan).fresh(0.0) == counts


def test_how_long_a_scan_and_odometry_count():
    sight = GUARD['Sight'](0.2)
    sight.see([1.0] * 8, 0.0, 0.75, 0.1, 10.0, 0.0)
    assert sight.words(0.0) == 'brake:no_scan', 'without odometry it counts for nothing'
    sight = seeing([1.0] * 8, 0.0, 0.75, 0.1, 10.0)
    assert [sight.fresh(now) for now in (0.0, 0.3, 0.31)] == [True, True, False]
    assert [sight.pose(now) for now in (0.5, 0.51)] == [(0.0, 0.0, 0.0), None]


@pytest.mark.parametrize('sure, alive', [(3, True), (4, False)])
def test_a_laser_whose_beams_fell_from_a_third_to_none_is_dead(sure, alive):
    sight = seeing([1.0] * sure + [NAN] * (12 - sure), 0.0, 0.5, 0.1, 10.0,
                   no_return={None: (NAN, INF)})
    sight.move((0.0, 0.0, 0.0), 0.2)
    sight.see([NAN] * 12, 0.0, 0.5, 0.1, 10.0, 0.2)
    assert sight.fresh(0.4) == alive


@pytest.mark.parametrize('pose, leaps', [
    ((0.2, 0.0, 0.0), False), ((0.21, 0.0, 0.0), True), ((0.0, -0.21, 0.0), True),
    ((0.0, 0.0, 0.5), False), ((0.0, 0.0, -0.51), True), ((0.0, 0.0, 6.2), False)])
def test_odometry_leaps_at_one_time(pose, leaps):
    sight = seeing([1.0] * 8, 0.0, 0.75, 0.1, 10.0)
    sight.move(pose, 0.0)
    assert sight.fresh(0.0) is not leaps


def test_by_how_much_the_brake_has_to_change_what_is_held():
    sight = FreeSight()
    guard = GUARD['Guard']('run', brake=sight)
    guard.on_command('A:1:' + guard.echo_id(0.0).split(':')[2], (0.25, 0.0, 0.0), 0.0)
    for less_mps, given in ((0.009, None), (0.012, pytest.approx((0.238, 0.0, 0.0)))):
        sight.allow = lambda velocity, now: (velocity[0] - less_mps,) + velocity[1:]
        assert guard.tick(0.1) == given


def test_dropped_commands_are_counted():
    guard = GUARD['Guard']('run')
    token = guard.echo_id(0.0).split(':')[2]
    for frame_id in ('A:1:' + token, 'A:1:' + token, 'nonsense', 'A:2:' + token):
        guard.on_command(frame_id, ZERO, 0.1)
    assert guard.dropped == 2


def test_what_a_guard_says_that_does_nothing_by_itself():
    back = GUARD['WayBack'](FreeSight(), 10.0)
    assert [GUARD['Guard']('run', back=one).state(0.0) for one in (None, back)] == [
        '', 'back_after:10']


@pytest.mark.parametrize('x_m, now, goes', [
    (0.44, 0.2, True), (0.5, 0.2, False), (0.4, 10.0, True), (0.4, 10.1, False)])
@pytest.mark.parametrize('turned, heading', [
    (0.0, 0.0), (1.2, 0.0), (-1.2, 0.0), (0.0, 0.5 * math.pi)])
def test_ground_that_was_seen_counts_a_little_beyond_what_is_too_near(
        turned, heading, x_m, now, goes):
    """A laser that may be blind up to 0.45 m saw all ahead at 0; now it sees nothing near."""
    first = -0.5 - turned
    sight = seeing([INF] * 61, first, 1.0 / 61, 0.45, 10.0, no_return={None: (NAN, INF)},
                   mounts=((0.0, 0.0, turned),), pose=(4.0, -3.0, heading))
    sight.move((4.0 + x_m * math.cos(heading), -3.0 + x_m * math.sin(heading), heading), now)
    sight.see([5.0] + [NAN] * 60, first, 1.0 / 61, 0.45, 10.0, now)
    assert (sight.allow((0.06, 0.0, 0.0), now) != ZERO) == goes


@pytest.mark.parametrize('x_m, goes', [(0.2, True), (0.21, False)])
def test_ground_that_was_seen_counts_no_more_where_odometry_leaps(x_m, goes):
    angles = -0.5, 1.0 / 61
    sight = seeing([INF] * 61, *angles, 0.45, 10.0, no_return={None: (NAN, INF)})
    sight.move((x_m, 0.0, 0.0), 0.0)
    sight.see([5.0] + [NAN] * 60, *angles, 0.45, 10.0, 0.0)
    assert (sight.allow((0.06, 0.0, 0.0), 0.0) != ZERO) == goes


AROUND = [INF] * 359


def test_what_the_brake_says():
    sight = seeing([0.8] + AROUND, 0.0, math.pi / 180, 0.1, 10.0)
    assert sight.words(0.0) == 'brake:on'
    assert sight.allow((1.0, 0.0, 0.0), 0.0)[0] < 1.0 and sight.words(0.0) == 'brake:slows way:0.6'
    assert sight.allow((1.0, 0.0, 0.0), 0.125) < sight.allow((1.0, 0.0, 0.0), 0.0), 'by its age'
    sight.allow((1.0, 0.0, 0.0), 0.125)
    sight.see([0.8] + AROUND, 0.0, math.pi / 180, 0.1, 10.0, 0.25)
    assert sight.words(0.25) == 'brake:slows way:0.6' and sight.words(0.4375) == 'brake:on'
    assert sight.words(0.56) == 'brake:no_scan'
    sight = seeing([0.8] + AROUND, 0.0, math.pi / 180, 0.1, 10.0)
    sight.allow((1.0, 0.0, 0.0), 0.0)
    sight.see([INF] + AROUND, 0.0, math.pi / 180, 0.1, 10.0, 0.1)
    assert sight.words(0.1) == 'brake:slows', 'but there is nothing any more'
    sight = seeing([INF] + AROUND, 0.0, math.pi / 180, 0.1, 10.0)
    for velocity in (ZERO, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0)):
        assert sight.allow(velocity, 0.0) == velocity and sight.words(0.0) == 'brake:on'


@pytest.mark.parametrize('robot_m, brakes', [(0.0, True), (0.3, True), (-0.4, False)])
def test_it_brakes_for_what_is_there_at_a_speed_of_one(robot_m, brakes):
    """As at any other; what lies behind is no hindrance."""
    sight = seeing([1.3] + AROUND, 0.0, math.pi / 180, 0.1, 10.0)
    sight.move((robot_m, 0.0, 0.0), 0.1)
    wanted = (1.0 if robot_m >= 0.0 else -1.0, 0.0, 0.0)
    assert (sight.allow(wanted, 0.1) != wanted) == brakes


@pytest.mark.parametrize('turn, heading', ROTATIONS.values(), ids=ROTATIONS)
def test_a_rotation_has_the_heading_that_it_has_on_the_host(turn, heading):
    found = GUARD['heading_of'](*turn)
    assert math.remainder(found - heading, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize('turn', NONE.values(), ids=NONE)
def test_what_is_no_rotation_gives_the_guard_no_pose_to_go_by(turn):
    assert math.isnan(GUARD['heading_of'](*turn))
