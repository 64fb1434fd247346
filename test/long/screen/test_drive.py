# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel as an operator uses it: two clicks in a hurry, a new master, and what was driven.

At the end the journal of the mux is replayed; ``MHRI_DRIVE_S`` drives at random for so long before
(default: a moment), 3600 for an hour.
"""
import os
import random
import time

import pytest

from mhri.base.views import ROS_NO_MASTER
from support.drive_session import DriveSession, ROBOTS
from support.graph import SELECT
from support.keyboard import xdotool

DRIVE_S = float(os.environ.get('MHRI_DRIVE_S') or 3.0)


@pytest.fixture(scope='module')
def session():
    running = DriveSession()
    yield running
    running.close()


@pytest.fixture(autouse=True)
def tidy(session):
    session.tidy()


def look_first_at_another(session, name):
    """Have the tile of this robot small, and another one large."""
    session.presenter.screen.stage.set_style('one')
    session.presenter.screen.look_at(next(other for other in ROBOTS if other != name))
    session.until(lambda: all(other in session.presenter.windows for other in ROBOTS),
                  what='the tiles')
    session.until(lambda: not session.presenter.windows[name].header.large, what='a small tile')


def test_a_double_click_drives_the_robot_of_its_first_press_though_the_tiles_change_places(session):
    import rospy
    from mhri.msg import RobotSelect
    wished = []
    subscriber = rospy.Subscriber(
        SELECT, RobotSelect, lambda message: wished.append(tuple(message.robots)), queue_size=10)
    session.select('bot1')
    usual = session.app.doubleClickInterval()
    # However busy the X server is between the two clicks.
    session.app.setDoubleClickInterval(10_000)
    for name in ('bot2', 'bot3', 'bot1', 'bot3'):
        look_first_at_another(session, name)
        tile = session.presenter.windows[name]
        before, place = tile.geometry(), tile.mapToGlobal(tile.rect().center())
        del wished[:]
        xdotool('mousemove', place.x(), place.y(), 'click', '--repeat', 2, '--delay', 120, 1)
        session.until(lambda: wished[-2:] == [(name,)] * 2, what='the wish')
        assert tile.geometry() != before, 'nothing has moved under the pointer'
        assert set(wished[:]) <= {(name,), wished[0]} and wished[-1] == (name,)
    session.app.setDoubleClickInterval(usual)
    subscriber.unregister()


def test_a_restarted_master_is_said_and_driving_goes_on_without_a_restart(session):
    from mhri.graph.ros.master_watch import MasterWatch
    watch = MasterWatch().start()
    session.select('bot1')
    session.system.kill(session.system.master)
    session.until(lambda: session.operator.view().ros == ROS_NO_MASTER, what='the panel to say so')
    session.until(lambda: session.hands.widget('status_label').text()
                  == session.operator.view().status, what='its status line')
    session.system.start_master()
    session.until(lambda: session.operator.view().status.endswith('ready'), what='ready again')
    session.drive(0.0, 0.5, session.witnesses['bot1'].moving)
    session.hands.let_go()
    session.until(session.witnesses['bot1'].at_rest, what='bot1 to stand still')
    watch.stop()


def test_what_left_for_the_robots_is_what_the_drive_says(session):
    dice, end = random.Random(33), time.monotonic() + DRIVE_S
    session.click('brake_box')
    while time.monotonic() < end:
        session.select(*dice.sample(ROBOTS, dice.randint(1, 3)))
        session.hands.hold_stick(dice.uniform(-1.0, 1.0), dice.uniform(-1.0, 1.0))
        later = time.monotonic() + dice.uniform(0.2, 4.0)
        session.until(lambda: time.monotonic() > later)
        if dice.random() < 0.1:
            session.click('stop_button')
            session.until(lambda: session.operator.view().stop_all, what='the stop')
        session.hands.let_go()
        session.release()
    session.click('brake_box')
    session.journal.conforms()
