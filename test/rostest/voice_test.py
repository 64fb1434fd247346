#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The voice's node as it is shipped: speech of espeak-ng into a FIFO, Twists out, in time."""
import signal
import sys
import unittest

import psutil
from rostest_tools import measured, moves, rests, wait_until
import rospy
import rostest
from voice_case import HEAR_S, LEFT_TWIST, VoiceTest
from voice_tools import START_S


class Driving(VoiceTest):
    """Motion: only when asked for, and never for long."""

    def test_forward_moves_and_ends_by_itself(self):
        """No longer than 2 s, unless it is said again; the rest of the time it is at neutral."""
        self._ready()
        first = self._drive()
        heard = [item.value for item in self.node.heard.since(0.0) if item.value.accepted]
        self.assertEqual(heard, [('robot drive forward', 'forward 0.50', True, '')])
        zero = self.twists.wait(rests, first, HEAR_S)
        lasted = measured('a spoken command lasts', zero.at - first)
        self.assertTrue(1.5 < lasted < 2.5, lasted)
        self._drive('robot turn left', LEFT_TWIST)
        self.twists.wait(rests, first + lasted + 0.1, HEAR_S)

    def test_a_little_is_over_sooner(self):
        """Counted where the command is given, so whatever load there is."""
        self._ready()
        first = self._drive('robot turn left a little', LEFT_TWIST)
        zero = self.twists.wait(rests, first, HEAR_S)
        self.assertLess(measured('a little lasts', zero.at - first), 1.4)


class Lifecycle(VoiceTest):
    """Suspended, lost, ended, killed."""

    def test_starts_suspended_and_costs_nothing(self):
        """Nothing is opened and no process begun; listening to a quiet room costs little."""
        self.assertIn('suspended', self.node.words())
        spent = self.node.spent_cpu(1.5)
        print('MEASURED suspended: {:.2f} % of a core'.format(100.0 * spent))
        self.assertLess(spent, 0.05)
        self.assertEqual(self.node.listeners(), [])
        self.assertEqual(self.node.joys.since(0.0), [])
        self._resume()
        spent = self.node.spent_cpu(1.5)
        print('MEASURED listening to a quiet room: {:.2f} % of a core'.format(100.0 * spent))
        self.assertLess(spent, 0.5)
        self.assertTrue(self.node.suspend().success)
        wait_until(lambda: not self.node.listeners(), 'still listens', START_S)

    def test_suspended_while_it_moves(self):
        """One neutral Joy at once, by the service and by the mode; then silence."""
        self._ready()
        self._drive()
        begun = self.node.joys.wait(lambda value: any(value.axes)).at
        self.node.suspend()
        zero = self.twists.wait(rests, begun, HEAR_S)
        self.node.joys.wait_silence(0.5)
        joys = self.node.joys.since(begun)
        self.assertEqual([item for item in joys if not any(item.value.axes)], joys[-1:])
        self.assertLess(zero.at, joys[-1].at + 0.5)

    def test_microphone_pulled_while_it_moves(self):
        """One neutral Joy at once; plugged in again it is found by itself, and moves nothing."""
        self._ready()
        self._drive()
        pulled = self.microphone.pull()
        zero = self.twists.wait(rests, pulled)
        measured('pulled to first zero Twist', zero.at - pulled)
        self.assertLess(self._one_neutral(pulled, 'pulled to neutral Joy'), 0.4)
        wait_until(lambda: 'nobody writes to' in self.node.process.said(), 'says nothing', START_S)
        self.microphone.plug()
        begun = self.node.joys.wait(lambda value: True, pulled + 0.5, START_S).at
        self.waits.wait(lambda _: self.waits.last() == '', patience_s=START_S)
        self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])
        self._drive('robot turn left', LEFT_TWIST)

    def test_the_process_that_listens_is_killed(self):
        """A neutral Joy, and another one begins."""
        self._ready()
        self._drive()
        begun = self.node.joys.wait(lambda value: any(value.axes)).at
        old = self.node.listeners()
        for process in old:
            process.kill()
        self.twists.wait(rests, begun)
        wait_until(lambda: self.node.listeners() and self.node.listeners() != old, 'none begins',
                   START_S)

    def test_a_node_that_is_ended_says_neutral_first(self):
        """SIGTERM, as roslaunch sends it; the process that listens ends as well."""
        self._ready()
        self._drive()
        listeners = self.node.listeners()
        begun = self.node.process.send(signal.SIGTERM)
        self._one_neutral(begun, 'ended to neutral')
        self.assertEqual(self.node.process.wait(START_S), 0)
        self.assertEqual(psutil.wait_procs(listeners, START_S)[1], [])

    def test_a_killed_node_is_a_zero_within_550_ms(self):
        """The mux notices the silence; nobody goes on listening."""
        self._ready()
        self._drive()
        listeners = self.node.listeners()
        begun = self.node.process.send(signal.SIGKILL)
        zero = self.twists.wait(rests, begun)
        # 0.55 s is promised from the last message; the rest is for a loaded machine.
        self.assertLess(measured('killed to zero', zero.at - begun), 0.8)
        self.assertEqual(psutil.wait_procs(listeners, START_S)[1], [])


class Suite(unittest.TestSuite):
    """All of the above."""

    def __init__(self):
        load = unittest.defaultTestLoader.loadTestsFromTestCase
        super().__init__([load(case) for case in (Driving, Lifecycle)])


if __name__ == '__main__':
    rospy.init_node('voice_test')
    rostest.rosrun('mhri', 'voice', 'voice_test.Suite', sys.argv)
