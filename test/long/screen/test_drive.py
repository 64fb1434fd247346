# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel as an operator uses it: real clicks and keys, a real master, simulated robots.

At the end the journal of the mux is replayed; ``MHRI_DRIVE_S`` drives at random for so long before
(default: a moment), 3600 for an hour.
"""
import os
import random
import signal
import time

import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.reasons import STOPPED_ALONE
from mhri.base.views import ROS_NO_MASTER
from mhri.driving.gui.hands import Errand, Grip
from mhri.screen.gui.tile_header import STOPPED
from support.graph import SELECT
from support.journals import Journal
from support.keyboard import xdotool
from support.ros_system import processes_with, System, wait_for

ROBOTS = ('bot1', 'bot2', 'bot3')
DRIVE_S = float(os.environ.get('MHRI_DRIVE_S') or 3.0)


def until(condition, what='the condition'):
    """Let Qt work until a condition comes true."""
    return wait_for(condition, what=what, turn=QApplication.processEvents)


class Session:
    """An operator's session: the system, the panel in this process, a witness for each robot."""

    def __init__(self):
        from mhri.screen.presenters.demo import Hands
        from mhri.screen.presenters.screen_presenter import ScreenPresenter
        from mhri.screen.ros.backend import ScreenBackend
        self.system = System()
        self.app = QApplication.instance() or QApplication(['panel'])
        self.presenter = ScreenPresenter(ScreenBackend(['panel']))
        self.presenter.screen.resize(1000, 600)
        self.presenter.screen.show()
        self.hands = Hands(self.presenter.screen)
        self.presenter.start()
        self.operator = self.presenter.operator
        until(lambda: self.operator.view().ros == ROS_NO_MASTER, what='the missing master')
        self.system.start_master()
        until(lambda: self.operator.view().ros == 'connected', what='the panel to connect')
        self.journal = Journal(self.system.home)
        self.system.node('mux', '__name:=mux', self.journal.argument)
        self.system.launch('sim.launch', 'n:=3')
        from support.robots import Witness
        self.witnesses = {name: Witness(name) for name in ROBOTS}
        until(lambda: all(witness.live() for witness in self.witnesses.values()), 'the robots')

    def widget(self, name):
        found = self.presenter.screen.findChild(QWidget, name)
        assert found is not None, 'no widget ' + name
        return found

    def click(self, name):
        QTest.mouseClick(self.widget(name), Qt.LeftButton)

    def robot(self, name):
        return self.operator.robot_view(name)

    def proof(self, name):
        """Return the state of a robot's proof, None while the drive has not said it is stopped."""
        proof = self.robot(name).proof
        return proof.state if proof else None

    def drive(self, forward, turn, condition, what='the robots to drive'):
        """Hold the stick until a condition comes true."""
        until(Grip(lambda: self.take_stick(forward, turn), self.let_go,
                   lambda: self.operator.view().status, condition), what)

    def take_stick(self, forward, turn):
        """Press the stick in its middle and drag it."""
        self.hands.hold_stick(forward, turn)

    def let_go(self):
        self.hands.let_go()

    def look(self):
        if len(self.operator.selection.robots) < 3:
            self.click('look_button')
        until(lambda: [self.robot(name).link for name in self.operator.selection.robots]
              == ['live'] * 3, what='three live robots')

    def select(self, *names):
        """Click check boxes until exactly these robots are selected."""
        for name in ROBOTS:
            if (name in names) != (name in self.operator.selection.selected):
                self.click('check_' + name)
        assert set(self.operator.selection.selected) == set(names)
        until(lambda: set(self.presenter.windows) >= set(names), what='the windows')
        until(lambda: self.operator.view().status.endswith('ready') or not names,
              what=lambda: 'the panel to be ready: ' + self.operator.view().status)

    def look_first_at_another(self, name):
        """Have the tile of this robot small, and another one large."""
        self.presenter.screen.stage.set_style('one')
        self.presenter.screen.look_at(next(other for other in ROBOTS if other != name))
        until(lambda: all(other in self.presenter.windows for other in ROBOTS), what='the tiles')
        until(lambda: not self.presenter.windows[name].header.large, what='a small tile')

    def release(self):
        """Give up stop-all as a person does."""
        def release():
            self.click('release_button')
            self.click('confirm_button')
        # The mux may not have seen yet that the stick was let go.
        until(Errand(release, lambda: not self.operator.view().stop_all, 1.0,
                     self.widget('release_button').isEnabled), 'the release')

    def stop_one(self, name):
        """Stop one robot by the button in its tile."""
        QTest.mouseClick(self.presenter.windows[name].robot_stop, Qt.LeftButton)

    def rest(self):
        until(lambda: all(witness.at_rest() for witness in self.witnesses.values()),
              'all robots to stand still')

    def close(self):
        self.presenter.close()
        # Before the application, which goes with this object.
        self.presenter.screen.deleteLater()
        self.app.sendPostedEvents(None, QEvent.DeferredDelete)
        import rospy
        rospy.signal_shutdown('done')
        self.system.close()


@pytest.fixture(scope='module')
def session():
    running = Session()
    yield running
    running.close()


@pytest.fixture(autouse=True)
def tidy(session):
    """Begin each test with three robots at rest, none selected, nothing stopped."""
    session.look()
    session.select()
    session.rest()


def test_two_of_three_drive_alike_and_stand_still_when_the_stick_is_let_go(session):
    session.select('bot1', 'bot3')
    # A robot that has just been found may take a moment longer than the other to be connected.
    session.drive(0.4, 0.0, lambda: session.witnesses['bot1'].moving()
                  and session.witnesses['bot3'].moving())
    session.let_go()
    session.rest()
    before = {name: session.witnesses[name].path_m for name in ROBOTS}
    session.drive(0.4, 0.0, lambda: session.witnesses['bot1'].path_m - before['bot1'] > 0.3)
    since = time.monotonic()
    session.let_go()
    until(lambda: session.witnesses['bot1'].stood_still_at(since)
          and session.witnesses['bot3'].stood_still_at(since), what='standstill')
    driven = {name: session.witnesses[name].path_m - before[name] for name in ROBOTS}
    print('MEASURED driven: {}; still {:.0f} and {:.0f} ms after release'.format(
        ', '.join('{} {:.3f} m'.format(*item) for item in driven.items()),
        *((session.witnesses[name].stood_still_at(since) - since) * 1e3
          for name in ('bot1', 'bot3'))))
    assert driven['bot2'] == 0.0
    # One of them may begin or end a moment later than the other.
    assert driven['bot3'] == pytest.approx(driven['bot1'], rel=0.5)


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
        session.look_first_at_another(name)
        tile = session.presenter.windows[name]
        before, place = tile.geometry(), tile.mapToGlobal(tile.rect().center())
        del wished[:]
        xdotool('mousemove', place.x(), place.y(), 'click', '--repeat', 2, '--delay', 120, 1)
        until(lambda: wished[-2:] == [(name,)] * 2, what='the wish')
        assert tile.geometry() != before, 'nothing has moved under the pointer'
        assert set(wished[:]) <= {(name,), wished[0]} and wished[-1] == (name,)
    session.app.setDoubleClickInterval(usual)
    subscriber.unregister()


def test_one_robot_is_stopped_with_proof_and_the_other_goes_on(session):
    session.select('bot1', 'bot2')
    try:
        session.drive(0.0, 0.5, lambda: all(
            session.witnesses[name].moving() for name in ('bot1', 'bot2')))
        since = time.monotonic()
        session.stop_one('bot1')
        still_at = until(lambda: session.witnesses['bot1'].stood_still_at(since), 'standstill')
        print('MEASURED still after {:.0f} ms'.format(1e3 * (still_at - since)))
        until(lambda: session.proof('bot1') == 'stopped', 'the proof')
        until(lambda: session.presenter.windows['bot1'].drive_state == STOPPED, 'its tile')
        assert session.operator.selection.selected == ('bot2',)
        assert not session.operator.view().stop_all and session.proof('bot2') is None
        session.drive(0.0, 0.5, session.witnesses['bot2'].moving, 'bot2 to go on')
        session.stop_one('bot1')
    finally:
        session.let_go()
    session.rest()
    assert session.robot('bot1').stands == STOPPED_ALONE, 'pressed again it stops again'
    assert not session.witnesses['bot1'].moved_since(still_at)
    session.select('bot1')
    until(lambda: session.proof('bot1') is None, 'the end of its stop')
    session.drive(0.0, 0.5, session.witnesses['bot1'].moving, 'bot1, selected anew')
    session.let_go()


def test_closing_the_torn_off_window_of_a_driven_robot_stops_it(session):
    session.select('bot2')
    session.drive(0.0, 0.5, session.witnesses['bot2'].moving)
    until(lambda: 'bot2' in session.presenter.windows, what='the tile')
    session.presenter.tiles.toggle_torn('bot2')
    session.presenter.windows['bot2'].window().close()
    until(session.witnesses['bot2'].at_rest, 'bot2 to stand still')
    assert 'bot2' not in session.operator.selection.selected
    assert not session.presenter.windows['bot2'].torn_off
    session.let_go()


def test_a_robot_switched_off_is_gone_and_not_confirmed_and_comes_back(session):
    base = [process for process in processes_with(
        'sim_robot', master=session.system.env['ROS_MASTER_URI'])
        if 'bot3' in ' '.join(process.cmdline())]
    assert base, 'no process of bot3'
    base[0].send_signal(signal.SIGKILL)
    until(lambda: session.robot('bot3').link == 'gone', 'bot3 to be gone')
    session.click('stop_button')
    until(lambda: session.proof('bot3') == 'not_confirmed', 'NOT CONFIRMED')
    until(lambda: session.proof('bot1') == 'stopped', 'the proof of bot1')
    session.release()
    session.system.launch('turtlebot.launch', 'name:=bot3', 'type:=turtlebot3_waffle', 'x:=3',
                          'y:=1.5')
    until(lambda: session.robot('bot3').link == 'live', 'bot3 to be back')


def test_a_restarted_master_is_said_and_driving_goes_on_without_a_restart(session):
    from mhri.graph.ros.master_watch import MasterWatch
    watch = MasterWatch().start()
    session.select('bot1')
    session.system.kill(session.system.master)
    until(lambda: session.operator.view().ros == ROS_NO_MASTER, 'the panel to say so')
    until(lambda: session.widget('status_label').text() == session.operator.view().status)
    session.system.start_master()
    until(lambda: session.operator.view().status.endswith('ready'), 'ready again')
    session.drive(0.0, 0.5, session.witnesses['bot1'].moving)
    session.let_go()
    until(session.witnesses['bot1'].at_rest, 'bot1 to stand still')
    watch.stop()


def test_what_left_for_the_robots_is_what_the_drive_says(session):
    dice, end = random.Random(33), time.monotonic() + DRIVE_S
    session.click('brake_box')
    while time.monotonic() < end:
        session.select(*dice.sample(ROBOTS, dice.randint(1, 3)))
        session.take_stick(dice.uniform(-1.0, 1.0), dice.uniform(-1.0, 1.0))
        later = time.monotonic() + dice.uniform(0.2, 4.0)
        until(lambda: time.monotonic() > later)
        if dice.random() < 0.1:
            session.click('stop_button')
        session.let_go()
        session.release()
    session.click('brake_box')
    session.journal.conforms()
