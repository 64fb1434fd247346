# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel as an operator uses it: real clicks and keys, a real master, simulated robots."""
import os
import signal
import subprocess
import sys
import time

import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QWidget

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.screen.presenters.demo import Grip  # noqa: E402
from support.graph import SELECT  # noqa: E402
from support.ros_system import processes_with, System, wait_for  # noqa: E402

ROBOTS = ('bot1', 'bot2', 'bot3')


def until(condition, timeout_s=15.0, what='the condition'):
    """Let Qt work until a condition comes true."""
    def turn():
        QApplication.processEvents()
        return condition()
    return wait_for(turn, timeout_s, what)


class Session:
    """An operator's session: the system, the panel in this process, a witness for each robot."""

    def __init__(self):
        import rospy
        from mhri.screen.presenters.demo import Hands
        from mhri.screen.presenters.screen_host import ScreenHost
        from mhri.screen.ros.backend import ScreenBackend
        self.system = System()
        self.app = QApplication.instance() or QApplication(['panel'])
        self.host = ScreenHost(ScreenBackend(['panel']))
        self.host.screen.resize(1000, 600)
        self.host.screen.show()
        self.hands = Hands(self.host.screen)
        self.host.start()
        self.operator = self.host.operator
        until(lambda: 'no ROS master' in self.operator.view().status, what='the missing master')
        self.system.start_master()
        until(lambda: self.operator.view().ros == 'connected', what='the panel to connect')
        self.system.node('mux', '__name:=mux')
        self.system.node('gates')
        self.system.launch('sim.launch', 'n:=3')
        from support.robots import Witness
        self.witnesses = {name: Witness(name) for name in ROBOTS}
        until(lambda: all(witness.live() for witness in self.witnesses.values()), 40, 'the robots')
        self._rospy = rospy

    def widget(self, name):
        found = self.host.screen.findChild(QWidget, name)
        assert found is not None, 'no widget ' + name
        return found

    def click(self, name):
        QTest.mouseClick(self.widget(name), Qt.LeftButton)

    def robot(self, name):
        return self.operator.robot_view(name)

    def proof(self, name):
        """Return the state of a robot's proof, None while the gates have not said it is stopped."""
        proof = self.robot(name).proof
        return proof.state if proof else None

    def drive(self, forward, turn, condition, what='the robots to drive'):
        """Hold the stick until a condition comes true."""
        until(Grip(lambda: self.take_stick(forward, turn), self.let_go,
                   lambda: self.operator.view().status, condition), 30, what)

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
        until(lambda: set(self.host.windows) >= set(names), what='the windows')
        until(lambda: self.operator.view().status.endswith('ready') or not names,
              what=lambda: 'the panel to be ready: ' + self.operator.view().status)

    def look_first_at_another(self, name):
        """Have the tile of this robot small, and another one large."""
        self.host.screen.stage.set_style('one')
        self.host.screen.look_at(next(other for other in ROBOTS if other != name))
        until(lambda: all(other in self.host.windows for other in ROBOTS), what='the tiles')
        until(lambda: not self.host.windows[name].header.large, what='a small tile')

    def release(self):
        """Give up stop-all as a person does: where the mux has not seen the stick let go, again."""
        tried_at = [-10.0]

        def released():
            if not self.operator.view().stop_all:
                return True
            if time.monotonic() - tried_at[0] > 1.0 and self.widget('release_button').isEnabled():
                tried_at[0] = time.monotonic()
                self.click('release_button')
                self.click('confirm_button')
            return False
        until(released, 30, 'the release')

    def rest(self):
        until(lambda: all(witness.at_rest() for witness in self.witnesses.values()), 5,
              'all robots to stand still')

    def close(self):
        self.host.close()
        # Before the application, which goes with this object.
        self.host.screen.deleteLater()
        self.app.sendPostedEvents(None, QEvent.DeferredDelete)
        self._rospy.signal_shutdown('done')
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
    assert driven['bot3'] == pytest.approx(driven['bot1'], rel=0.15)


def test_a_double_click_drives_the_robot_of_its_first_press_though_the_tiles_change_places(session):
    from mhri.msg import RobotSelect
    wished = []
    subscriber = session._rospy.Subscriber(
        SELECT, RobotSelect, lambda message: wished.append(tuple(message.robots)), queue_size=10)
    session.select('bot1')
    for name in ('bot2', 'bot3', 'bot1', 'bot3'):
        session.look_first_at_another(name)
        tile = session.host.windows[name]
        before, place = tile.geometry(), tile.mapToGlobal(tile.rect().center())
        del wished[:]
        subprocess.run(['xdotool', 'mousemove', str(place.x()), str(place.y()), 'click', '--repeat',
                        '2', '--delay', '120', '1'], check=True, timeout=30)
        until(lambda: len(wished) > 2, what='the wish')
        assert tile.geometry() != before, 'nothing has moved under the pointer'
        assert set(wished) <= {(name,), wished[0]} and wished[-1] == (name,)
    subscriber.unregister()


def test_staying_together_slows_the_quick_one(session):
    session.select('bot1', 'bot2')
    assert 'its best' in session.operator.view().pace
    session.click('together_box')
    try:
        # Back to where the last test came from.
        session.drive(-1.0, 0.0, lambda: all(
            abs(session.witnesses[name].latest().linear_mps + 0.22) < 0.04
            for name in ('bot1', 'bot2')), 'both at the pace of the Burger')
        assert 'bot2' in session.host.screen.speed_limits.pace_label.text()
        session.click('together_box')
        until(lambda: session.witnesses['bot1'].latest().linear_mps < -0.3, 10,
              'the TurtleBot2 to do its best')
    finally:
        session.let_go()
    session.rest()


def test_a_robot_unchecked_while_driving_stops_and_the_other_goes_on(session):
    session.select('bot1', 'bot2')
    session.drive(0.0, 0.5, lambda: all(
        session.witnesses[name].moving() for name in ('bot1', 'bot2')))
    try:
        session.click('check_bot1')
        until(session.witnesses['bot1'].at_rest, 2, 'bot1 to stand still')
        assert session.witnesses['bot2'].moving()
    finally:
        session.let_go()


def test_closing_the_torn_off_window_of_a_driven_robot_stops_it(session):
    session.select('bot2')
    session.drive(0.0, 0.5, session.witnesses['bot2'].moving)
    until(lambda: 'bot2' in session.host.windows, what='the tile')
    session.host.tiles.toggle_torn('bot2')
    session.host.windows['bot2'].window().close()
    until(session.witnesses['bot2'].at_rest, 2, 'bot2 to stand still')
    assert 'bot2' not in session.operator.selection.selected
    assert not session.host.windows['bot2'].torn_off
    session.let_go()


def test_keys_drive_and_release_stops(session):
    session.select('bot1')
    session.host.screen.activateWindow()
    panel = session.host.screen
    until(Grip(lambda: QTest.keyPress(panel, Qt.Key_Left),
               lambda: QTest.keyRelease(panel, Qt.Key_Left),
               lambda: session.operator.view().status, session.witnesses['bot1'].moving), 30,
          'the key to drive')
    assert session.witnesses['bot1'].latest().angular_rad_s > 0
    QTest.keyRelease(session.host.screen, Qt.Key_Left)
    until(session.witnesses['bot1'].at_rest, 2, 'bot1 to stand still')


def test_stop_all_with_proof_and_release_in_two_steps(session):
    session.select('bot1', 'bot2')
    session.drive(0.0, 0.5, lambda: all(
        session.witnesses[name].moving() for name in ('bot1', 'bot2')))
    QTest.keyClick(session.host.screen, Qt.Key_Space, Qt.ShiftModifier)
    until(lambda: all(robot.proof and robot.proof.state == 'stopped'
                      for robot in session.operator.view().robots), what='the proofs')
    proofs = {robot.name: robot.proof.text for robot in session.operator.view().robots}
    print('MEASURED proofs: {}'.format(proofs))
    assert session.operator.view().stop_all
    session.let_go()
    session.take_stick(0.0, 0.5)
    since = time.monotonic()
    until(lambda: time.monotonic() - since > 0.3)
    assert not any(witness.moved_since(since) for witness in session.witnesses.values())
    session.let_go()
    until(lambda: session.operator.view().stop_all)
    session.release()
    until(lambda: session.operator.view().status.endswith('ready'), what='ready again')


def test_a_robot_switched_off_is_gone_and_not_confirmed_and_comes_back(session):
    base = [process for process in processes_with(
        'sim_robot', master=session.system.env['ROS_MASTER_URI'])
        if 'bot3' in ' '.join(process.cmdline())]
    assert base, 'no process of bot3'
    base[0].send_signal(signal.SIGKILL)
    until(lambda: session.robot('bot3').link == 'gone', 5, 'bot3 to be gone')
    assert 'switched off' in session.robot('bot3').note
    session.click('stop_button')
    until(lambda: session.proof('bot3') == 'not_confirmed', 3, 'NOT CONFIRMED')
    until(lambda: session.proof('bot1') == 'stopped', 3, 'the proof of bot1')
    session.release()
    session.system.launch('turtlebot.launch', 'name:=bot3', 'type:=turtlebot3_waffle', 'x:=3',
                          'y:=1.5')
    until(lambda: session.robot('bot3').link == 'live', 60, 'bot3 to be back')


def test_a_name_with_special_characters_is_refused_in_place(session):
    field = session.widget('name_edit')
    QTest.keyClicks(field, 'bot 9; reboot')
    session.click('add_button')
    assert 'not allowed' in session.widget('name_problem_label').text()
    assert field.text() == 'bot 9; reboot', 'nothing typed is lost'
    assert len(session.operator.selection.robots) == 3
    field.clear()


def test_the_doctor_examines_beside_the_driving(session):
    session.click('doctor_button')
    window = session.host.parts['doctor'].page
    assert window.isVisible() and session.host.screen.isAncestorOf(window)
    until(lambda: window.again_button.isEnabled(), 30, 'the examination')
    text = window.text.toPlainText()
    assert 'ROS master' in text and 'bot1' in text, text
    session.host.screen.tabs.setCurrentIndex(0)


def test_a_restarted_master_is_said_and_driving_goes_on_without_a_restart(session):
    from mhri.graph.ros.master_watch import MasterWatch
    watch = MasterWatch().start()
    session.select('bot1')
    session.system.kill(session.system.master)
    until(lambda: 'no ROS master' in session.operator.view().status, 5, 'the panel to say so')
    assert 'no ROS master' in session.widget('status_label').text() or until(
        lambda: 'no ROS master' in session.widget('status_label').text(), 2)
    session.system.start_master()
    until(lambda: session.operator.view().status.endswith('ready'), 10, 'ready again')
    session.drive(0.0, 0.5, session.witnesses['bot1'].moving)
    session.let_go()
    until(session.witnesses['bot1'].at_rest, 2, 'bot1 to stand still')
    watch.stop()
