#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Each promise of "Driving: what the mux promises", by name, to a mux on a real master."""
import sys
import time
import unittest

from geometry_msgs.msg import Twist
from rostest_tools import (
    FORWARD, measured, moves, NEUTRAL, Recorder, rests, Stick, StickProcess, twist_recorder,
    velocity, wait_until)
import rospy
import rostest
from sensor_msgs.msg import Joy
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool

from mhri.msg import ControlMode

DRIVE = (0.5, 0.0)
# Commands are 50 ms apart: none for so long, and none comes any more [s].
OVER_S, SILENCE_S = 0.25, 0.5


class MuxPromises(unittest.TestCase):
    """One operator, two sticks, one mux."""

    @classmethod
    def setUpClass(cls):
        """Open everything once; connections take longer than tests."""
        cls.twists = twist_recorder()
        cls.modes = Recorder('/mux/mode', ControlMode, lambda message: message.source)
        cls.stops = Recorder('/robot_controller/stop_all', Bool, lambda message: message.data)
        cls.waits = Recorder('/mux/waits_for', String, lambda message: message.data)
        cls.asked = Recorder('/mux/asked', Twist, velocity)
        cls.advice = Recorder('/mux/advice', String, lambda message: message.data)
        cls.stick, cls.pedal = (Stick('/mux_in/' + name) for name in ('joy', 'pedal'))
        cls.select = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        cls.set_stop = rospy.ServiceProxy('/mux/set_stop_all', SetBool)
        cls.set_stop.wait_for_service(10.0)
        for stick in (cls.stick, cls.pedal):
            stick.wait_listener()
        wait_until(lambda: cls.select.get_num_connections(),
                   'the mux does not listen')
        for recorder in (cls.twists, cls.asked, cls.modes, cls.stops):
            recorder.wait_publisher()

    def setUp(self):
        """Begin each promise with the virtual joystick in force, silent, and nothing moving."""
        self.pedal.silence()
        self._mode('joy')
        self.stick.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() in ('', 'release'))
        self.set_stop(False)
        self.stick.silence()
        self.twists.wait_silence(OVER_S)

    def _mode(self, name):
        """Select a source; return when."""
        now = time.monotonic()
        self.select.publish(source=name)
        self.modes.wait(lambda _: self.modes.last() == name)
        return now

    def _drive(self, stick=None):
        """Make the robots move; return when the first command came."""
        stick = stick or self.stick
        stick.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        now = stick.hold(FORWARD)
        return self.twists.wait(moves, now).at

    def _assert_stops(self, begun, within_s, what):
        """A zero at once, zeros at 20 Hz for 0.5 s, then silence; nothing moves meanwhile."""
        first = self.twists.wait(rests, begun)
        self.assertLess(measured('first zero after ' + what, first.at - begun), within_s)
        last = self.twists.wait_silence(SILENCE_S)
        zeros = self.twists.since(first.at)
        self.assertTrue(all(rests(item.value) for item in zeros), zeros)
        self.assertTrue(0.40 <= last.at - first.at <= 0.56, zeros)
        self.assertTrue(9 <= len(zeros) <= 12, zeros)

    def test_only_the_active_source_drives(self):
        """Every message of another source is ignored."""
        self.pedal.hold(NEUTRAL)
        self.pedal.hold(FORWARD)
        self._drive()
        self.stick.hold((0.0, 0.5))
        start = self.twists.wait(lambda value: value == (0.25, 0.0)).at
        self.twists.wait(lambda _: len(self.twists.since(start)) > 30)
        self.assertEqual({item.value for item in self.twists.since(start)}, {(0.25, 0.0)})

    def test_published_at_once(self):
        """Not at the next tick of 20 Hz: the median of a hundred is far below it."""
        self._drive()
        self.stick.silence()
        taken = []
        for number in range(100):
            axes = (0.0, 0.5 + number / 250.0)
            sent = self.stick.once(axes)
            got = self.twists.wait(lambda value: abs(value[0] - axes[1] / 2.0) < 1e-6, sent)
            taken.append(got.at - sent)
        taken.sort()
        measured('stick event to command, p99', taken[98])
        self.assertLess(measured('stick event to command, p50', taken[50]), 0.010)

    def test_repeated_at_20_hz_while_fresh(self):
        """A stick held still sends nothing new."""
        self._drive()
        sent = self.stick.silence()
        stop = self.twists.wait(rests, sent).at
        repeats = [item.at for item in self.twists.since(sent + 0.03) if item.at < stop]
        self.assertTrue(8 <= len(repeats) <= 10, repeats)
        gaps = [later - sooner for sooner, later in zip(repeats, repeats[1:])]
        self.assertLess(measured('longest gap between repetitions', max(gaps)), 0.075)

    def test_screens_are_told_the_command_but_not_each_time(self):
        """At the begin and the end at once, between them often enough to show."""
        begun = self._drive()
        self.asked.wait(moves, begun - 0.1)
        moved = self.stick.silence()
        for number in range(100):
            self.stick.once((0.0, 0.5 + number / 250.0))
            self.twists.wait(lambda value: abs(value[0] - 0.25 - number / 500.0) < 1e-6, moved)
        told = self.asked.since(moved)
        self.assertLess(len(told), 5 + 20 * (time.monotonic() - moved))
        self.assertLess(len(told), len(self.twists.since(moved)))
        self.asked.wait(lambda value: abs(value[0] - 0.448) < 1e-6, moved)
        released = self.stick.hold(NEUTRAL)
        measured('screens told of the end', self.asked.wait(rests, released).at - released)

    def test_silent_source_zero_within_550_ms(self):
        """Counted from its last message."""
        self._drive()
        self._assert_stops(self.stick.silence(), 0.55, 'a silent source')

    def test_killed_source_zero_within_550_ms(self):
        """SIGKILL of the process that holds the stick."""
        self._mode('voice')
        source = StickProcess('/mux_in/voice')
        try:
            source.hold(NEUTRAL)
            self.waits.wait(lambda _: self.waits.last() == '')
            source.hold(FORWARD)
            self.twists.wait(moves, time.monotonic())
            self._assert_stops(source.process.send(9), 0.55, 'SIGKILL of the source')
        finally:
            source.process.end()

    def test_released_stick_zero_at_once_then_silence(self):
        """Although the stick goes on saying neutral."""
        self._drive()
        begun = self.stick.hold(NEUTRAL)
        first = self.twists.wait(rests, begun)
        self.assertLess(measured('first zero after a released stick', first.at - begun), 0.05)
        self.assertLess(self.twists.wait_silence(SILENCE_S).at - begun, 0.56)

    def test_changed_mode_zero_at_once_20_hz_then_silence(self):
        """And the mode in force says so."""
        self._drive()
        begun = time.monotonic()
        self.select.publish(source='pedal')
        self._assert_stops(begun, 0.05, 'a changed mode')
        self.assertEqual(self.modes.last(), 'pedal')

    def test_stop_all_zero_at_once_20_hz_then_silence(self):
        """Latched, with the stick still held."""
        self._drive()
        begun = time.monotonic()
        answer = self.set_stop(True)
        measured('answer of /mux/set_stop_all', time.monotonic() - begun)
        self.assertTrue(answer.success)
        self._assert_stops(begun, 0.05, 'stop-all')
        self.assertEqual(self.stops.last(), True)

    def test_neutral_interlock_after_a_changed_mode(self):
        """The pedal held while it becomes active moves nothing until it was released."""
        self.pedal.hold(FORWARD)
        begun = self._mode('pedal')
        self._assert_interlock(self.pedal, begun)

    def test_neutral_interlock_after_a_stale_source(self):
        """The stick that comes back out of range comes back held."""
        self._drive()
        self.twists.wait(rests, self.stick.silence())
        self._assert_interlock(self.stick, self.stick.hold(FORWARD))

    def test_neutral_interlock_after_a_newly_connected_device(self):
        """The node of a device is started again, with the stick held."""
        self._mode('voice')
        first = StickProcess('/mux_in/voice', 'the_device')
        self.addCleanup(first.process.end)
        first.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        first.hold(FORWARD)
        self.twists.wait(moves, time.monotonic())
        begun = first.process.send(9)
        second = StickProcess('/mux_in/voice', 'the_device')
        self.addCleanup(second.process.end)
        self.twists.wait(rests, begun)
        second.hold(FORWARD)
        self.waits.wait(lambda _: self.waits.last() == 'neutral', begun)
        self._assert_interlock(second, begun)

    def test_a_second_publisher_of_a_source_drives_neither_while_the_first_is_silent_nor_lost(self):
        self._mode('pedal')
        self._drive(self.pedal)
        second = StickProcess('/mux_in/pedal', 'second_pedal')
        self.addCleanup(second.process.end)
        second.hold(FORWARD)
        self.advice.wait(lambda words: '/second_pedal publishes /mux_in/pedal as well' in words)
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

    def test_a_second_virtual_joystick_is_refused_until_the_first_has_gone(self):
        """Two panels: they must not take turns; the second one is named."""
        first = StickProcess('/mux_in/joy', 'first_panel')
        try:
            self._drive()
            first.hold((0.0, -1.0))
            self.advice.wait(lambda words: '/first_panel publishes /mux_in/joy as well' in words)
            start = time.monotonic()
            self.twists.wait(lambda _: len(self.twists.since(start)) > 30)
            self.assertEqual({item.value for item in self.twists.since(start)}, {DRIVE})
        finally:
            first.process.end()

    def test_stop_all_is_repeated_twice_a_second(self):
        """It is the mux's sign of life, and what undoes another node's word."""
        start = time.monotonic()
        self.stops.wait(lambda _: len(self.stops.since(start)) > 3)
        said = [item.at for item in self.stops.since(start)]
        gaps = [later - sooner for sooner, later in zip(said, said[1:])]
        self.assertLess(measured('longest gap between two of stop-all', max(gaps)), 0.75)

    def test_neutral_interlock_after_a_released_stop_all(self):
        """Release itself needs neutral; then the stick has to be centred once more."""
        self._drive()
        self.set_stop(True)
        self.assertFalse(self.set_stop(False).success, 'released with the stick held')
        self.assertTrue(self.stops.last())
        self.stick.hold(NEUTRAL)
        wait_until(lambda: self.set_stop(False).success, 'not released at neutral')
        self.stops.wait(lambda _: self.stops.last() is False)
        self._drive()

    def _assert_interlock(self, stick, begun):
        """The stick, held, moves nothing; centred once, it drives."""
        self.waits.wait(lambda _: self.waits.last() == 'neutral')
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])
        stick.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        stick.hold(FORWARD)
        self.twists.wait(moves, begun)

    def test_mode_is_latched_and_owned_by_the_mux(self):
        """Whoever comes late hears it; an unknown one changes nothing."""
        self._mode('pedal')
        self.select.publish(source='telepathy')
        late = Recorder('/mux/mode', ControlMode, lambda message: message.source)
        self.assertEqual(late.wait(lambda value: True).value, 'pedal')
        late.close()
        self._mode('joy')
        self.assertNotIn('telepathy', [item.value for item in self.modes.since(0.0)])

    def test_twist_of_the_mux_alone_and_planar(self):
        """Only the mux publishes, and only the two components of a plane."""
        self._drive()
        self.assertEqual({item.sender for item in self.twists.since(0.0)}, {'/mux'})

    def test_a_burst_of_unusable_messages_leaves_a_driving_robot_driving(self):
        """The good messages in between count."""
        self._drive()
        start = time.monotonic()
        garbage = rospy.Publisher('/mux_in/joy', Joy, queue_size=10)
        wait_until(garbage.get_num_connections, 'nobody listens')
        for axes in ((float('nan'), 0.0), (), (0.5,)):
            garbage.publish(Joy(axes=axes))
        self.twists.wait(lambda _: len(self.twists.since(start)) > 30)
        self.assertEqual({item.value for item in self.twists.since(start)}, {DRIVE})


if __name__ == '__main__':
    rospy.init_node('mux_promises')
    rostest.rosrun('mhri', 'mux_promises', MuxPromises, sys.argv)
