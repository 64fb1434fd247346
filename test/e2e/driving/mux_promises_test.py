#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Each promise of "Driving: what the mux promises", by name, to a mux on a real master.

What counts is what a robot is sent, at a velocity topic that this test listens to.
"""
import os
import sys
import threading
import time
import unittest

from geometry_msgs.msg import Twist
import rospy
import rostest
from std_srvs.srv import SetBool

from mhri.msg import ControlMode
from mhri.srv import SetSuspended

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..'))


from support import graph  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402
from support.node_tools import (  # noqa: E402
    advice_recorder, FORWARD, measured, moves, NEUTRAL, Process, Recorder, rests, state_recorder,
    Stick, StickProcess, TIMEOUT_S, velocity)
from support.ros_system import wait_for  # noqa: E402

# Commands are 50 ms apart: none for so long, and none comes any more [s].
OVER_S = 0.25


class InputNode:
    """The service of an input node; notes what it was asked, and may hang."""

    def __init__(self, name):
        self.calls = []
        self.go_on = threading.Event()
        self.go_on.set()
        self._service = rospy.Service(name + '/set_suspended', SetSuspended, self._on_call)

    def _on_call(self, request):
        self.calls.append((time.monotonic(), request.suspended))
        self.go_on.wait(TIMEOUT_S)
        return True, 'suspended' if request.suspended else 'reading'

    def wait(self, suspended, start):
        """Wait for a call after a time; return when it came."""
        return wait_for(lambda: [at for at, value in self.calls
                                 if at >= start and value == suspended],
                        what=lambda: 'not called: {}'.format(self.calls))[0]

    def close(self):
        """Take the service away."""
        self.go_on.set()
        self._service.shutdown()


class MuxPromises(unittest.TestCase):
    """One operator, two sticks, one mux, a robot that is driven."""

    @classmethod
    def setUpClass(cls):
        """Open everything once; connections take longer than tests."""
        rospy.set_param('/bot1/robot_type', 'generic')
        rospy.set_param('/mhri/robots', ['bot1'])
        cls.twists = Recorder('/bot1/cmd_vel', Twist, velocity)
        cls.operator, cls.state = FakeOperator(), StateEar()
        cls.modes = Recorder(graph.MODE, ControlMode, lambda message: message.source)
        cls.waits = state_recorder('waits_for')
        cls.advice = advice_recorder()
        cls.stick, cls.pedal = (Stick('/mux_in/' + name) for name in ('joy', 'pedal'))
        cls.select = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=10)
        cls.set_stop = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)
        cls.set_stop.wait_for_service(TIMEOUT_S)
        for stick in (cls.stick, cls.pedal):
            stick.wait_listener()
        wait_for(lambda: cls.select.get_num_connections(),
                 what='the mux does not listen')
        for recorder in (cls.twists, cls.modes):
            recorder.wait_publisher()
        cls.operator.check('bot1')

    def setUp(self):
        """Begin each promise with the virtual joystick in force, silent, and nothing moving."""
        self.pedal.silence()
        self.state.wait_robot('bot1', lambda robot: robot.obeys == 'operator', 'the selection')
        self._mode('joy')
        self.stick.hold(NEUTRAL)
        self.waits.settle('', 'release')
        wait_for(lambda: self.set_stop(False).success, what='the release', poll_s=0.02)
        self.state.wait_robot('bot1', lambda robot: not robot.stands, 'the robot to be ready')
        self.stick.silence()
        self.twists.wait_silence(OVER_S)

    def _mode(self, name):
        """Select a source; return when."""
        now = time.monotonic()
        self.select.publish(source=name)
        self.modes.wait_newest(name)
        return now

    def _drive(self, stick=None):
        """Make the robots move; return when the first command came."""
        return (stick or self.stick).set_out(self.waits, self.twists)

    def test_changed_mode_zero_at_once_20_hz_then_silence(self):
        """And the mode in force says so; a pedal held meanwhile drives once it was centred."""
        self.pedal.hold(FORWARD)
        self._drive()
        begun = time.monotonic()
        self.select.publish(source='pedal')
        first = self.twists.wait(rests, begun)
        measured('first zero after a changed mode', first.at - begun, 0.05)
        self.twists.wait_zeros(first)
        self.waits.settle('neutral')
        self.assertEqual(self.modes.last(), 'pedal')
        self._drive(self.pedal)

    def test_a_second_publisher_of_a_source_drives_neither_while_the_first_is_silent_nor_lost(self):
        self._mode('pedal')
        self._drive(self.pedal)
        second = StickProcess(graph.PEDAL, 'second_pedal')
        self.addCleanup(second.process.end)
        second.hold(FORWARD)
        self.advice.wait(lambda said: said == ('rival', '/second_pedal'))
        for way in ('silent', 'lost'):
            with self.subTest(first=way):
                if way == 'lost':
                    with self.pedal.frame(' lost'):
                        self.pedal.once(NEUTRAL)
                begun = self.pedal.silence()
                self.twists.wait(rests, begun)
                for axes in (NEUTRAL, FORWARD, NEUTRAL, FORWARD):
                    second.hold(axes)
                    rospy.rostime.wallsleep(0.5)
                self.assertEqual(self.waits.last(), 'source')
                first = self.twists.wait(rests, begun).at
                self.assertFalse([item for item in self.twists.since(first) if moves(item.value)])
                self._drive(self.pedal)

    def test_mode_is_latched_and_owned_by_the_mux(self):
        """Whoever comes late hears it; an unknown one changes nothing."""
        self._mode('pedal')
        self.select.publish(source='telepathy')
        late = Recorder(graph.MODE, ControlMode, lambda message: message.source)
        self.assertEqual(late.wait(lambda value: True, 0.0).value, 'pedal')
        late.close()
        self._mode('joy')
        self.assertNotIn('telepathy', [item.value for item in self.modes.since(0.0)])

    def test_the_mode_is_chosen_by_the_operator_or_an_input_node_and_by_nobody_else(self):
        def ask(name):
            asking = Process(['rostopic', 'pub', '-r', '10', graph.MODE_SELECT,
                              'mhri/ControlMode', 'pedal', '__name:=' + name])
            self.addCleanup(asking.end)
            return asking
        ask('stranger')
        self.state.wait(lambda state: any('/stranger: /mux_in/mode_select' in line
                                          for line in state.refused), 'the refusal')
        self.assertEqual(self.modes.last(), 'joy')
        voice = ask('mhri_voice')
        self.modes.wait_newest('pedal')
        voice.end()
        # What is merely repeated in the wish chooses nothing.
        for mode in ('joy', 'voice', 'joy'):
            begun = time.monotonic()
            for _ in range(10):
                self.operator.select.publish(robots=['bot1'], mode=mode)
                rospy.rostime.wallsleep(0.02)
            self.modes.wait_newest(mode)
            self.assertLessEqual(len(self.modes.since(begun)), 1)

    def _input_node(self, name):
        """Return the service of an input node, which goes with the test."""
        node = InputNode(name)
        self.addCleanup(node.close)
        return node

    def test_set_suspended_is_called_on_entering_and_leaving(self):
        """Resumed when its mode begins, also where it starts later, suspended when that ends."""
        pedal = self._input_node('/mhri_pedal')
        begun = self._mode('pedal')
        measured('mode to resumed device', pedal.wait(False, begun) - begun)
        left = self._mode('voice')
        measured('mode to suspended device', pedal.wait(True, left) - left)
        for what in ('late', 'restarted'):
            begun = time.monotonic()
            voice = self._input_node('/mhri_voice')
            measured(what + ' device to resumed', voice.wait(False, begun) - begun)
            voice.close()
        self.assertFalse([call for call in pedal.calls if call[0] > left and not call[1]])

    def test_a_hanging_input_node_keeps_no_other_from_being_resumed(self):
        """And a mode that changes meanwhile is obeyed as soon as it has answered."""
        pad, pedal = self._input_node('/mhri_joy'), self._input_node('/mhri_pedal')
        pad.wait(False, self._mode('ps3joy'))
        pad.go_on.clear()
        begun = self._mode('pedal')
        pad.wait(True, begun)
        pedal.wait(False, begun)
        self._mode('ps3joy')
        begun = time.monotonic()
        pad.go_on.set()
        pad.wait(False, begun)


if __name__ == '__main__':
    rospy.init_node('mux_promises')
    rostest.rosrun('mhri', 'mux_promises', MuxPromises, sys.argv)
