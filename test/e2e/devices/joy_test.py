#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pad's node as it is shipped, with SDL's virtual joysticks as its hardware."""
import os
import signal
import statistics
import sys
import time
import unittest

import rospy
import rostest
from std_msgs.msg import Empty
from std_srvs.srv import SetBool

from mhri.devices.ros.device_state import DeviceStates

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..'))


from support import graph  # noqa: E402
from support.input_nodes import InputCase  # noqa: E402
from support.joy_tools import JoyNode, NO_PADS, PS3  # noqa: E402
from support.node_tools import measured, moves, rests  # noqa: E402
from support.ros_system import wait_for  # noqa: E402


# The dead-man button of resource/pads/ps3.yaml.
L1 = 4


@unittest.skipIf(NO_PADS, NO_PADS)
class Joy(InputCase):
    """Every test starts a node of its own."""

    def setUp(self):
        """Begin with the virtual joystick's mode, so that the mux leaves the node alone."""
        if rospy.has_param('/mhri_joy/device'):
            rospy.delete_param('/mhri_joy/device')
        super().setUp()
        self.node = JoyNode()

    def _drive(self):
        """Choose the pad, centre it, push it forward; return the number of the pad."""
        number = self.node.attach(PS3)
        begun = time.monotonic()
        self._mode('ps3joy')
        self.node.joys.wait(lambda value: True, begun, 25.0)
        self._push(number)
        return number

    def _push(self, number):
        """Centre the stick until the mux is content, then push it forward."""
        self.node.set(number, axes={0: 0.0, 1: 0.0}, buttons={L1: 1})
        self.waits.settle('')
        pushed = self.node.set(number, axes={1: -1.0})
        first = self.twists.wait(moves, pushed)
        measured('stick to Twist', first.at - pushed)

    def test_its_mode_resumes_it_another_suspends_it_and_a_signal_ends_it(self):
        """Suspended, it has no device open, and SDL is not even loaded."""
        with open('/proc/{}/maps'.format(self.node.pid), encoding='utf-8') as maps:
            self.assertNotIn('libSDL', maps.read())
        self.assertEqual((self.node.open_devices(), self.node.joys.since(0.0)), ([], []))
        number = self._drive()
        begun = time.monotonic()
        self._mode('joy')
        zero = self.twists.wait(rests, begun)
        measured('mode to zero', zero.at - begun, 0.05)
        self.node.joys.wait_silence(0.5)
        begun = time.monotonic()
        self._mode('ps3joy')
        self.node.joys.wait(lambda value: True, begun, 25.0)
        self._push(number)
        begun = time.monotonic()
        os.kill(self.node.pid, signal.SIGTERM)
        self._one_neutral(begun, 'signal to neutral', 0.5)
        self.assertEqual(self.node.process.popen.wait(60), 0)

    def test_pulled_while_driving_is_a_zero_within_50_ms(self):
        """Counted from when SDL reports it; after that nothing moves until neutral is seen."""
        number, took = self._drive(), []
        for _ in range(3):
            pulled = self.node.detach(number)
            zero = self.twists.wait(rests, pulled)
            took.append(measured('pulled to first zero Twist', zero.at - pulled))
            self.node.joys.wait_silence(0.5)
            self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)])
            number = self.node.attach(PS3, axes={1: -1.0})
            self.node.set(number, buttons={L1: 1})
            back = self.node.joys.wait(lambda value: value.axes[1] < -0.9, zero.at + 0.5)
            wait_for(lambda: len(self.node.joys.since(back.at)) > 5, what='does not repeat')
            self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)],
                             'a pad that came back with a deflected stick drives')
            self._push(number)
        self.assertLess(min(took), 0.05)
        # Silence alone would take half a second.
        self.assertLess(statistics.median(took), 0.4)

    def test_a_killed_node_is_a_zero_within_550_ms(self):
        """The mux's clock notices the silence, and the screen does not name the pad any longer."""
        states = DeviceStates()
        states.follow({'ps3joy': '/mhri_joy/set_suspended'})
        self.addCleanup(states.unregister)
        self._drive()
        wait_for(lambda: [view.name for view in states.views()] == [PS3], what='not shown')
        wait_for(lambda: moves(self.twists.last()), what='does not drive')
        killed = time.monotonic()
        os.kill(self.node.pid, signal.SIGKILL)
        zero = self.twists.wait(rests, killed)
        measured('killed node to first zero', zero.at - killed, 0.55)
        wait_for(lambda: not states.views(), what='still shown')

    def test_rumble_means_stopped_or_lost(self):
        """At the edge of stop-all, and when the panel says that a robot is lost; never else."""
        self.node.attach(PS3)
        self.node.resume()
        self.node.joys.wait(lambda value: True, 0.0, 25.0)
        lost = rospy.Publisher('/mhri_joy/rumble', Empty, queue_size=1)
        wait_for(lost.get_num_connections, what='nobody listens')
        set_stop = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)
        self.assertEqual(self._shakes(), 0)
        lost.publish()
        self._wait_shakes(1, 'a lost robot')
        self.assertTrue(set_stop(True).success)
        self._wait_shakes(2, 'stop-all')
        self.assertTrue(set_stop(True).success)
        lost.publish()
        # Would stop-all that was in force already shake, this would be the fourth.
        self._wait_shakes(3, 'a lost robot')

    def _shakes(self):
        """Return how often the pad was shaken; the ends of shakes are not counted."""
        return len([entry for entry in self.node.do('rumbles') if entry[1]])

    def _wait_shakes(self, count, words):
        """Wait until it has been shaken so often, and the last time is over."""
        wait_for(lambda: self._shakes() >= count, what='{} does not shake'.format(words))
        wait_for(lambda: not self.node.do('rumbles')[-1][1], what='the shake does not end')
        self.assertEqual(self._shakes(), count, words)


if __name__ == '__main__':
    rospy.init_node('joy')
    rostest.rosrun('mhri', 'joy', Joy, sys.argv)
