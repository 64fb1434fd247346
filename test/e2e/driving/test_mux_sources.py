# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The unchanged joy_node, teleop_twist_joy, rqt_robot_steering and a lab's pad: rows in mux.yaml.

Each is played by a process of its own that publishes exactly when and what it does; none of them
knows of mhri.
"""
import subprocess
import sys
import time
import unittest

from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Log
import rospy

from mhri.msg import ControlMode

from support import graph
from support.own_node import own_node
from support.paths import SUPPORT
from support.ros_system import tell, wait_for
from support.node_tools import (
    advice_recorder, FORWARD, measured, moves, NEUTRAL, Process, Recorder, rests, state_recorder,
    Stick, twist_recorder)

system = own_node('mux_sources', 'mux_sources.launch')

UP = (0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
REST = (0.0,) * 8
LB = 4
# A source without "holds" would have fallen silent twice; no command comes any more [s].
LONG_S, SILENCE_S = 1.2, 0.6
HELD = (0, 1)
REFUSED = {
    'no axes': ((), HELD), 'not finite': ((float('nan'), 0.0), HELD),
    'too few axes': ((0.0,), HELD), 'too few buttons': (FORWARD, (1,))}


def counts(message):
    """Return {key: value} of the mux's status of driving in one /diagnostics message."""
    for status in message.status:
        if status.name.endswith('driving'):
            return {item.key: item.value for item in status.values}
    return {}


class Speaker:
    """A program that says what it is told, once, or again and again."""

    def __init__(self, kind, topic, name):
        self.process = Process(
            [sys.executable, str(SUPPORT / 'speaker_process.py'),
             kind, topic, '__name:=' + name], stdin=subprocess.PIPE)

    def say(self, values, buttons=(), rate_hz=0.0):
        """Say it once, with a rate until something else is said; return when."""
        words = [rate_hz, len(buttons), *buttons, *values]
        begun = time.monotonic()
        tell(self.process, ' '.join(map(str, words)))
        return begun


class MuxSources(unittest.TestCase):
    """One mux; each test has a speaker of its own."""

    @classmethod
    def setUpClass(cls):
        """Open everything once."""
        cls.twists = twist_recorder()
        cls.modes = Recorder(graph.MODE, ControlMode, lambda message: message.source)
        cls.waits = state_recorder('waits_for')
        cls.advice = advice_recorder()
        cls.select = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=10)
        wait_for(cls.select.get_num_connections, what='the mux does not listen')
        for recorder in (cls.twists, cls.modes, cls.waits, cls.advice):
            recorder.wait_publisher()

    def start(self, mode, kind, topic, name):
        """Choose a source and start its program."""
        self.select.publish(source=mode)
        self.modes.wait_newest(mode)
        speaker = Speaker(kind, topic, name)
        self.addCleanup(speaker.process.end)
        self.advice.wait(lambda said: said == ('nothing_sent', '/' + name))
        return speaker

    def assert_moves_only(self, value, seconds, start):
        """For so long it is sent this, and nothing else."""
        wait_for(lambda: time.monotonic() - start > seconds,
                 what='no time passes', timeout_s=seconds + 10.0)
        said = {(round(item.value[0], 6), round(item.value[1], 6))
                for item in self.twists.since(start + 0.05)}
        self.assertEqual(said, {value})

    def test_joy_node_without_autorepeat(self):
        """It says what changes: the stick held out is silent, and so is the stick at rest."""
        pad = self.start('joy_node', 'joy', '/joy', 'joy_node')
        buttons = [int(number == LB) for number in range(11)]
        pad.say(REST, [0] * len(buttons))
        self.waits.settle('dead_man')
        self.waits.wait(lambda now: now == '', pad.say(REST, buttons))
        self.twists.wait_silence(LONG_S)
        self.assertEqual(self.waits.last(), '', 'at rest in silence')
        start = pad.say(UP, buttons)
        self.twists.wait(moves, start)
        self.assert_moves_only((0.4, 0.0), LONG_S, start)
        begun = pad.say(REST, buttons)
        zero = self.twists.wait(rests, begun)
        measured('joy_node: let go to zero', zero.at - begun, 0.05)
        start = pad.say(UP, buttons)
        self.twists.wait(moves, start)
        begun = pad.say(UP, [0] * len(buttons))
        zero = self.twists.wait(rests, begun)
        measured('joy_node: dead-man button let go to zero', zero.at - begun, 0.05)
        self.waits.wait(lambda now: now == 'dead_man', begun)
        self.waits.wait(lambda now: now == '', pad.say(REST, buttons))
        start = pad.say(UP, buttons)
        self.twists.wait(moves, start)
        killed = pad.process.send(9)
        zero = self.twists.wait(rests, killed)
        measured('joy_node: killed to zero', zero.at - killed, 0.3)
        # Started anew with the button held: that has to be released once.
        pad = self.start('joy_node', 'joy', '/joy', 'joy_node')
        begun = pad.say(REST, buttons)
        self.waits.settle('dead_man')
        pad.say(UP, buttons)
        self.twists.wait_silence(0.7)
        self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])

    def test_rqt_robot_steering(self):
        """10 Hz while it moves; zero once, then nothing."""
        steering = self.start('steering', 'twist', '/steering/cmd_vel', 'rqt_gui_robot_steering')
        self.waits.wait(lambda now: now == '', steering.say((0.0, 0.0)))
        self.twists.wait_silence(LONG_S)
        start = steering.say((0.8, 1.0), rate_hz=10.0)
        self.twists.wait(moves, start)
        self.assert_moves_only((0.4, 0.5), LONG_S, start)
        begun = steering.say((0.0, 0.0))
        zero = self.twists.wait(rests, begun)
        measured('steering: let go to zero', zero.at - begun, 0.05)
        self.twists.wait_silence(SILENCE_S)
        start = steering.say((-0.2, 0.0), rate_hz=10.0)
        self.twists.wait(lambda value: value == (-0.2, 0.0), start)
        begun = steering.say((-0.2, 0.0))
        zero = self.twists.wait(rests, begun)
        measured('steering: hung to zero', zero.at - begun, 0.55)
        self.advice.wait(lambda said: said[0] == 'fell_silent', begun)
        start = steering.say((-0.2, 0.0), rate_hz=10.0)
        self.waits.wait(lambda value: value == 'neutral', start)
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)])

    def test_teleop_twist_joy_behind_that_joy_node(self):
        """It speaks when joy_node does; released, it says zero once."""
        teleop = self.start('teleop', 'twist', '/teleop/cmd_vel', 'teleop_twist_joy')
        self.waits.wait(lambda now: now == '', teleop.say((0.0, 0.0)))
        start = teleop.say((0.3, 0.2))
        self.twists.wait(moves, start)
        self.assert_moves_only((0.3, 0.2), LONG_S, start)
        self.twists.wait(rests, teleop.say((0.0, 0.0)))

    def test_a_pad_that_falls_silent_is_told_its_remedy(self):
        """The same joy_node in a row without holds: it stops after half a second, and says why."""
        pad = self.start('eager', 'joy', '/eager', 'eager_joy_node')
        self.waits.wait(lambda now: now == '', pad.say((0.0, 0.0)))
        begun = pad.say((0.0, 1.0))
        self.twists.wait(moves, begun)
        self.twists.wait(rests, begun)
        self.advice.wait(lambda said: said == ('fell_silent', '/eager_joy_node'), begun)

    def test_a_wrong_type_is_said_with_its_remedy(self):
        """A Twist where the row says joy."""
        self.select.publish(source='mistaken')
        self.modes.wait_newest('mistaken')
        speaker = Speaker('twist', '/mistaken', 'somebody')
        self.addCleanup(speaker.process.end)
        self.advice.wait(lambda said: said == ('sends_twist', '/somebody'))

    def test_unusable_messages_are_refused_and_counted_in_diagnostics(self):
        """Each under its own word, an unknown mode as well; nothing moves."""
        diagnostics = Recorder('/diagnostics', DiagnosticArray, counts)
        self.addCleanup(diagnostics.close)
        log = Recorder('/rosout', Log, lambda message: (
            message.name, message.msg, message.header.stamp.to_sec()))
        self.addCleanup(log.close)
        pad = Stick('/mux_in/lab', HELD).wait_listener()
        self.addCleanup(pad.silence)
        self.select.publish(source='lab')
        self.modes.wait_newest('lab')
        pad.press(self.waits)
        start = time.monotonic()
        self.select.publish(source='telepathy')

        def all_counted():
            """Say each again: of what waits to be read the newest alone counts."""
            for axes, buttons in REFUSED.values():
                pad.repeat(axes, buttons)
            found = diagnostics.last() or {}
            return all(int(found.get('refused: ' + kind, 0)) > 0
                       for kind in list(REFUSED) + ['unknown mode']) and found
        self.assertEqual(wait_for(all_counted, what='all to be counted')['mode'], 'lab')
        self.assertFalse([item for item in self.twists.since(start) if moves(item.value)])
        # Fifty a second: a full log hides what matters.
        start = pad.hold((float('inf'), 0.0), HELD)

        def said():
            """Return when the mux wrote each line of it [s], by its own clock."""
            return [item.value[2] for item in log.since(start)
                    if item.value[0] == '/mux' and 'refused' in item.value[1]]
        wait_for(lambda: len(said()) > 2, what='three lines')
        pad.hold(NEUTRAL, HELD)
        times = said()
        gaps = [later - sooner for sooner, later in zip(times, times[1:])]
        self.assertTrue(all(gap > 0.95 for gap in gaps), gaps)
