# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The link of a robot: how it moves, whether it is heard, and in which words."""
import math

import pytest

from mhri.base.geometry import Pose
from mhri.base.views import GONE, LIVE, SILENT, WAITING
from mhri.robots.link import link_note, link_state, Motion


@pytest.mark.parametrize('linear, angular, still', [
    (0.0, 0.0, True), (0.01, 0.03, True), (-0.01, -0.03, True), (0.011, 0.0, False),
    (0.0, 0.031, False), (-0.2, 0.0, False), (float('nan'), 0.0, False),
    (0.0, float('inf'), False)])
def test_standstill(linear, angular, still):
    """Both speeds, and no number is no rest."""
    assert Motion(linear, angular).is_standstill() == still


@pytest.mark.parametrize('motion, still', [
    (Motion(0.0, 0.0, 5.0, -3.0, 9.0), True), (Motion(0.0, 0.0, lateral_mps=0.5), False),
    (Motion(0.009, 0.0, lateral_mps=-0.009), False), (Motion(0.0, 0.0, lateral_mps=0.009), True),
    (Motion(0.0, 0.0, lateral_mps=float('nan')), False), (Motion(0.0, 0.0, x_m=1e30), False),
    (Motion(0.0, 0.0, heading_rad=float('nan')), False)])
def test_standstill_is_of_the_whole_plane(motion, still):
    """Sideways counts, and a reading with anything impossible in it says nothing."""
    assert motion.is_standstill() == still


GRID_M = 5_900_000.0  # as in a national grid


@pytest.mark.parametrize('values, problem', [
    ((0.3, -0.2, GRID_M, -GRID_M, 3.0, 0.1), None),
    ((1e30, -0.2, 1.0, 2.0, 3.0, 0.1), 'speed of 1e+30 m/s'),
    ((0.3, 2e3, 1.0, 2.0, 3.0, 0.1), 'angular velocity of 2e+03 rad/s'),
    ((0.3, -0.2, 1.0, -1.6e308, 3.0, 0.1), 'place of -1.6e+308 m'),
    ((0.3, -0.2, 1.0, 2.0, float('inf'), 0.1), 'angle of inf rad'),
    ((0.3, -0.2, 1.0, 2.0, 3.0, -301.0), 'speed of -301 m/s')])
def test_what_cannot_be_is_named_and_is_no_number(values, problem):
    motion = Motion.reported(*values)
    kept = (motion.linear_mps, motion.angular_rad_s, motion.x_m, motion.y_m, motion.heading_rad,
            motion.lateral_mps)
    assert motion.problem == problem and motion.is_possible() == (problem is None)
    assert sum(map(math.isnan, kept)) == (problem is not None)
    assert all(one == told for one, told in zip(kept, values) if one == one)


def test_a_heading_is_as_good_as_the_quaternion_it_is_from():
    good = Motion.reported(0.3, 0.0, 1.0, 2.0, 0.5, 0.0, turn=(0.0, 0.0, 0.6, 0.8))
    bad = Motion.reported(0.3, 0.0, 1.0, 2.0, 0.5, 0.0, turn=(0.0, 0.0, 1e30, 0.8))
    assert good.is_possible() and good.heading_rad == 0.5
    assert math.isnan(bad.heading_rad) and bad.linear_mps == 0.3
    assert '1e+30' in bad.problem and not bad.is_standstill()
    assert good.pose == Pose(1.0, 2.0, 0.5) and bad.pose is None


def test_odometry_without_an_orientation_shows_a_standstill_but_no_pose():
    rests = Motion.reported(0.0, 0.0, 1.0, 2.0, math.nan, 0.0, turn=(0.0, 0.0, 0.0, 0.0))
    assert rests.is_standstill() and rests.pose is None
    assert '(0, 0, 0, 0)' in rests.note and not Motion(0.0, 0.0).note


@pytest.mark.parametrize('age_s, connections, state', [
    (None, 0, WAITING), (None, 1, WAITING), (0.0, 1, LIVE), (1.0, 1, LIVE), (1.001, 1, SILENT),
    (1.001, 0, GONE), (0.5, 0, LIVE), (3600.0, 2, SILENT)])
def test_link_state(age_s, connections, state):
    """Gone is without a connection, silent with one."""
    assert link_state(age_s, connections) == state


@pytest.mark.parametrize('age_s, connections, silent_after_s, state', [
    (2.4, 1, 2.5, LIVE), (2.6, 1, 2.5, SILENT), (2.6, 0, 2.5, GONE), (0.6, 1, 0.5, SILENT),
    (None, 1, 2.5, WAITING), (None, 1, 0.0, LIVE), (3600.0, 1, 0.0, LIVE), (3600.0, 0, 0.0, GONE),
    (None, 0, 0.0, WAITING)])
def test_each_type_has_its_own_silence(age_s, connections, silent_after_s, state):
    """Odometry at 1 Hz, or in motion only; even then a closed connection tells."""
    assert link_state(age_s, connections, silent_after_s) == state


@pytest.mark.parametrize('age_s, connections, state', [
    (None, 0, LIVE), (None, 1, WAITING), (5.0, 0, GONE), (5.0, 1, SILENT)])
def test_a_robot_that_takes_commands_and_has_no_odometry_is_not_waited_for(
        age_s, connections, state):
    """It is driven; one whose odometry has ended is gone all the same."""
    assert link_state(age_s, connections, reached=True) == state


@pytest.mark.parametrize('state, age_s, waited_s, found', [
    (LIVE, 0.1, 9.0, ()), (WAITING, None, 1.0, ()), (SILENT, 3.2, 9.0, ('3.2 s',)),
    (SILENT, 59.9, 99.0, ('59.9 s',)), (SILENT, 600.0, 999.0, ('14:02:11',)),
    (GONE, 600.0, 999.0, ('14:02:11',))])
def test_a_note_on_a_link_names_the_time(state, age_s, waited_s, found):
    note = link_note(state, age_s, '14:02:11', waited_s)
    assert bool(note) == bool(found) and all(words in note for words in found)
