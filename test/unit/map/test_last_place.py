# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A lost robot stays on the map where it was, with the time, until it is removed."""
from dataclasses import replace
from datetime import datetime

import pytest

from mhri.base.geometry import Pose
from mhri.base.views import GONE, LIVE, RobotView, SILENT, WAITING
from mhri.map.last_place import LastPlaces, LOST_S, lost_word
from mhri.map.scene import MapRobot

# Half a minute after 19:23.
AT = datetime(2026, 11, 26, 19, 23, 30).timestamp()
THERE, ELSEWHERE = Pose(1.0, 2.0, 0.5), Pose(9.0, 9.0, 0.0)
HERE = MapRobot('bot3', 3, THERE)


def view(link, age_s=0.0):
    return RobotView('bot3', link=link, age_s=age_s)


@pytest.fixture
def places():
    """Return the last places of a robot that was live."""
    made = LastPlaces()
    assert made.update(HERE, view(LIVE), AT) == HERE
    return made


@pytest.mark.parametrize('link, age_s, lost', [
    (GONE, 0.1, True), (GONE, 3600.0, True), (SILENT, LOST_S, True),
    (SILENT, LOST_S - 0.1, False), (WAITING, 60.0, False)])
def test_which_robot_is_lost(places, link, age_s, lost):
    robot = places.update(HERE, view(link, age_s), AT + age_s)
    assert robot.lost == ('lost 19:23' if lost else '') and robot.old == lost
    assert robot.pose == THERE


def test_it_stays_where_it_was_when_its_source_of_places_ends_with_it(places):
    for pose in (None, ELSEWHERE):
        robot = places.update(replace(HERE, pose=pose, old=True), view(GONE, 600.0), AT + 600.0)
        assert robot.pose == THERE and robot.lost == 'lost 19:23' and robot.points is None


def test_a_place_that_was_old_before_is_not_kept(places):
    places.update(replace(HERE, pose=ELSEWHERE, old=True), view(LIVE), AT)
    assert places.update(replace(HERE, pose=None), view(GONE), AT).pose == THERE


def test_its_time_stays_until_it_is_back(places):
    assert places.update(HERE, view(GONE, 20.0), AT + 20.0).lost == 'lost 19:23'
    assert places.update(HERE, view(GONE, 20.0), AT + 900.0).lost == 'lost 19:23'
    assert places.update(HERE, view(LIVE), AT + 900.0).lost == ''
    assert places.update(HERE, view(GONE, 0.0), AT + 900.0).lost == 'lost 19:38'


def test_one_taken_off_comes_back_with_its_robot(places):
    places.update(HERE, view(GONE), AT)
    places.take_off('bot3')
    robot = places.update(HERE, view(GONE), AT)
    assert robot.pose is None and not robot.lost and robot.text
    assert places.update(HERE, view(LIVE), AT).pose == THERE
    assert places.update(HERE, view(GONE), AT).lost


def test_one_removed_from_the_list_is_forgotten(places):
    places.keep(('bot3',))
    assert places.update(replace(HERE, pose=None), view(GONE), AT).pose == THERE
    places.keep(('bot1',))
    assert places.update(replace(HERE, pose=None), view(GONE), AT).pose is None


def test_a_time_beyond_every_calendar_is_left_out():
    assert lost_word(1e20) == 'lost'
