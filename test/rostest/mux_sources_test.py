#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The unchanged joy_node, teleop_twist_joy and rqt_robot_steering drive with a row in mux.yaml.

Each is played by a process of its own that publishes exactly when and what it does; none of them
knows of mhri.
"""
import os
import subprocess
import sys
import time
import unittest

from rostest_tools import measured, moves, Process, Recorder, rests, twist_recorder, wait_until
import rospy
import rostest
from std_msgs.msg import String

from mhri.msg import ControlMode

UP = (0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
REST = (0.0,) * 8
LB = 4
# A source without "holds" would have fallen silent twice; no command comes any more [s].
LONG_S, SILENCE_S = 1.2, 0.6


class Speaker:
    """A program that says what it is told, once, or again and again."""

    def __init__(self, kind, topic, name):
        self.process = Process(
            [sys.executable, os.path.join(os.path.dirname(__file__), 'speaker_process.py'),
             kind, topic, '__name:=' + name], stdin=subprocess.PIPE)

    def say(self, values, buttons=(), rate_hz=0.0):
        """Say it once, with a rate until something else is said; return when."""
        words = [rate_hz, len(buttons), *buttons, *values]
        self.process.stdin.write((' '.join(str(word) for word in words) + '\n').encode())
        self.process.stdin.flush()
        return time.monotonic()


class MuxSources(unittest.TestCase):
    """One mux; each test has a speaker of its own."""

    @classmethod
    def setUpClass(cls):
        """Open everything once."""
        cls.twists = twist_recorder()
        cls.modes = Recorder('/mux/mode', ControlMode, lambda message: message.source)
        cls.waits = Recorder('/mux/waits_for', String, lambda message: message.data)
        cls.advice = Recorder('/mux/advice', String, lambda message: message.data)
        cls.select = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        wait_until(cls.select.get_num_connections, 'the mux does not listen')
        for recorder in (cls.twists, cls.modes, cls.waits, cls.advice):
            recorder.wait_publisher()

    def start(self, mode, kind, topic, name):
        """Choose a source and start its program."""
        self.select.publish(source=mode)
        self.modes.wait(lambda _: self.modes.last() == mode)
        speaker = Speaker(kind, topic, name)
        self.addCleanup(speaker.process.end)
        self.advice.wait(lambda words: '/{} has said nothing yet'.format(name) in words)
        return speaker

    def assert_moves_only(self, value, seconds, start):
        """For so long it is sent this, and nothing else."""
        wait_until(lambda: time.monotonic() - start > seconds, 'no time passes', seconds + 10.0)
        said = {(round(item.value[0], 6), round(item.value[1], 6))
                for item in self.twists.since(start + 0.05)}
        self.assertEqual(said, {value})

    def test_joy_node_without_autorepeat(self):
        """It says what changes: the stick held out is silent, and so is the stick at rest."""
        pad = self.start('joy_node', 'joy', '/joy', 'joy_node')
        buttons = [int(number == LB) for number in range(11)]
        pad.say(REST, [0] * len(buttons))
        self.waits.wait(lambda _: self.waits.last() == 'dead_man')
        pad.say(REST, buttons)
        self.waits.wait(lambda _: self.waits.last() == '')
        self.twists.wait_silence(LONG_S)
        self.assertEqual(self.waits.last(), '', 'at rest in silence')
        start = pad.say(UP, buttons)
        self.twists.wait(moves, start)
        self.assert_moves_only((0.4, 0.0), LONG_S, start)
        begun = pad.say(REST, buttons)
        zero = self.twists.wait(rests, begun)
        self.assertLess(measured('joy_node: let go to zero', zero.at - begun), 0.05)
        start = pad.say(UP, buttons)
        self.twists.wait(moves, start)
        killed = pad.process.send(9)
        zero = self.twists.wait(rests, killed)
        self.assertLess(measured('joy_node: killed to zero', zero.at - killed), 0.3)

    def test_rqt_robot_steering(self):
        """10 Hz while it moves; zero once, then nothing."""
        steering = self.start('steering', 'twist', '/steering/cmd_vel', 'rqt_gui_robot_steering')
        steering.say((0.0, 0.0))
        self.waits.wait(lambda _: self.waits.last() == '')
        self.twists.wait_silence(LONG_S)
        start = steering.say((0.8, 1.0), rate_hz=10.0)
        self.twists.wait(moves, start)
        self.assert_moves_only((0.4, 0.5), LONG_S, start)
        begun = steering.say((0.0, 0.0))
        zero = self.twists.wait(rests, begun)
        self.assertLess(measured('steering: let go to zero', zero.at - begun), 0.05)
        self.twists.wait_silence(SILENCE_S)
        start = steering.say((-0.2, 0.0), rate_hz=10.0)
        self.twists.wait(lambda value: value == (-0.2, 0.0), start)
        begun = steering.say((-0.2, 0.0))
        zero = self.twists.wait(rests, begun)
        self.assertLess(measured('steering: hung to zero', zero.at - begun), 0.55)
        self.advice.wait(lambda words: 'has fallen silent' in words, begun)
        start = steering.say((-0.2, 0.0), rate_hz=10.0)
        self.waits.wait(lambda value: value == 'neutral', start)
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)])

    def test_teleop_twist_joy_behind_that_joy_node(self):
        """It speaks when joy_node does; released, it says zero once."""
        teleop = self.start('teleop', 'twist', '/teleop/cmd_vel', 'teleop_twist_joy')
        teleop.say((0.0, 0.0))
        self.waits.wait(lambda _: self.waits.last() == '')
        start = teleop.say((0.3, 0.2))
        self.twists.wait(moves, start)
        self.assert_moves_only((0.3, 0.2), LONG_S, start)
        self.twists.wait(rests, teleop.say((0.0, 0.0)))

    def test_a_pad_that_falls_silent_is_told_its_remedy(self):
        """The same joy_node in a row without holds: it stops after half a second, and says why."""
        pad = self.start('eager', 'joy', '/eager', 'eager_joy_node')
        pad.say((0.0, 0.0))
        self.waits.wait(lambda _: self.waits.last() == '')
        begun = pad.say((0.0, 1.0))
        self.twists.wait(moves, begun)
        self.twists.wait(rests, begun)
        said = self.advice.wait(lambda words: 'holds: true' in words, begun).value
        self.assertIn('/eager_joy_node', said)

    def test_a_wrong_type_is_said_with_its_remedy(self):
        """A Twist where the row says joy."""
        self.select.publish(source='mistaken')
        self.modes.wait(lambda _: self.modes.last() == 'mistaken')
        speaker = Speaker('twist', '/mistaken', 'somebody')
        self.addCleanup(speaker.process.end)
        said = self.advice.wait(lambda words: 'geometry_msgs/Twist' in words).value
        self.assertEqual(said, 'mistaken: /somebody publishes geometry_msgs/Twist on /mistaken: '
                               'write type: twist into its row of mux.yaml')


if __name__ == '__main__':
    rospy.init_node('mux_sources')
    rostest.rosrun('mhri', 'mux_sources', MuxSources, sys.argv)
