#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The input nodes are resumed and suspended as the mode enters and leaves them."""
import sys
import threading
import time
import unittest

from rostest_tools import measured, Recorder, wait_until
import rospy
import rostest

from mhri.msg import ControlMode
from mhri.srv import SetSuspended


class InputNode:
    """The service of an input node; notes what it was asked, and may hang."""

    def __init__(self, name):
        self.calls = []
        self.go_on = threading.Event()
        self.go_on.set()
        self._service = rospy.Service(name + '/set_suspended', SetSuspended, self._on_call)

    def _on_call(self, request):
        self.calls.append((time.monotonic(), request.suspended))
        self.go_on.wait(8.0)
        return True, 'suspended' if request.suspended else 'reading'

    def wait(self, suspended, start, within_s=5.0):
        """Wait for a call after a time; return when it came."""
        found = []

        def called():
            found[:] = [at for at, value in self.calls if at >= start and value == suspended]
            return bool(found)
        wait_until(called, 'not called: {}'.format(self.calls), within_s)
        return found[0]

    def close(self):
        """Take the service away."""
        self.go_on.set()
        self._service.shutdown()


class MuxSuspend(unittest.TestCase):
    """A pedal that runs from the start, and a voice node that comes late."""

    def setUp(self):
        """Begin with the virtual joystick, which has nothing to suspend."""
        self.modes = Recorder('/mux/mode', ControlMode, lambda message: message.source)
        self.select = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        wait_until(self.select.get_num_connections, 'the mux does not listen')
        self.modes.wait_publisher()
        self._mode('joy')
        self.nodes = []

    def tearDown(self):
        """Take every service away."""
        for node in self.nodes:
            node.close()
        self.modes.close()

    def _node(self, name):
        self.nodes.append(InputNode(name))
        return self.nodes[-1]

    def _mode(self, name):
        now = time.monotonic()
        self.select.publish(source=name)
        self.modes.wait(lambda _: self.modes.last() == name)
        return now

    def test_set_suspended_is_called_on_entering_and_leaving(self):
        """Resumed when its mode begins, suspended when it ends."""
        pedal = self._node('/mhri_pedal')
        begun = self._mode('pedal')
        measured('mode to resumed device', pedal.wait(False, begun) - begun)
        begun = self._mode('joy')
        measured('mode to suspended device', pedal.wait(True, begun) - begun)
        self.assertFalse([call for call in pedal.calls if call[0] > begun and not call[1]])

    def test_an_input_node_that_starts_late_is_resumed(self):
        """Nobody has to choose the mode again."""
        self._mode('voice')
        begun = time.monotonic()
        voice = self._node('/mhri_voice')
        self.assertLess(measured('late device to resumed', voice.wait(False, begun) - begun), 3.0)

    def test_an_input_node_that_was_restarted_is_resumed_again(self):
        """It begins suspended, and the mux has not heard from it."""
        first = self._node('/mhri_voice')
        first.wait(False, self._mode('voice'))
        first.close()
        begun = time.monotonic()
        second = self._node('/mhri_voice')
        self.assertLess(measured('restarted device to resumed', second.wait(False, begun) - begun),
                        4.0)

    def _hang_while_suspended(self, pad):
        """Drive with a pad whose node hangs as the mode leaves it for the pedal."""
        pad.wait(False, self._mode('ps3joy'))
        pad.go_on.clear()
        begun = self._mode('pedal')
        pad.wait(True, begun)
        return begun

    def test_a_hanging_input_node_keeps_no_other_from_being_resumed(self):
        """Each input node is called on a thread of its own."""
        pad, pedal = self._node('/mhri_joy'), self._node('/mhri_pedal')
        begun = self._hang_while_suspended(pad)
        pedal.wait(False, begun, 3.0)

    def test_a_mode_changed_during_a_call_is_obeyed_right_after_it(self):
        """Not only a second later."""
        pad, voice = self._node('/mhri_joy'), self._node('/mhri_voice')
        self._hang_while_suspended(pad)
        self._mode('voice')
        begun = time.monotonic()
        pad.go_on.set()
        self.assertLess(measured('wish during a call', voice.wait(False, begun) - begun), 0.5)


if __name__ == '__main__':
    rospy.init_node('mux_suspend')
    rostest.rosrun('mhri', 'mux_suspend', MuxSuspend, sys.argv)
