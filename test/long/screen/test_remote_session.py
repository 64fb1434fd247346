# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A display that is forwarded freezes while a key or the knob is held: the robot stops.

The display is one that ssh could have forwarded: an X server on localhost, over the network. Frozen
it says that the key is down, as the server of a VNC does, and nothing comes.
"""
import ctypes
import time

import pytest

from mhri.driving.gui.hands import CENTRE, READY
from support.graph import STICK
from support.keyboard import Keyboard, xdotool
from support.panel_session import PanelSession
from support.ros_system import insist

# What is held counts so long without a sign of life, and so much longer the way to the robot takes.
HELD_S, WAY_S = 1.0, 0.5


class Forwarded(PanelSession):
    """The real panel on a display of localhost, and what it says to the mux and to its robot."""

    display_host = 'localhost'

    def __init__(self):
        super().__init__((('turtlebot.launch', 'name:=bot1', 'type:=turtlebot2'),), ('bot1',))
        import rospy
        from sensor_msgs.msg import Joy
        from support.robots import Witness
        self.sticks = []
        rospy.Subscriber(STICK, Joy, lambda message: self.sticks.append(
            (time.monotonic(), tuple(message.axes))), queue_size=50)
        self.robot = Witness('bot1')
        self._x = ctypes.CDLL('libX11.so.6')
        self._x.XOpenDisplay.restype = ctypes.c_void_p
        self._display = ctypes.c_void_p(self._x.XOpenDisplay(None))
        self.keyboard = Keyboard(lambda condition, what: self.until(condition, what=what))
        self.until(self.robot.live, what='the robot')
        self.presenter.screen.activateWindow()
        self.hands.click('check_bot1')
        self.until(lambda: self.operator.view().status.endswith('ready'), what='ready')

    def freeze(self, frozen):
        """Have the server say nothing of a key that is pressed now and held, or all as usual."""
        (self._x.XAutoRepeatOff if frozen else self._x.XAutoRepeatOn)(self._display)
        self._x.XSync(self._display, 0)

    def held_since(self):
        """Return since when the stick has been away from neutral, None if it is not."""
        since = None
        for at, axes in reversed(self.sticks):
            if not any(axes):
                break
            since = at
        return since

    def events(self):
        """Return how many lines of the event list say that the stick was let go."""
        return sum(event.kind == 'stick.let_go'
                   for event in self.presenter.parts['events'].log.events)

    def held_for(self, seconds):
        since = self.held_since()
        return since is not None and time.monotonic() - since > seconds

    def hold(self, press, let_go, alive=lambda: None):
        """Drive for long."""
        def is_lost():
            alive()
            return self.operator.view().status.endswith(CENTRE) \
                or not any(self.presenter.screen.stick())

        def held():
            let_go()
            self.until(lambda: self.operator.view().status.endswith(READY), what='the mux')
            press()
            self.until(lambda: any(self.presenter.screen.stick()), what='the stick')
            self.until(lambda: is_lost() or self.held_for(2.5 * HELD_S) and self.robot.moving(),
                       what='the stick to be held')
            return not is_lost()
        insist(held, 'the stick to be held')

    def hold_keys(self, *keys):
        """Press keys one after the other, and hold them."""
        down = []
        self.hold(lambda: [down.append(xdotool('keydown', key)) for key in keys],
                  lambda: [self.keyboard.release(key) for key in keys if down])

    def until_neutral(self, what, since):
        """Wait until the stick is let go, as soon as is promised, and the robot stands."""
        from support.node_tools import measured
        self.until(lambda: self.held_since() is None, what='the stick to be let go')
        measured('frozen while {} was held: stick at neutral'.format(what),
                 next(at for at, axes in self.sticks if at > since and not any(axes)) - since,
                 HELD_S + WAY_S)
        self.until(self.robot.at_rest, what='the robot to stand')


@pytest.fixture(scope='module')
def session():
    running = Forwarded()
    yield running
    running.close()


@pytest.fixture(autouse=True)
def tidy(session):
    """Let everything go, and wait until the robot stands."""
    yield
    session.freeze(False)
    xdotool('keyup', 'a', 'keyup', 'w', 'mouseup', '1')
    session.until(lambda: session.sticks and not any(session.sticks[-1][1]) and
                  session.robot.at_rest(), what='the robot to stand')


def test_a_key_that_repeats_drives_and_one_that_does_not_is_let_go(session):
    session.hold_keys('a')
    session.keyboard.release('a')
    session.until(session.robot.at_rest, what='the robot to stand')
    session.freeze(True)
    before = session.events()
    xdotool('keydown', 'a')
    session.until_neutral('a key', session.until(session.held_since, what='the key to drive'))
    session.until(lambda: session.events() == before + 1, what='the event')
    # It is down still, and has to be let go and pressed again.
    told = len(session.sticks)
    session.until(lambda: len(session.sticks) > told + 30, what='the stick to be repeated')
    assert not any(any(axes) for _, axes in session.sticks[told:])
    session.keyboard.release('a')
    xdotool('keydown', 'a')
    session.until(lambda: any(session.presenter.screen.stick()), what='the key to count again')


def test_the_knob_that_a_pointer_holds_still_counts_as_long(session):
    stick, across = session.hands.widget('joystick'), [0]
    middle = stick.pad().center().toPoint()

    def move():
        across[0] = 1 - across[0]
        session.point_at(stick, middle.x() - 40 - across[0], middle.y())

    def press():
        session.point_at(stick, middle.x(), middle.y())
        xdotool('mousedown', '1')
        move()
    session.hold(press, lambda: xdotool('mouseup', '1'), move)
    session.until_neutral('the knob', time.monotonic())
