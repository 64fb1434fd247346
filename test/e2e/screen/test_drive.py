# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel as an operator uses it: clicks of the X server, a real master, simulated robots."""
import signal
import time

import pytest

from mhri.base.reasons import STOPPED_ALONE
from mhri.screen.gui.robot_tile import RobotTile
from mhri.screen.gui.tile_header import STOPPED
from support.drive_session import DriveSession, ROBOTS
from support.ros_system import processes_with


@pytest.fixture(scope='module')
def session():
    running = DriveSession()
    yield running
    running.close()


@pytest.fixture(autouse=True)
def tidy(session):
    session.tidy()


def stop_one(session, name):
    """Press the stop in a robot's tile, but not on the X server: a slow screen would stop all."""
    session.hands.click('robot_stop_button', session.presenter.windows[name])


def test_two_of_three_drive_alike_and_stand_still_when_the_stick_is_let_go(session):
    session.select('bot1', 'bot3')
    # A robot that has just been found may take a moment longer than the other to be connected.
    session.drive(0.4, 0.0, lambda: session.witnesses['bot1'].moving()
                  and session.witnesses['bot3'].moving())
    session.hands.let_go()
    session.rest()
    before = {name: session.witnesses[name].path_m for name in ROBOTS}
    session.drive(0.4, 0.0, lambda: session.witnesses['bot1'].path_m - before['bot1'] > 0.3)
    since = time.monotonic()
    session.hands.let_go()
    session.until(lambda: session.witnesses['bot1'].stood_still_at(since)
                  and session.witnesses['bot3'].stood_still_at(since), what='standstill')
    driven = {name: session.witnesses[name].path_m - before[name] for name in ROBOTS}
    print('MEASURED driven: {}; still {:.0f} and {:.0f} ms after release'.format(
        ', '.join('{} {:.3f} m'.format(*item) for item in driven.items()),
        *((session.witnesses[name].stood_still_at(since) - since) * 1e3
          for name in ('bot1', 'bot3'))))
    assert driven['bot2'] == 0.0
    # One of them may begin or end a moment later than the other.
    assert driven['bot3'] == pytest.approx(driven['bot1'], rel=0.5)


def test_one_robot_is_stopped_with_proof_and_the_other_goes_on(session):
    session.select('bot1', 'bot2')
    try:
        session.drive(0.0, 0.5, lambda: all(
            session.witnesses[name].moving() for name in ('bot1', 'bot2')))
        since = time.monotonic()
        stop_one(session, 'bot1')
        still_at = session.until(lambda: session.witnesses['bot1'].stood_still_at(since),
                                 what='standstill')
        print('MEASURED still after {:.0f} ms'.format(1e3 * (still_at - since)))
        session.until(lambda: session.proof('bot1') == 'stopped', what='the proof')
        session.until(lambda: session.presenter.windows['bot1'].drive_state == STOPPED,
                      what='its tile')
        assert session.operator.selection.selected == ('bot2',)
        assert not session.operator.view().stop_all and session.proof('bot2') is None
        session.drive(0.0, 0.5, session.witnesses['bot2'].moving, 'bot2 to go on')
        stop_one(session, 'bot1')
    finally:
        session.hands.let_go()
    session.rest()
    assert session.robot('bot1').stands == STOPPED_ALONE, 'pressed again it stops again'
    assert not session.witnesses['bot1'].moved_since(still_at)
    session.select('bot1')
    session.until(lambda: session.proof('bot1') is None, what='the end of its stop')
    session.drive(0.0, 0.5, session.witnesses['bot1'].moving, 'bot1, selected anew')
    session.hands.let_go()


def test_closing_the_torn_off_window_of_a_driven_robot_stops_it(session):
    session.select('bot2')
    session.drive(0.0, 0.5, session.witnesses['bot2'].moving)
    session.until(lambda: 'bot2' in session.presenter.windows, what='the tile')
    session.presenter.tiles.toggle_torn('bot2')
    session.presenter.windows['bot2'].window().close()
    session.until(session.witnesses['bot2'].at_rest, what='bot2 to stand still')
    assert 'bot2' not in session.operator.selection.selected
    assert not session.presenter.windows['bot2'].torn_off
    session.hands.let_go()


def test_a_tile_shows_the_picture_of_its_robot_and_goes_with_it(session):
    tiles, steps = session.presenter.tiles, session.presenter.screen.remove_steps
    session.until(lambda: all(tiles.picture_of(name)[1] is not None for name in ROBOTS),
                  what='pictures')
    assert [tiles.picture_of(name)[0].split('/')[1] for name in ROBOTS] == list(ROBOTS)

    def shown():
        return sorted(tile.name for tile in session.presenter.screen.findChildren(RobotTile))
    steps.remove_requested.emit('bot2')
    session.until(lambda: shown() == ['bot1', 'bot3'], what='the removal')
    session.look()
    session.until(lambda: shown() == list(ROBOTS), what='its next tile')


def test_a_robot_switched_off_is_gone_and_not_confirmed_and_comes_back(session):
    base = [process for process in processes_with(
        'sim_robot', master=session.system.env['ROS_MASTER_URI'])
        if 'bot3' in ' '.join(process.cmdline())]
    assert base, 'no process of bot3'
    base[0].send_signal(signal.SIGKILL)
    session.until(lambda: session.robot('bot3').link == 'gone', what='bot3 to be gone')
    session.click('stop_button')
    session.until(lambda: session.proof('bot3') == 'not_confirmed', what='NOT CONFIRMED')
    session.until(lambda: session.proof('bot1') == 'stopped', what='the proof of bot1')
    session.release()
    session.system.launch('turtlebot.launch', 'name:=bot3', 'type:=turtlebot3_waffle', 'x:=3',
                          'y:=1.5')
    session.until(lambda: session.robot('bot3').link == 'live', what='bot3 to be back')
