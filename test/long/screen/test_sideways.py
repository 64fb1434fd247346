# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sideways by keys; beside the robot that can, one that cannot."""
import time

import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtGui import QKeyEvent
from python_qt_binding.QtWidgets import QApplication

from mhri.base.reasons import NOT_SIDEWAYS, Reason
from mhri.base.views import VIRTUAL_JOYSTICK
from mhri.screen.presenters.demo import Grip
from support.panel_session import PanelSession

# One starts 1 m beside a wall on its left, the other far away from it.
CAN, CANNOT = 'bot3', 'bot1'
LEFT_MPS = 0.2


class Sideways(PanelSession):
    """The two robots, and what they are sent."""

    def __init__(self):
        super().__init__([('turtlebot.launch', 'name:=' + name, 'type:=' + kind)
                          for name, kind in ((CAN, 'holonomic'), (CANNOT, 'turtlebot3_burger'))],
                         (CAN, CANNOT))
        from support.node_tools import Recorder
        from geometry_msgs.msg import Twist
        self.sent = {name: Recorder('/{}/cmd_vel'.format(name), Twist, lambda message: (
            message.linear.x, message.linear.y, message.angular.z)) for name in (CAN, CANNOT)}

    def select(self, *names):
        for name in (CAN, CANNOT):
            if (name in names) != (name in self.operator.selection.selected):
                self.hands.click('check_' + name)
        self.ready()

    def ready(self):
        self.until(lambda: self.operator.view().status.endswith('ready'),
                   what=lambda: 'the robots to be ready: ' + self.operator.view().status)

    def key(self, key, down):
        QApplication.sendEvent(self.presenter.screen, QKeyEvent(
            QEvent.KeyPress if down else QEvent.KeyRelease, key, Qt.NoModifier))

    def hold(self, key, condition, what):
        """Hold a key until a condition comes true."""
        self.until(Grip(lambda: self.key(key, True), lambda: self.key(key, False),
                        lambda: self.operator.view().status, condition), what=what)

    def view(self, name=CAN):
        return self.operator.robot_view(name)

    def sentence(self, name):
        """Return what the tile of a robot says."""
        return self.presenter.windows[name].hud.sentence if name in self.presenter.windows else ''

    def rest(self):
        self.until(lambda: not any(self.view(name).moving for name in (CAN, CANNOT)),
                   what='both to stand')


@pytest.fixture(scope='module')
def session():
    running = Sideways()
    running.presenter.screen.stage.set_style('all')
    yield running
    running.close()


@pytest.fixture(autouse=True)
def tidy(session):
    """Begin at rest, without a brake."""
    session.operator.brake(False)
    session.operator.request_limits(LEFT_MPS, 1.0)
    if session.operator.view().mode != VIRTUAL_JOYSTICK:
        session.operator.request_mode(VIRTUAL_JOYSTICK)
    session.select(CAN, CANNOT)
    session.rest()
    yield
    for key in (Qt.Key_Q, Qt.Key_E, Qt.Key_W):
        session.key(key, False)
    session.rest()


def went_left(session, mps=LEFT_MPS):
    """Return whether the robot that can moves to the left at that speed by its odometry."""
    moves = session.view().lateral_mps
    return moves is not None and abs(moves - mps) < 0.25 * abs(mps)


def nothing_sideways(session, since):
    """Return whether the robot that cannot was sent nothing of that."""
    return not any(item.value[1] for item in session.sent[CANNOT].since(since))


def test_the_brake_stops_it_before_the_wall_on_its_left(session):
    session.select(CAN)
    session.operator.brake(True)
    session.until(lambda: session.view().brake.word == 'on', what='the brake')
    session.hold(Qt.Key_Q, lambda: went_left(session), 'it to go sideways')
    session.hold(Qt.Key_Q, lambda: session.view().brake.word == 'slows'
                 and not session.view().moving and session.view().brake.free_way_m
                 == pytest.approx(0.08, abs=0.04), 'it to stand before the wall, by its margin')
    session.key(Qt.Key_Q, False)
    left_m = session.view().y_m
    session.hold(Qt.Key_E, lambda: session.view().y_m < left_m - 1.0, 'it to go away from there')


def test_by_keys(session):
    key, mps, begun = Qt.Key_E, -LEFT_MPS, time.monotonic()
    session.hold(key, lambda: went_left(session, mps), 'it to go sideways')
    session.hold(key, lambda: Reason(NOT_SIDEWAYS).what in session.sentence(CANNOT),
                 'the other to say that it cannot')
    session.hold(key, lambda: not session.view(CANNOT).moving and not session.view(CAN).why
                 and went_left(session, mps), 'one to go, the other to stand')
    session.key(key, False)
    session.rest()
    session.until(lambda: not any(session.sent[CAN].last()), what='the zero')
    assert nothing_sideways(session, begun)
    assert all(abs(item.value[1]) <= LEFT_MPS + 1e-6 for item in session.sent[CAN].since(begun))
