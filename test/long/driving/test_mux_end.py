# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a mux ends and begins: signals, restarts, a second mux, a file that cannot be used."""
import os
import signal
import tempfile
import time
import unittest

from diagnostic_msgs.msg import DiagnosticArray
import psutil
import rospy
from std_msgs.msg import Bool

from support import graph
from support.own_node import own_node
from support.ros_system import children, freeze, thaw, wait_for
from support.node_tools import (
    measured, moves, Recorder, rests, start_mux, state_recorder, Stick, TIMEOUT_S, twist_recorder)

system = own_node('mux_end')

SERVICE = graph.SET_STOP_ALL
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
        home = tempfile.TemporaryDirectory()
        self.addCleanup(home.cleanup)
        os.environ['ROS_HOME'] = home.name
        if rospy.has_param('/mux/config'):
            rospy.delete_param('/mux/config')
        self.twists = twist_recorder()
        self.stops = Recorder(graph.STOP_ALL, Bool, lambda message: message.data)
        self.waits = state_recorder('waits_for')
        self.stick = Stick(graph.STICK)
        self.muxes = []

    def tearDown(self):
        """Leave nothing behind."""
        self.stick.silence()
        for mux in self.muxes:
            if mux.running():
                for number in self._both(mux):
                    os.kill(number, signal.SIGKILL)
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
        rospy.wait_for_service(SERVICE, TIMEOUT_S)
        self.twists.wait_publisher()
        return mux

    @staticmethod
    def _both(mux):
        """Return the numbers of the process that stands by and of the mux."""
        return [mux.number, *children(mux.number)]

    def _drive(self):
        self.stick.set_out(self.waits, self.twists)

    def test_a_signal_gives_a_zero_within_50_ms_and_zeros_for_half_a_second(self):
        """Those of Ctrl-C and of a terminal that is closed; SIGTERM is tried with robots."""
        # Both go the same way: the time of one is enough.
        for number, within_s in ((signal.SIGINT, None), (signal.SIGHUP, 0.05)):
            with self.subTest(number.name):
                mux = self._start()
                self._drive()
                begun = mux.send(number)
                first = self.twists.wait(rests, begun)
                measured('first zero after ' + number.name, first.at - begun, within_s)
                mux.wait()
                self.twists.wait_zeros(first)

    def _start_settled(self, *arguments):
        """Start a mux and wait for its first diagnostics: what the name is worth before that is
        the matter of a test of its own.
        """
        mux = self._start(*arguments)
        diagnostics = Recorder('/diagnostics', DiagnosticArray,
                               lambda message: message.status[0].name)
        diagnostics.wait(lambda name: name.startswith('mux'))
        diagnostics.close()
        return mux

    def test_a_mux_whose_name_another_one_has_taken_is_not_started_again(self):
        """The process that stood by stays, so that roslaunch does not start it again, either."""
        older = self._start_settled('--stand-by')
        newer = self._start('--stand-by')
        wait_for(lambda: 'it is not started again' in older.said(), what='the older goes on')
        works = psutil.Process(newer.number).children()
        self.assertEqual(len(works), 1)
        checked = time.monotonic()
        wait_for(lambda: time.monotonic() - checked > 1.2, what='no time passes')
        self.assertTrue(older.running())
        self.assertEqual(psutil.Process(older.number).children(), [])
        self.assertEqual(psutil.Process(newer.number).children(), works)

    def test_second_mux_of_another_name_takes_over(self):
        """The master does not end it; the newer mux asks it to. It ends with zeros."""
        older = self._start('__name:=mux_of_yesterday')
        self._drive()
        begun = time.monotonic()
        newer = self._start('__name:=mux_of_today')
        older.wait()
        measured('older mux gone after', time.monotonic() - begun)
        zero = self.twists.wait(rests, begun)
        self.waits.wait(lambda _: self.waits.last() == 'neutral', begun)
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)])
        self._drive()
        self.assertTrue(newer.running())
        senders = [item.sender for item in self.twists.since(0.0)]
        today = senders.index('/mux_of_today')
        self.assertEqual(set(senders[:today]), {'/mux_of_yesterday'})
        self.assertEqual(set(senders[today:]), {'/mux_of_today'})

    def test_two_muxes_of_one_name_started_together_leave_one(self):
        """A dying mux must not register its name anew: the master would end the newer one.

        Then no mux would be left (ros_comm#2018).
        """
        for age_s in (0.1, 0.5):
            self._start()
            ready = time.monotonic()
            wait_for(lambda: time.monotonic() - ready > age_s, what='no time passes')
            newer = self._start()
            self.muxes[-2].wait()
            # Told to end just before, it would have said its zeros for half a second by then.
            checked = time.monotonic()
            wait_for(lambda: not newer.running() or time.monotonic() - checked > 1.2, what='no end')
            self.assertTrue(newer.running(), 'no mux is left; the older was {} s old'.format(age_s))
            newer.end()

    def test_an_older_mux_that_hangs_keeps_no_other_from_starting_and_ends_without_driving(self):
        """It comes back after the newer one has taken its name, or has asked it in vain to end."""
        for name in ('mux', 'mux_of_today'):
            with self.subTest(name):
                older = self._start_settled()
                self._drive()
                both = self._both(older)
                freeze(*both)
                # What it said before that may still be on its way.
                self.twists.wait_silence(SILENCE_S)
                begun = time.monotonic()
                newer = self._start('__name:=' + name)
                self.twists.wait_silence(SILENCE_S)
                woken = thaw(*both)
                older.wait()
                measured('hung mux gone after', time.monotonic() - woken)
                self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])
                newer.end()

    def test_a_broken_file_ends_with_1_and_names_file_and_key(self):
        """The slip, not a traceback: of a hand, of a launch file, of an editor of another age.

        It is read before the name is taken: the mux that runs goes on.
        """
        runs = self._start()
        with tempfile.TemporaryDirectory() as folder:
            for number, (text, *words) in enumerate(BROKEN):
                path = os.path.join(folder, 'mux{}.yaml'.format(number))
                if text is not None:
                    with open(path, 'wb') as stream:
                        stream.write(text)
                mux = start_mux('__name:=mux', '_config:=' + path)
                self.muxes.append(mux)
                self.assertEqual(mux.wait(), 1)
                for word in (path, *words):
                    self.assertIn(word, mux.said())
                self.assertNotIn('Traceback', mux.said())
        self._drive()
        self.assertTrue(runs.running())
