# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The brake for the stick: what it allows and says, and what a robot's rule makes of it."""
from dataclasses import replace
import math

import numpy as np
import pytest

from mhri.base.brake_view import CANNOT, NO_PLACE, NO_SCAN, OFF, ON, SLOWS, UNSEEN
from mhri.base.limits import Velocity, ZERO
from mhri.base.geometry import Pose
from mhri.base.robot_types import Limits
from mhri.driving.robot_rule import CLOSED, RobotRule, TASK
from mhri.driving.stick_brake import StickBrake
from mhri.sensors.brake import braked, CRAWL_MPS, Scan

RADIUS_M = 0.2
FAST = Velocity(0.5, 0.2)


def ahead(way_m):
    """Return a scan that meets something ahead, at that way from the middle of the robot."""
    return Scan(np.array([way_m] + [math.nan] * 359), 0.0, 2 * math.pi / 360, 0.12, 10.0)


@pytest.fixture
def brake():
    """Return one that is asked for and has been moved nowhere."""
    made = StickBrake(RADIUS_M, True)
    made.ask(True)
    made.move(Pose(0.0, 0.0, 0.0))
    return made


def test_it_does_nothing_unless_it_is_asked_for(brake):
    assert brake.asked and brake.reads and brake.remembers
    brake = StickBrake(RADIUS_M, True)
    assert not brake.asked and not brake.remembers
    assert brake.allow(FAST, 0.0) == FAST and brake.state(0.0)[0] == OFF and not brake.reads


def test_asked_for_again_it_keeps_its_scan(brake):
    brake.see(ahead(9.0), 1.0)
    brake.ask(True)
    assert brake.allow(FAST, 1.0) == FAST


def test_where_odometry_has_jumped_a_new_scan_is_required(brake):
    brake.see(ahead(9.0), 1.0)
    brake.move(Pose(0.1, 0.0, 0.0))
    assert brake.allow(FAST, 1.0) == FAST
    brake.move(Pose(5.0, 0.0, 0.0), anew=True)
    assert brake.allow(FAST, 1.0) == Velocity(0.0, 0.2)


def test_a_type_without_a_laser_drives_as_ever_and_says_so():
    brake = StickBrake(RADIUS_M, False)
    brake.ask(True)
    assert brake.allow(FAST, 0.0) == FAST and brake.state(0.0)[0] == CANNOT and not brake.reads


@pytest.mark.parametrize('age', [None, 0.31, 60.0])
def test_without_a_fresh_scan_there_is_no_way_forward(brake, age):
    if age is not None:
        brake.see(ahead(9.0), 1.0 - age)
    assert brake.allow(FAST, 1.0) == Velocity(0.0, 0.2)
    assert brake.allow(Velocity(-0.5, 0.0), 1.0) == Velocity(-CRAWL_MPS, 0.0)
    assert brake.allow(Velocity(0.0, 1.0), 1.0) == Velocity(0.0, 1.0)
    assert brake.state(1.0)[0] == NO_SCAN


def test_without_a_fresh_scan_it_does_not_crawl_into_what_was_met_behind(brake):
    behind = replace(ahead(RADIUS_M + 0.05), mount=Pose(0.0, 0.0, math.pi))
    brake.see(behind, 1.0)
    for now in (1.1, 2.0, 60.0):
        assert brake.allow(Velocity(-0.5, 0.0), now) == ZERO
    assert brake.state(60.0)[0] == NO_SCAN
    brake.move(Pose(0.0, 0.0, 0.0), anew=True)
    assert brake.allow(Velocity(-0.5, 0.0), 60.0) == Velocity(-CRAWL_MPS, 0.0)


def test_it_slows_down_as_the_rule_says_and_tells_the_way(brake):
    brake.see(ahead(0.6), 0.9)
    assert brake.allow(FAST, 1.0) == braked(FAST, np.array([[0.6, 0.0]]), RADIUS_M, 0.1)
    word, way_m = brake.state(1.0)
    assert word == SLOWS and way_m == pytest.approx(0.4, abs=0.03)
    assert brake.allow(Velocity(-0.5, 0.0), 1.0) == Velocity(-0.5, 0.0)
    assert brake.state(1.0)[0] == ON


@pytest.mark.parametrize('way_m', [RADIUS_M, RADIUS_M + 0.05])
def test_who_stands_before_a_wall_can_turn(brake, way_m):
    brake.see(ahead(way_m), 1.0)
    assert brake.allow(FAST, 1.0) == Velocity(0.0, 0.2)
    assert brake.allow(Velocity(0.0, 1.0), 1.0) == Velocity(0.0, 1.0)
    assert brake.allow(Velocity(-0.5, 0.0), 1.0) == Velocity(-0.5, 0.0)


def test_what_nothing_looks_at_is_backed_into_at_a_crawl_and_said(brake):
    brake.see(Scan(np.full(181, np.nan), -math.pi / 2, math.pi / 180, 0.12, 10.0), 1.0)
    assert brake.allow(Velocity(-0.5, 0.0), 1.0) == Velocity(-CRAWL_MPS, 0.0)
    assert brake.state(1.0)[0] == UNSEEN and math.isnan(brake.state(1.0)[1])
    assert brake.allow(FAST, 1.0) == FAST and brake.state(1.0)[0] == ON


def test_where_a_laser_looks_nobody_knows_where_it_does_not_even_crawl(brake):
    back = Velocity(-0.5, 0.0)
    brake.on_unplaced_scan('rear', 1.0)
    assert brake.allow(back, 1.0) == brake.allow(Velocity(0.5, 0.0), 1.0) == ZERO
    assert brake.allow(Velocity(0.0, 1.0), 1.0) == Velocity(0.0, 1.0)
    assert brake.state(1.0)[0] == NO_PLACE
    half = Scan(np.full(181, np.nan), -math.pi / 2, math.pi / 180, 0.12, 10.0)
    brake.see(half, 1.0, laser='front')
    assert brake.allow(back, 1.0) == ZERO and brake.state(1.0)[0] == NO_PLACE
    assert brake.allow(FAST, 1.0) == FAST and brake.state(1.0)[0] == NO_PLACE
    brake.see(replace(half, mount=Pose(0.0, 0.0, math.pi)), 1.1, laser='rear')
    assert brake.allow(back, 1.1) == back and brake.state(1.1)[0] == ON


def test_a_laser_without_a_place_that_has_fallen_silent_is_no_laser(brake):
    brake.on_unplaced_scan('rear', 1.0)
    assert brake.allow(Velocity(-0.5, 0.0), 1.4) == Velocity(-CRAWL_MPS, 0.0)
    assert brake.state(1.4)[0] == NO_SCAN


def test_nothing_is_said_to_slow_what_nobody_drives(brake):
    brake.see(ahead(0.6), 1.0)
    brake.allow(FAST, 1.0)
    brake.see(ahead(0.6), 1.25)
    assert brake.state(1.25)[0] == SLOWS
    brake.see(ahead(0.6), 1.4)
    assert brake.state(1.4)[0] == ON


def test_the_newest_of_its_scans_counts(brake):
    brake.see(ahead(9.0), 1.0, laser='front')
    brake.see(ahead(9.0), 0.8, laser='rear')
    assert brake.allow(FAST, 1.25) == FAST


def test_from_where_on_it_is_said_to_slow_down(brake):
    brake.see(ahead(0.6), 1.0)
    most = brake.allow(Velocity(1.0), 1.0).linear_mps
    for more, word in ((0.004, ON), (0.006, SLOWS)):
        brake.allow(Velocity(most + more), 1.0)
        assert brake.state(1.0)[0] == word


def test_a_brake_that_nobody_has_asked_yet_says_that_it_is_on(brake):
    brake.see(ahead(0.6), 1.0)
    assert brake.state(1.0)[0] == ON


def test_the_way_it_has_driven_since_the_scan_counts(brake):
    brake.see(ahead(1.0), 1.0)
    first = brake.allow(FAST, 1.0)
    brake.move(Pose(0.5, 0.0, 0.0))
    assert brake.allow(FAST, 1.0).linear_mps < first.linear_mps


def test_without_odometry_nothing_is_remembered():
    brake = StickBrake(RADIUS_M, True)
    brake.ask(True)
    # So near that the next scan does not look there.
    brake.see(ahead(0.15), 1.0)
    assert brake.allow(FAST, 1.0).linear_mps < FAST.linear_mps
    brake.see(ahead(9.0), 1.1)
    assert brake.allow(FAST, 1.1) == FAST


def test_with_odometry_what_came_too_near_is_remembered(brake):
    brake.see(ahead(0.15), 1.0)
    brake.see(ahead(9.0), 1.1)
    assert brake.allow(FAST, 1.1).linear_mps == 0.0


def test_where_the_heading_is_lost_a_new_scan_is_required_once_and_nothing_is_remembered(brake):
    """What is remembered would move along with a robot that nobody knows the pose of."""
    brake.see(ahead(0.15), 1.0)
    brake.see(ahead(9.0), 1.1)
    brake.move(None)
    assert brake.allow(FAST, 1.1).linear_mps == 0.0 and brake.state(1.1)[0] == NO_SCAN
    brake.see(ahead(9.0), 1.2)
    brake.move(None)
    assert brake.allow(FAST, 1.2) == FAST, 'as without odometry'
    brake.move(Pose(0.0, 0.0, 0.0))
    assert brake.allow(FAST, 1.2).linear_mps == 0.0, 'that scan was made nobody knows where'


def test_what_was_seen_before_it_was_switched_off_is_not_trusted_after(brake):
    brake.see(ahead(9.0), 1.0)
    brake.ask(False)
    brake.ask(True)
    assert brake.allow(FAST, 1.0).linear_mps == 0.0


@pytest.fixture
def robot():
    """Return (rule of a selected robot, [share of each command that its brake leaves])."""
    share = [1.0]
    rule = RobotRule(Limits(1.0, 1.0), ZERO,
                     lambda velocity, _: Velocity(share[0] * velocity.linear_mps,
                                                  velocity.angular_rad_s))
    rule.select(True, 0.0)
    rule.on_command(ZERO, 0.0)
    return rule, share


def test_a_held_stick_is_braked_anew_and_only_a_command_makes_it_faster(robot):
    rule, share = robot
    assert rule.on_command(FAST, 1.0) == FAST
    assert rule.tick(1.05) is None
    share[0] = 0.5
    assert rule.tick(1.1) == Velocity(0.25, 0.2) == rule.sent
    assert rule.tick(1.15) is None
    share[0] = 1.0
    assert rule.tick(1.2) is None
    assert rule.on_command(FAST, 1.25) == FAST


def test_a_task_is_not_braked_twice(robot):
    rule, share = robot
    share[0] = 0.0
    rule.select(False, 1.0)
    rule.on_task(ZERO, 1.1)
    assert rule.on_task(FAST, 1.2) == FAST and rule.state == TASK
    assert rule.tick(1.3) is None and rule.sent == FAST


def test_the_brake_never_speaks_after_the_end(robot):
    rule, share = robot
    rule.on_command(FAST, 1.0)
    rule.close(1.1)
    share[0] = 0.0
    assert (rule.tick(1.2), rule.state, rule.next_tick(1.2)) == (ZERO, CLOSED, 1.25)
