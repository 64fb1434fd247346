# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pedal's node as it is shipped, with stand-in foot switches and SDL's virtual joysticks."""
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import unittest

import rospy

from support import evdev_stream, graph
from support.input_nodes import InputCase, InputNode, is_neutral, START_S
from support.joy_tools import NO_PADS
from support.own_node import own_node
from support.ros_system import wait_for
from support.node_tools import measured, moves, Process, rests
from support.virtual_pad import PadProcess

system = own_node('pedal', '../../support/mux.launch')

RUDDER = 'Saitek Pro Flight Rudder Pedals'
SWITCH = ('PCsensor FootSwitch Keyboard', '3553:b001')


def clear_parameters():
    """Leave no parameter of an earlier node behind."""
    if rospy.has_param('/mhri_pedal'):
        rospy.delete_param('/mhri_pedal')


def near(value, wanted):
    """Return whether a command is the wanted one: SDL's full travel is a little less than 1."""
    return all(abs(one - other) < 1e-3 for one, other in zip(value, wanted))


class PedalNode(InputNode):
    """``mhri_pedal`` in a process, suspended, on a system without any input device.

    :param arguments: for the node, e.g. '_role:=enable'
    :param process: the process of the node, where it is another than that with foot switches
    """

    def __init__(self, *arguments, process=None):
        self._folder = evdev_stream.make_folders(tempfile.mkdtemp(prefix='mhri_pedal_'))
        # An administrator who is turned away for a test has to get that far.
        os.chmod(self._folder, 0o755)
        self.nodes = []
        super().__init__('mhri_pedal', graph.PEDAL, lambda: process or Process(
            [sys.executable, evdev_stream.__file__, self._folder] + list(arguments)))

    def plug(self, name=SWITCH[0], usb=SWITCH[1], keys=('KEY_A', 'KEY_B', 'KEY_C'), down=()):
        """Plug a foot switch in, with some of its keys held down."""
        number = len(self.nodes)
        self.nodes.append(evdev_stream.StreamNode(
            self._folder, number, name, usb, 'usb-0000:00:14.0-{}/input0'.format(number), keys,
            down))
        return self.nodes[-1]

    def wait_grabbed(self, node):
        """Wait until the node has a foot switch for itself."""
        wait_for(node.grabbed, what='not grabbed: ' + self.process.said(), timeout_s=START_S)

    def end(self):
        """Make sure that everything is gone."""
        super().end()
        for node in self.nodes:
            node.pull()
        shutil.rmtree(self._folder, ignore_errors=True)


class PedalTest(InputCase):
    """A mux, and a node of its own for each test."""

    arguments = ()

    def setUp(self):
        """Begin with the virtual joystick's mode, in which the mux suspends the pedal."""
        clear_parameters()
        super().setUp()
        self.node = self._start()

    def _start(self):
        return PedalNode(*self.arguments)

    def _ready(self):
        """Choose the pedal's mode; wait until the mux would follow a press."""
        self._mode('pedal')
        self.waits.settle('', patience_s=30.0)


class FootSwitch(PedalTest):
    """Driving with three pedals that type."""

    def _drive(self, switch):
        """Choose the mode of a switch and press forward."""
        self._ready()
        self.node.wait_grabbed(switch)
        self._press(switch)

    def _press(self, switch):
        """Press forward; return how long the robots took to be told."""
        begun = time.monotonic()
        switch.press('KEY_B')
        first = self.twists.wait(moves, begun)
        self.assertEqual(first.value, (0.5, 0.0))
        return first.at - begun

    def _hold_still(self):
        """Leave the pedal alone for a moment: right after a message the next one is held back."""
        self.node.joys.wait_silence(0.02)

    def test_press_drives_and_release_stops(self):
        """The first zero within 50 ms of the release; in another mode the switch types again."""
        switch = self.node.plug()
        self.assertFalse(switch.grabbed())
        self._drive(switch)
        pressed, released = [], []
        for _ in range(10):
            begun = time.monotonic()
            switch.release('KEY_B')
            released.append(self.twists.wait(rests, begun).at - begun)
            self._hold_still()
            pressed.append(self._press(switch))
            self._hold_still()
        measured('press to Twist, median of 10', statistics.median(pressed))
        measured('release to zero, longest of 10', max(released))
        measured('release to zero, median of 10', statistics.median(released), 0.05)
        begun = time.monotonic()
        self._mode('joy')
        zero = self.twists.wait(rests, begun)
        measured('mode to zero', zero.at - begun, 0.05)
        self.node.joys.wait_silence(0.5)
        wait_for(lambda: not switch.grabbed(), what='is still grabbed')

    def test_pulled_while_pressed_is_neutral_at_once(self):
        """And moves nothing as it is plugged in again with the foot still on it."""
        switch, took = self.node.plug(), []
        self._drive(switch)
        for _ in range(3):
            pulled = time.monotonic()
            switch.pull()
            zero = self.twists.wait(rests, pulled)
            took.append(measured('pulled to first zero Twist', zero.at - pulled))
            neutral = self.node.joys.wait(is_neutral, pulled)
            measured('pulled to neutral Joy', neutral.at - pulled)
            self.node.joys.wait_silence(0.5)
            plugged = time.monotonic()
            switch = self.node.plug(down=('KEY_B',))
            self.node.joys.wait(is_neutral, plugged)
            self.waits.settle('')
            switch.key('KEY_B', 2)
            switch.press('KEY_A')
            self.twists.wait(lambda value: value == (0.0, 1.5), plugged)
            released = time.monotonic()
            switch.release('KEY_A', 'KEY_B')
            self.assertFalse([item for item in self.twists.since(plugged) if item.value[0]])
            self.node.wait_grabbed(switch)
            self.twists.wait(rests, released)
            self.waits.settle('')
            self._press(switch)
        self.assertLess(min(took), 0.05)
        # Silence alone would take half a second.
        self.assertLess(statistics.median(took), 0.4)

    def test_choosing_among_two_while_it_runs(self):
        """Two that fit are none; a parameter chooses, and another one changes the choice."""
        first, second = self.node.plug(), self.node.plug('iKKEGOL Pedal', '1a86:e026')
        self.node.resume()
        wait_for(lambda: '2 devices fit' in self.node.words(),
                 what=self.node.words(), timeout_s=30.0)
        self.assertFalse(first.grabbed() or second.grabbed())
        rospy.set_param('/mhri_pedal/device', 'ikkegol')
        self.node.wait_grabbed(second)
        self.assertFalse(first.grabbed())
        rospy.set_param('/mhri_pedal/device', SWITCH[1])
        self.node.wait_grabbed(first)
        wait_for(lambda: not second.grabbed(), what='is still grabbed')
        rospy.set_param('/mhri_pedal/profile', 'one_pedal')
        wait_for(lambda: 'profile one_pedal' in self.node.words(),
                 what=self.node.words(), timeout_s=30.0)
        first.press('KEY_A', 'KEY_B')
        self.node.joys.wait(lambda value: value.axes == (0.0, -1.0))


class Enabling(PedalTest):
    """The pedal as a dead-man for whatever drives."""

    arguments = ('_role:=enable',)

    def test_read_in_every_mode(self):
        """It resumes by itself; the mux, which suspends what is not in force, cannot stop it."""
        switch = self.node.plug()
        self.node.wait_grabbed(switch)
        self.node.joys.wait(lambda value: value.buttons == (0, 0, 0, 0), 0.0, 30.0)
        self.assertTrue(self.node.suspend().success)
        for mode in ('pedal', 'joy'):
            self._mode(mode)
            begun = time.monotonic()
            switch.press('KEY_B')
            self.node.joys.wait(lambda value: value.buttons == (1, 0, 1, 0), begun)
            released = time.monotonic()
            switch.release('KEY_B')
            self.node.joys.wait(is_neutral, released)
        self.assertTrue(switch.grabbed())
        self.assertEqual({item.value.axes for item in self.node.joys.since(0.0)}, {(0.0, 0.0)})
        self.assertFalse([item for item in self.twists.since(0.0) if moves(item.value)])
        # The mux takes a quarter of a second of silence for a released pedal.
        begun = time.monotonic()
        switch.press('KEY_B')
        begun = self.node.joys.wait(lambda value: value.buttons[0], begun).at
        self.node.joys.wait(lambda _: len(self.node.joys.since(begun)) >= 30)
        times = [item.at for item in self.node.joys.since(begun)]
        gaps = [later - sooner for sooner, later in zip(times, times[1:])]
        self.assertLess(measured('median gap of an enabling pedal', statistics.median(gaps)), 0.1)
        measured('longest gap of an enabling pedal', max(gaps))
        pulled = time.monotonic()
        switch.pull()
        self.node.joys.wait(is_neutral, pulled)
        self._one_neutral(pulled, 'pulled to released')


@unittest.skipIf(NO_PADS, NO_PADS)
class RudderPedals(PedalTest):
    """Pedals that are a joystick, through pygame and SDL."""

    def _start(self):
        arguments = ('_device:=' + RUDDER,)
        return PedalNode(process=PadProcess(*arguments, module='mhri.nodes.mhri_pedal'))

    def _attach(self):
        number = self.node.process.do('attach', name=RUDDER, axes=3, buttons=0, vendor=0x06a3,
                                      product=0x0763)
        self._set(number, {0: -1.0, 1: -1.0, 2: 0.0})
        return number

    def _set(self, number, axes):
        self.node.process.do('set', number=number, axes=axes)
        return self.node.process.done_at

    def test_driving_and_pulling(self):
        """Toe and bar through the mux; pulled out, the robots stop at once."""
        number = self._attach()
        self._ready()
        pushed = self._set(number, {1: 1.0})
        forward = self.twists.wait(lambda value: near(value, (0.5, 0.0)), pushed)
        measured('toe to Twist', forward.at - pushed)
        self._set(number, {1: -1.0, 2: -1.0})
        self.twists.wait(lambda value: near(value, (0.0, 1.5)), pushed)
        pulled = self.node.process.do('detach', number=number)
        zero = self.twists.wait(rests, pulled)
        measured('rudder pedals pulled to zero', zero.at - pulled, 0.25)
        self.node.joys.wait_silence(0.5)


class Start(unittest.TestCase):
    """What the node refuses to start with."""

    def test_unknown_role(self):
        """A pedal that was meant to stop must not drive by a slip of the pen."""
        clear_parameters()
        command = [sys.executable, '-c', 'from mhri.nodes.mhri_pedal import main; main()',
                   '_role:=enabel']
        ended = subprocess.run(command, env=os.environ, stderr=subprocess.PIPE, timeout=60.0)
        self.assertNotEqual(ended.returncode, 0)
        self.assertIn(b"~role: expected drive or enable, got 'enabel'", ended.stderr)
