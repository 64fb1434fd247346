# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What every input node promises, whatever its driver does."""
import itertools
import threading
import time
import unittest

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import rospy

from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reader, Reading
from mhri.devices.ros.input_node import InputNode
from mhri.srv import SetSuspended

from support.input_nodes import joy_recorder
from support.own_node import own_node
from support.ros_system import wait_for
from support.node_tools import measured, Recorder

system = own_node('input_node')

NUMBERS = itertools.count()
PUSHED = Reading((0.5, 1.0), (1, 0), 'lab', (0.0, -1.0))


class Played(Reader):
    """A device that does what it is told: ``opens`` and ``reads`` are called for what to answer."""

    kind = 'toy'

    def __init__(self):
        self.finds = lambda: 'Toy of the lab'
        self.opens = lambda: 'a toy'
        self.reads = lambda timeout_s: None
        self.opened = 0
        self.closed = 0
        self.threads = set()

    def find(self):
        """Answer."""
        self.threads.add(threading.current_thread())
        return self.finds()

    def open(self):
        """Count, and answer."""
        self.opened += 1
        self.threads.add(threading.current_thread())
        return self.opens()

    def read(self, timeout_s):
        """Answer, as fast as the answer is."""
        self.threads.add(threading.current_thread())
        answer = self.reads(timeout_s)
        if isinstance(answer, Exception):
            raise answer
        if answer is None:
            threading.Event().wait(timeout_s)
        return answer

    def close(self):
        """Count."""
        self.threads.add(threading.current_thread())
        self.closed += 1


class InputNodes(unittest.TestCase):
    """Every test has a node of its own, on topics of its own."""

    def setUp(self):
        """Start a node, suspended."""
        name = '/toy_{}'.format(next(NUMBERS))
        self.reader = Played()
        self.go_on = threading.Event()
        self.node = InputNode(self.reader, name + '/joy', name + '/set_suspended')
        self.joys = joy_recorder(name + '/joy')
        self.node.start()
        self.joys.wait_publisher()
        self.there = Recorder(name + '/device_state', DiagnosticStatus, lambda message: (
            message.level, message.hardware_id, message.message))
        rospy.wait_for_service(name + '/set_suspended', 10.0)
        self.set_suspended = rospy.ServiceProxy(name + '/set_suspended', SetSuspended)

    def tearDown(self):
        """Let a blocked driver go; drivers are called on one thread alone."""
        self.go_on.set()
        self.node.close()
        self.assertEqual(len(self.reader.threads), 1)
        self.joys.close()
        self.there.close()

    def _blocked(self, *_):
        """Be a driver that does not come back; then one that brings home something old."""
        self.go_on.wait(20.0)
        return PUSHED

    def _push(self):
        """Resume, and have the stick seen pushed."""
        self.reader.reads = lambda timeout_s: PUSHED
        begun = time.monotonic()
        self.assertTrue(self.set_suspended(False).success)
        self.joys.wait(lambda value: value.axes == PUSHED.axes, begun)

    def _neutral(self, begun, words):
        """Check that one neutral message comes, and nothing after it; return it."""
        first = self.joys.wait(lambda value: value.axes == (0.0, -1.0), begun)
        self.assertEqual((first.value.buttons, first.value.frame), ((0, 0), 'profile:lab lost'))
        self.joys.wait_silence(0.4)
        self.assertEqual(self.joys.since(first.at), [first])
        measured(words, first.at - begun)
        return first

    def test_starts_suspended_and_touches_nothing(self):
        """Not even to look."""
        self.joys.wait_silence(0.5)
        self.assertEqual((self.reader.opened, self.joys.since(0.0)), (0, []))
        self.assertEqual(self.set_suspended(True).message, 'suspended: no toy is open')

    def _said(self, level, device, note):
        """Wait for what is said of the device."""
        self.there.wait_newest((level, device, note))

    def test_it_says_which_device_is_there(self):
        """Suspended or not, on every change."""
        ok, warn, stale = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.STALE
        self._said(ok, 'Toy of the lab', '')
        self.assertEqual(self.reader.opened, 0)

        def nothing():
            raise DeviceAbsent('plug the toy in')
        self.reader.finds = self.reader.opens = nothing
        self._said(warn, '', 'plug the toy in')
        self.assertTrue(self.set_suspended(False).success)
        wait_for(lambda: self.reader.opened, what='not opened')
        self.reader.opens = lambda: setattr(self.reader, 'name', 'Toy') or 'Toy with all its wheels'
        self.reader.reads = lambda timeout_s: PUSHED
        self._said(ok, 'Toy', '')
        self.reader.note = 'wind it up'
        self._said(ok, 'Toy', 'wind it up')
        self.reader.reads = lambda timeout_s: DeviceLost('it ran away')
        self.reader.opens = nothing
        self._said(warn, '', 'plug the toy in')
        self.reader.finds = lambda: ''
        self.assertTrue(self.set_suspended(True).success)
        self._said(stale, '', '')
        begun = time.monotonic()
        self.reader.finds = lambda: 1 / 0
        self.there.wait(lambda value: 'ZeroDivisionError' in value[2], begun)

    def test_a_driver_that_hangs_does_not_delay_the_neutral_on_suspend(self):
        """Nor does what it brings home later move anything."""
        self._push()
        entered = threading.Event()
        self.reader.reads = lambda timeout_s: entered.set() or self._blocked()
        self.assertTrue(entered.wait(10.0))
        begun = time.monotonic()
        answer = self.set_suspended(True)
        measured('answer of the service', time.monotonic() - begun)
        self.assertTrue(answer.success)
        neutral = self._neutral(begun, 'hanging driver: suspend to neutral')
        self.assertLess(neutral.at - begun, 0.5)
        closed = self.reader.closed
        self.go_on.set()
        wait_for(lambda: self.reader.closed > closed, what='the device stays open')
        self.joys.wait_silence(0.4)
        self.assertEqual(self.joys.last().axes, (0.0, -1.0))

    def test_a_driver_that_hangs_on_opening_does_not_hold_up_the_service(self):
        """It says that it looks, and after two seconds that the driver hangs."""
        self.reader.opens = lambda: self._blocked() and 'late'
        begun = time.monotonic()
        self.assertEqual(self.set_suspended(False).message, 'looking for a toy')
        measured('answer of the service', time.monotonic() - begun, 1.0)
        wait_for(lambda: 'has not answered' in self.set_suspended(False).message, what='not said')
        self.assertTrue(self.set_suspended(True).success)
        self.go_on.set()
        wait_for(lambda: self.reader.closed == 1, what='the device stays open')
        self.assertEqual(self.joys.since(0.0), [])

    def test_lost_is_one_neutral_then_nothing_then_found_again(self):
        """Whatever the driver raises; the silence is longer than the mux waits for neutral."""
        self._push()
        begun = time.monotonic()
        self.reader.reads = lambda timeout_s: DeviceLost('it was pulled')
        neutral = self._neutral(begun, 'lost to neutral')
        # Silence alone would take half a second.
        self.assertLess(neutral.at - begun, 0.4)
        self.assertIn('it was pulled', self.set_suspended(False).message)
        self.reader.reads = lambda timeout_s: PUSHED
        back = self.joys.wait(lambda value: value.axes == PUSHED.axes, neutral.at)
        silent_s = back.value.stamp - neutral.value.stamp
        self.assertGreater(measured('silence after a loss', silent_s), 0.6)
        begun = time.monotonic()
        self.reader.reads = lambda timeout_s: ZeroDivisionError('a slip')
        self._neutral(begun, 'failed to neutral')
        self.assertIn('ZeroDivisionError: a slip', self.set_suspended(False).message)
        begun = time.monotonic()
        self.reader.reads = lambda timeout_s: PUSHED
        self.joys.wait(lambda value: value.axes == PUSHED.axes, begun)

    def test_without_a_reading_there_is_nothing_to_make_neutral(self):
        """A device that has not been heard of yet has no axes to publish."""
        self.set_suspended(False)
        wait_for(lambda: 'reading a toy' in self.set_suspended(False).message, what='not open')
        self.reader.reads = lambda timeout_s: DeviceLost('pulled')
        wait_for(lambda: 'pulled' in self.set_suspended(False).message, what='not lost')
        self.assertTrue(self.set_suspended(True).success)
        self.joys.wait_silence(0.4)
        self.assertEqual(self.joys.since(0.0), [])

    def test_absent_is_looked_for_once_a_second_and_said(self):
        """The diagnostics warn, and name what was looked for."""
        def absent():
            raise DeviceAbsent('none on the table')
        self.reader.opens = absent
        diagnostics = Recorder('/diagnostics', DiagnosticArray, lambda message: [
            (status.level, status.message) for status in message.status])
        begun = time.monotonic()
        self.set_suspended(False)
        wait_for(lambda: self.reader.opened >= 4, what='does not look again')
        self.assertGreater(measured('four looks', time.monotonic() - begun), 2.5)
        diagnostics.wait(lambda entries: (
            DiagnosticStatus.WARN, 'looking for a toy: none on the table') in entries)
        diagnostics.close()

    def test_told_the_same_again_changes_nothing(self):
        """The mux asks again where it hears nothing."""
        self._push()
        begun = time.monotonic()
        for _ in range(20):
            self.assertTrue(self.set_suspended(False).success)
        wait_for(lambda: len(self.joys.since(begun)) > 10, what='falls silent')
        self.assertEqual({item.value.axes for item in self.joys.since(begun)}, {PUSHED.axes})
        self.assertEqual(self.reader.opened, 1)
        for _ in range(3):
            self.assertTrue(self.set_suspended(True).success)
        self._neutral(begun, 'suspended three times')

    def test_suspended_and_resumed_at_once_is_a_new_session(self):
        """The neutral in between is not lost, and the mux has time to find the source silent."""
        self._push()
        begun = time.monotonic()
        self.set_suspended(True)
        self.set_suspended(False)
        neutral = self.joys.wait(lambda value: value.axes == (0.0, -1.0), begun)
        back = self.joys.wait(lambda value: value.axes == PUSHED.axes, neutral.at)
        self.assertGreater(back.value.stamp - neutral.value.stamp, 0.6)
        self.assertEqual((self.reader.opened, self.reader.closed), (2, 1))

    def test_an_ending_node_says_neutral_and_refuses(self):
        """As at SIGTERM."""
        self._push()
        begun = time.monotonic()
        self.node.close()
        self._neutral(begun, 'closed to neutral')
        self.assertFalse(self.set_suspended(False).success)
