# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The master restarted under a mux that drives: it stops the robots, registers again, and works."""
import signal
import time
import unittest

import pytest
import rosgraph
import rospy
from std_srvs.srv import SetBool

from support import graph
from support.node_tools import (
    measured, moves, NEUTRAL, Process, rests, start_mux, state_recorder, Stick,
    TIMEOUT_S, twist_recorder)
from support.own_node import own_node
from support.ros_system import freeze, thaw, wait_for

system = own_node('mux_master')

# Commands are 50 ms apart: none for so long, and none comes any more [s].
SILENCE_S = 0.4


class MuxMaster(unittest.TestCase):
    """One mux, one stick, one listener; all of them outlive the master."""

    @classmethod
    def setUpClass(cls):
        """Start a mux and a stick."""
        cls.twists = twist_recorder()
        cls.waits = state_recorder('waits_for')
        cls.stick = Stick(graph.STICK)
        cls._start_mux()

    @classmethod
    def _start_mux(cls):
        cls.mux = start_mux()
        cls.stick.wait_listener()
        cls.twists.wait_publisher()
        cls.waits.wait_publisher()
        wait_for(lambda: '/diagnostics' in cls._registered()[0], what='the mux is not complete')
        rospy.wait_for_service(graph.SET_STOP_ALL, TIMEOUT_S)

    @classmethod
    def tearDownClass(cls):
        """End both."""
        cls.stick.silence()
        cls.mux.end()

    @pytest.fixture(autouse=True)
    def _take(self, system):
        self.system = system

    def _drive(self):
        self.stick.set_out(self.waits, self.twists)

    @staticmethod
    def _registered():
        """Return the topics and services of the mux the master knows: [published, read, served]."""
        state = rosgraph.Master('/mux_master_test').getSystemState()
        return [{name for name, nodes in group if '/mux' in nodes} for group in state]

    def _kill_master(self):
        begun = time.monotonic()
        self.system.kill(self.system.master)
        return begun

    def test_restarted_master_stops_the_robots_and_knows_the_mux_again(self):
        """As if nothing had been: topics, services, parameters, and a new listener hears it."""
        before = self._registered()
        self._drive()
        begun = self._kill_master()
        first = self.twists.wait(rests, begun)
        measured('first zero after the master was killed', first.at - begun)
        self.waits.settle('neutral')
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(first.at) if moves(item.value)])

        begun = time.monotonic()
        self.system.start_master()
        self._assert_registered(before)
        measured('registered again after the restart', time.monotonic() - begun)
        self.assertEqual(rospy.get_param(graph.SOURCES)[0]['name'], 'joy')
        self._drive()
        self._assert_new_listeners_hear({
            graph.MODE: 'source: "joy"', graph.COMMAND: 'linear:'})
        answer = Process(['rosservice', 'call', graph.SET_STOP_ALL, 'true'])
        self.assertEqual(answer.wait(), 0, answer.said())
        answer.end()
        self.waits.settle('release')

    def _release(self):
        self.stick.hold(NEUTRAL)
        wait_for(lambda: rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)(False).success,
                 what='not released')

    def test_master_restarted_within_half_a_second(self):
        """Too quick to be missed, but everything it knew is gone: robots stop all the same.

        It is registered again whatever asks the new master first: something may have made that
        know the node by its name alone.
        """
        self._release()
        before = self._registered()
        for _ in range(2):
            self._drive()
            begun = self._kill_master()
            self.system.start_master()
            measured('master away for', time.monotonic() - begun)
            first = self.twists.wait(rests, begun)
            measured('first zero after a quick restart of the master', first.at - begun)
            self._assert_registered(before)
        self._drive()

    def test_master_that_hangs_is_a_zero_within_1500_ms(self):
        """It takes calls and never answers; what it forgot, nobody knows."""
        self._release()
        self._drive()
        hung = freeze(self.system.master.pid)
        try:
            zero = self.twists.wait(rests, hung)
            measured('first zero after the master hung', zero.at - hung, 1.5)
        finally:
            thaw(self.system.master.pid)
        self.twists.wait_silence(SILENCE_S)
        self._drive()

    def test_ended_while_the_master_hangs(self):
        """The zeros of its end do not wait for anybody: 20 Hz for half a second, then silence."""
        self._release()
        self._drive()
        freeze(self.system.master.pid)
        try:
            begun = self.mux.send(signal.SIGTERM)
            first = self.twists.wait(rests, begun)
            self.twists.wait_zeros(first)
            self.mux.wait()
        finally:
            thaw(self.system.master.pid)
        self._start_mux()
        measured('first zero of an end while the master hangs', first.at - begun, 0.05)

    def _assert_registered(self, before):
        """The master knows again all that it knew of the mux; else say what is missing."""
        wait_for(lambda: self._registered() == before, what=lambda: (
            'the master to know it: missing {}, additional {}; the mux said: {}'.format(
                [sorted(old - new) for old, new in zip(before, self._registered())],
                [sorted(new - old) for old, new in zip(before, self._registered())],
                self.mux.said())))

    def _assert_new_listeners_hear(self, words):
        """Processes that have never met the mux find it through the new master.

        :param words: {topic: what is heard there}
        """
        late = {topic: Process(['rostopic', 'echo', '-n1', topic]) for topic in words}
        for process in late.values():
            self.addCleanup(process.end)
        for topic, process in late.items():
            self.assertEqual(process.wait(), 0)
            self.assertIn(words[topic], process.said())
