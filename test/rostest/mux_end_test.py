#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a mux ends and begins: signals, restarts, a second mux, a file that cannot be used."""
import os
import signal
import sys
import tempfile
import time
import unittest

from diagnostic_msgs.msg import DiagnosticArray
from rostest_tools import (
    FORWARD, measured, moves, NEUTRAL, Recorder, rests, start_mux, Stick, twist_recorder,
    wait_until)
import rospy
import rostest
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool

from mhri.msg import ControlMode

SERVICE = '/mux/set_stop_all'
# Commands are 50 ms apart: none for so long, and none comes any more [s].
SILENCE_S = 0.4
# What a file says, None where there is none, and what is said of it beside its name.
BROKEN = (
    (b'sources:\n  - {name: joy, topic: /mux_in/joy, profile: virtual, tiemout: 1}\n'
     b'speed_limit: {linear_mps: 0.5, angular_rad_s: 1.5}\n', 'sources[0].tiemout', 'unknown key'),
    (b'sources: [', 'is not valid YAML'), (b'sources: [\xfc]\n', 'UTF-8'), (None,))


class MuxEnd(unittest.TestCase):
    """Every test starts the muxes it needs, and leaves none."""

    def setUp(self):
        """Begin without a mux and without a memory of one."""
        for name in ('stop_all', 'config'):
            if rospy.has_param('/mux/' + name):
                rospy.delete_param('/mux/' + name)
        self.twists = twist_recorder()
        self.stops = Recorder('/robot_controller/stop_all', Bool, lambda message: message.data)
        self.waits = Recorder('/mux/waits_for', String, lambda message: message.data)
        self.stick = Stick('/mux_in/joy')
        self.muxes = []

    def tearDown(self):
        """Leave nothing behind."""
        self.stick.silence()
        for mux in self.muxes:
            mux.end()
        for recorder in (self.twists, self.stops, self.waits):
            recorder.close()

    def _start(self, *arguments, **options):
        """Start a mux and wait until it drives, or would."""
        begun = time.monotonic()
        mux = start_mux(*arguments, **options)
        self.muxes.append(mux)
        self.stops.wait(lambda value: True, begun)
        self.waits.wait(lambda value: True, begun)
        self.stick.wait_listener()
        rospy.wait_for_service(SERVICE, 10.0)
        self.twists.wait_publisher()
        return mux

    def _drive(self):
        self.stick.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        start = self.stick.hold(FORWARD)
        self.twists.wait(moves, start)

    def _end_by(self, number, words):
        mux = self._start()
        self._drive()
        begun = mux.send(number)
        first = self.twists.wait(rests, begun)
        self.assertLess(measured('first zero after ' + words, first.at - begun), 0.05)
        mux.wait()
        zeros = self.twists.since(first.at)
        self.assertTrue(all(rests(item.value) for item in zeros), zeros)
        self.assertTrue(8 <= len(zeros) <= 12, zeros)
        self.assertTrue(0.35 < zeros[-1].at - first.at < 0.6, zeros)

    def test_sigterm_zero_within_50_ms_and_zeros_for_half_a_second(self):
        """What kill and roslaunch send."""
        self._end_by(signal.SIGTERM, 'SIGTERM')

    def test_sigint_zero_within_50_ms_and_zeros_for_half_a_second(self):
        """What Ctrl-C sends."""
        self._end_by(signal.SIGINT, 'SIGINT')

    def test_sighup_zero_within_50_ms_and_zeros_for_half_a_second(self):
        """Closing the terminal is no way to end the mux without a word."""
        self._end_by(signal.SIGHUP, 'SIGHUP')

    def test_killed_mux_falls_silent_and_the_next_one_begins_with_zeros(self):
        """And waits for neutral, although the stick is held all the time."""
        mux = self._start()
        self._drive()
        mux.send(signal.SIGKILL)
        mux.wait()
        begun = time.monotonic()
        self._start()
        self.twists.wait(rests, begun)
        self.waits.wait(lambda _: self.waits.last() == 'neutral')
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])

    def test_stop_all_survives_a_killed_and_restarted_mux(self):
        """The next one says so before anybody asks; release is as ever."""
        mux = self._start()
        self._drive()
        set_stop = rospy.ServiceProxy(SERVICE, SetBool)
        self.assertTrue(set_stop(True).success)
        wait_until(lambda: rospy.get_param('/mux/stop_all'), 'not written down')
        mux.send(signal.SIGKILL)
        mux.wait()
        begun = time.monotonic()
        self._start()
        self.assertEqual({item.value for item in self.stops.since(begun)}, {True})
        self.stick.hold(FORWARD)
        self.assertFalse(set_stop(False).success)
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])
        self.stick.hold(NEUTRAL)
        wait_until(lambda: set_stop(False).success, 'not released at neutral')
        self._drive()

    def _start_settled(self):
        """Start a mux and wait for its first diagnostics: what the name is worth before that is
        the matter of a test of its own.
        """
        mux = self._start()
        diagnostics = Recorder('/diagnostics', DiagnosticArray,
                               lambda message: message.status[0].name)
        diagnostics.wait(lambda name: name.startswith('mux'))
        diagnostics.close()
        return mux

    def test_second_mux_of_the_same_name_takes_over(self):
        """The older ends with zeros; then the newer alone is heard."""
        older = self._start_settled()
        self._take_over(older)

    def test_second_mux_of_another_name_takes_over(self):
        """The master does not end it; the newer mux asks it to."""
        older = self._start('__name:=mux_of_yesterday')
        self._take_over(older, '__name:=mux_of_today')
        senders = [item.sender for item in self.twists.since(0.0)]
        newer = senders.index('/mux_of_today')
        self.assertEqual(set(senders[:newer]), {'/mux_of_yesterday'})
        self.assertEqual(set(senders[newer:]), {'/mux_of_today'})

    def _take_over(self, older, *arguments):
        """Drive with one mux, start another; drive with that as soon as it lets us."""
        self._drive()
        begun = time.monotonic()
        newer = self._start(*arguments)
        older.wait()
        measured('older mux gone after', time.monotonic() - begun)
        zero = self.twists.wait(rests, begun)
        self.waits.wait(lambda _: self.waits.last() == 'neutral', begun)
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)])
        self._drive()
        start = time.monotonic()
        self.twists.wait(lambda _: len(self.twists.since(start)) > 20)
        self.assertTrue(all(moves(item.value) for item in self.twists.since(start)))
        self.assertTrue(newer.running())

    def test_an_older_mux_that_hangs_does_not_keep_the_newer_one_from_starting(self):
        """The request to end has a time limit."""
        older = self._start('__name:=mux_of_yesterday')
        self._drive()
        older.send(signal.SIGSTOP)
        begun = time.monotonic()
        self.muxes.append(start_mux('__name:=mux_of_today'))
        wait_until(lambda: rospy.get_param('/mux/sources', None)
                   and self.waits.since(begun), 'the newer mux does not start', 6.0)

    def test_two_muxes_of_one_name_started_together_leave_one(self):
        """A dying mux must not register its name anew: the master would end the newer one.

        Then no mux would be left (ros_comm#2018).
        """
        for age_s in (0.1, 0.5):
            self._start()
            ready = time.monotonic()
            wait_until(lambda: time.monotonic() - ready > age_s, 'no time passes')
            newer = self._start()
            self.muxes[-2].wait()
            # Told to end just before, it would have said its zeros for half a second by then.
            checked = time.monotonic()
            wait_until(lambda: not newer.running() or time.monotonic() - checked > 1.2, 'no end')
            self.assertTrue(newer.running(), 'no mux is left; the older was {} s old'.format(age_s))
            newer.end()

    def test_stop_all_survives_a_mux_killed_right_after_its_answer(self):
        """The stop is written down before the answer is given."""
        set_stop = rospy.ServiceProxy(SERVICE, SetBool)
        for _ in range(4):
            rospy.set_param('/mux/stop_all', False)
            mux = self._start()
            self.assertTrue(set_stop(True).success)
            mux.send(signal.SIGKILL)
            mux.wait()
            self.assertTrue(rospy.get_param('/mux/stop_all'))

    def test_an_older_mux_that_hung_ends_without_driving(self):
        """It comes back after the newer one has taken its name."""
        older = self._start_settled()
        self._drive()
        older.send(signal.SIGSTOP)
        begun = time.monotonic()
        self._start()
        self.twists.wait_silence(SILENCE_S)
        woken = older.send(signal.SIGCONT)
        older.wait()
        measured('hung mux gone after', time.monotonic() - woken)
        self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])

    def test_an_input_node_that_is_not_there_fills_no_log(self):
        """It is looked for every second, for as long as its mode is in force."""
        select = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        with tempfile.TemporaryDirectory() as folder:
            self._start(env={'ROS_LOG_DIR': folder})
            wait_until(select.get_num_connections, 'the mux does not listen')
            select.publish(source='ps3joy')
            asked = time.monotonic()
            wait_until(lambda: time.monotonic() - asked > 2.2, 'no time passes')
            logs = ''
            for name in os.listdir(folder):
                with open(os.path.join(folder, name), encoding='utf-8') as stream:
                    logs += stream.read()
        self.assertIn('/mux_in/ps3joy', logs, 'what rospy registers is in it')
        self.assertNotIn('lookup service failed', logs)

    def test_a_name_of_a_megabyte_is_cut_where_it_comes_in(self):
        select = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        mux = self._start()
        wait_until(select.get_num_connections, 'the mux does not listen')
        select.publish(source=1000000 * 'x')
        wait_until(lambda: 'no source' in mux.said(), 'it is not said')
        self.assertLess(len(mux.said()), 5000)

    def test_a_terminal_that_takes_nothing_holds_up_nothing(self):
        """Ctrl-S: whatever is said, the zeros come, the stop is answered, and the mux ends."""
        reading, writing = os.pipe()
        try:
            os.set_blocking(writing, False)
            with self.assertRaises(BlockingIOError):
                while True:
                    os.write(writing, bytes(65536))
            os.set_blocking(writing, True)
            mux = self._start(output=writing)
            self._drive()
            # Refused, and said, on the thread that has the stick.
            begun = self.stick.hold((float('nan'), 0.0))
            self.twists.wait(rests, begun)
            self.waits.wait(lambda value: value == 'source', begun)
            self._drive()
            asked = time.monotonic()
            self.assertTrue(rospy.ServiceProxy(SERVICE, SetBool)(True).success)
            zero = self.twists.wait(rests, asked)
            self.assertLess(measured('stop, terminal blocked', zero.at - asked), 0.05)
            begun = mux.send(signal.SIGTERM)
            first = self.twists.wait(rests, begun)
            self.assertLess(measured('SIGTERM, terminal blocked', first.at - begun), 0.05)
            self.assertEqual(mux.wait(60.0), 0)
        finally:
            os.close(reading)
            os.close(writing)

    def test_a_broken_file_ends_with_1_and_names_file_and_key(self):
        """The slip, not a traceback: of a hand, of a launch file, of an editor of another age."""
        with tempfile.TemporaryDirectory() as folder:
            started = []
            for number, (text, *words) in enumerate(BROKEN):
                path = os.path.join(folder, 'mux{}.yaml'.format(number))
                if text is not None:
                    with open(path, 'wb') as stream:
                        stream.write(text)
                # None of them gets as far as to take its name.
                mux = start_mux('__name:=mux_with_a_broken_file', '_config:=' + path)
                self.muxes.append(mux)
                started.append((mux, [path] + words))
            for mux, words in started:
                self.assertEqual(mux.wait(), 1)
                for word in words:
                    self.assertIn(word, mux.said())
                self.assertNotIn('Traceback', mux.said())

    def test_a_broken_file_does_not_end_the_mux_that_runs(self):
        """The file is read before the name is taken."""
        mux = self._start()
        broken = start_mux('_config:=/no/such/mux.yaml')
        self.muxes.append(broken)
        self.assertEqual(broken.wait(), 1)
        self._drive()
        self.assertTrue(mux.running())


if __name__ == '__main__':
    rospy.init_node('mux_end')
    rostest.rosrun('mhri', 'mux_end', MuxEnd, sys.argv)
