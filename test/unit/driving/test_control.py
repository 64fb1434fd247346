# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who is in control, as one screen sees it."""
import pytest

from mhri.base.views import LinkFigures, RobotView
from mhri.driving.control import ScreenRole, operator_name, VACANT_S, who_drives
from mhri.driving.group_speed import pace_words
from mhri.screen.ros.active_screen import ActiveScreen

ME, OTHER = '/mhri_panel', '/rqt_gui_py_node_12'


@pytest.mark.parametrize('drives, heard, after', [
    (True, [(ME, 0.0)], True),
    (True, [('', 0.0)], True),
    (True, [(OTHER, 0.0)], False),
    (False, [(OTHER, 0.0)], False),
    (False, [(ME, 0.0)], True),
    (False, [('', 0.0)], False),
    (False, [('', 0.0), ('', VACANT_S - 0.1)], False),
    (False, [('', 0.0), ('', VACANT_S)], True),
    (False, [('', 0.0), (OTHER, 1.0), ('', 1.5), ('', VACANT_S + 1.0)], False),
    (True, [(OTHER, 0.0), ('', 1.0), ('', 1.0 + VACANT_S), (OTHER, 4.0)], False),
])
def test_a_claim(drives, heard, after):
    role = ScreenRole(ME)
    role.drives = drives
    for operator, now in heard:
        role.update(operator, now)
    assert role.drives == after


def test_a_screen_that_is_refused_claims_nothing_until_it_takes_control():
    role = ScreenRole(ME)
    assert role.drives and VACANT_S == 2.0
    role.update('', 0.0, refused=True)
    assert not role.drives
    for now in (1.0, 3.0, 10.0, 60.0):
        role.update('', now)
        assert not role.drives
    role.update(ME, 61.0)
    assert role.drives
    role.update('', 62.0)
    assert role.drives


@pytest.mark.parametrize('node, words', [
    ('/mhri_panel', 'panel'), ('/mhri_panel_2', 'panel'), (OTHER, 'panel in rqt'),
    ('/night_watch', 'night_watch')])
def test_a_node_has_a_name_for_people(node, words):
    assert operator_name(node) == words


def test_who_drives():
    assert who_drives(ME) == operator_name(ME)
    words = who_drives(ME, 'lab-pc2')
    assert words.startswith(operator_name(ME)) and words.endswith('lab-pc2')


def test_a_seat_has_one_holder():
    seat, one, other = ActiveScreen(), object(), object()
    assert seat.holds(one) and not seat.holds(other)
    seat.take(other)
    assert seat.holds(other) and not seat.holds(one)
    seat.leave(one)
    assert seat.holds(other), 'only the holder leaves'
    seat.leave(other)
    assert seat.holds(one)


@pytest.mark.parametrize('together, share, words', [
    (False, 1.0, 'each at top speed'),
    (True, 1.0, 'all as slow: at most 0.22 m/s, 2.00 rad/s'),
    (True, 0.6, '60 % of the speed: the link to far takes 250 ms'),
])
def test_the_pace_is_what_the_drive_says(together, share, words):
    robots = [RobotView('far', selected=True, figures=LinkFigures(round_trip_s=0.25),
                        max_linear_mps=1.0, max_angular_rad_s=2.0),
              RobotView('slow', selected=True, max_linear_mps=0.22, max_angular_rad_s=2.0)]
    assert pace_words(robots, together, share) == words


def test_the_pace_of_a_group_names_who_is_slowest_ahead_and_in_a_turn():
    robots = [RobotView(name, selected=True, max_linear_mps=mps, max_angular_rad_s=rad_s)
              for name, mps, rad_s in (('a', 0.2, 3.0), ('z', 0.9, 1.0), ('b', 0.5, 1.0))]
    assert ' a and b: ' in pace_words(robots, True, 1.0)


def test_a_slow_link_that_is_not_known_here():
    assert pace_words([], True, 1.0)
    assert '50 %' in pace_words([], False, 0.5)
