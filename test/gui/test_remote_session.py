# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A display that is forwarded freezes while a key or the knob is held: the robot stops.

The display is one that ssh could have forwarded: an X server on localhost, over the network. Frozen
it says that the key is down, as the server of a VNC does, and nothing comes.
"""
import ctypes
import os
import subprocess
import sys
import time

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.graph import STICK  # noqa: E402
from support.panel_session import PanelSession  # noqa: E402

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
        self.until(self.robot.live, what='the robot')
        self.host.screen.activateWindow()
        self.hands.click('check_bot1')
        self.until(lambda: self.operator.view().status.endswith('ready'), what='ready')

    def keys_down(self):
        """Tell whether the server says that any key is down."""
        keys = (ctypes.c_char * 32)()
        self._x.XQueryKeymap(self._display, keys)
        return any(keys.raw)

    def freeze(self, frozen):
        """Have the server say nothing of a key that is pressed now and held, or all as usual."""
        (self._x.XAutoRepeatOff if frozen else self._x.XAutoRepeatOn)(self._display)
        self._x.XSync(self._display, 0)

    @staticmethod
    def xdotool(*words):
        subprocess.run(('xdotool',) + words, check=True, timeout=30)

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
        return sum(event.kind == 'stick.let_go' for event in self.host.events.log.events)

    def held_for(self, seconds):
        since = self.held_since()
        return since is not None and time.monotonic() - since > seconds


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
    session.xdotool('keyup', 'a', 'keyup', 'w', 'mouseup', '1')
    session.until(lambda: session.sticks and not any(session.sticks[-1][1]) and
                  session.robot.at_rest(), what='the robot to stand')


def test_a_key_that_repeats_drives_and_one_that_does_not_is_let_go(session):
    session.xdotool('keydown', 'a')
    session.until(lambda: session.held_for(2.5 * HELD_S) and session.robot.moving(),
                  what='the key to drive for longer than a second')
    session.xdotool('keyup', 'a')
    session.until(session.robot.at_rest, what='the robot to stand')
    assert session.events() == 0
    session.freeze(True)
    session.xdotool('keydown', 'a')
    session.until(session.robot.moving, HELD_S, 'the key to drive')
    begun = session.held_since()
    session.until(lambda: session.held_since() is None, HELD_S + WAY_S, 'the key to be let go')
    print('MEASURED frozen while a key was held: stick at neutral after {:.2f} s'.format(
        session.sticks[-1][0] - begun))
    session.until(session.robot.at_rest, WAY_S, 'the robot to stand')
    assert session.events() == 1
    # It is down still, and has to be let go and pressed again.
    told = len(session.sticks)
    session.until(lambda: len(session.sticks) > told + 30, what='the stick to be repeated')
    assert not any(any(axes) for _, axes in session.sticks[told:])
    session.xdotool('keyup', 'a')
    session.until(lambda: not session.keys_down(), what='the key to be up')
    session.xdotool('keydown', 'a')
    session.until(session.robot.moving, what='the key to drive again')


def test_of_two_keys_that_are_held_the_repeats_of_one_count_for_both(session):
    session.xdotool('keydown', 'a')
    session.xdotool('keydown', 'w')
    try:
        session.until(lambda: session.held_for(2.5 * HELD_S), what='both to drive')
        assert all(session.sticks[-1][1])
    finally:
        session.xdotool('keyup', 'w')


def test_the_knob_that_a_pointer_holds_still_counts_as_long(session):
    stick = session.hands.widget('joystick')
    middle = stick.rect().center()
    session.point_at(stick, middle.x(), middle.y())
    session.xdotool('mousedown', '1')
    begun = time.monotonic()
    place, across = stick.mapToGlobal(middle), 0
    while time.monotonic() - begun < 2.0 * HELD_S:
        across = 1 - across
        session.xdotool('mousemove', str(place.x() - 40 - across), str(place.y()))
        session.app.processEvents()
    session.until(lambda: session.held_for(HELD_S), 1.0, 'the knob to drive while it moves')
    frozen_at = time.monotonic()
    session.until(lambda: session.held_since() is None, HELD_S + WAY_S, 'the knob to be let go')
    print('MEASURED frozen while the knob was held: stick at neutral after {:.2f} s'.format(
        time.monotonic() - frozen_at))
    session.until(session.robot.at_rest, WAY_S, 'the robot to stand')
