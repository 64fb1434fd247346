#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the voice's node hears, and what of it moves nothing; no figures of time."""
import os
import sys
import tempfile
import unittest

from diagnostic_msgs.msg import DiagnosticArray
from rostest_tools import measured, moves, NEUTRAL, Recorder, rests, wait_until
import rospy
import rostest
from std_msgs.msg import Bool
from voice_case import clear_parameters, HEAR_S, LEFT_TWIST, ROBOTS, VoiceTest
from voice_tools import START_S

from support import speech


class Words(VoiceTest):
    """What counts as said to it."""

    def test_stop_stops_all_without_the_wake_word(self):
        """While it moves; stop-all is engaged, and nothing moves afterwards."""
        self._ready()
        self._drive()
        begun = self._said('stop')
        stopped = self.stops.wait(lambda value: value, begun, HEAR_S)
        zero = self.twists.wait(rests, begun, HEAR_S)
        measured('end of "stop" to stop-all', stopped.at - self.out)
        measured('end of "stop" to zero', zero.at - self.out)
        self._said('robot drive forward')
        self.twists.wait_silence(0.7)
        self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)])

    def test_stop_works_while_another_source_drives(self):
        """Where the node listens, it stops whatever drives."""
        self._resume()
        self.stick.hold((0.0, 1.0))
        self.twists.wait(moves)
        begun = self._said('robot stop')
        stopped = self.stops.wait(lambda value: value, begun, HEAR_S)
        self.twists.wait(rests, stopped.at - 0.1, HEAR_S)
        self.stick.hold(NEUTRAL)

    def test_talk_moves_nothing(self):
        """Neither a sentence with the words in it, nor a command without the wake word."""
        self._ready()
        for text in ('drive forward', 'the robot should turn left here',
                     'we record every meeting on Monday'):
            begun = self._say(text)
            item = self.node.heard.wait(lambda item: True, begun, HEAR_S).value
            self.assertFalse(item.accepted, item)
            self.assertTrue(item.reason)
        self.assertFalse([item for item in self.node.joys.since(0.0) if any(item.value.axes)])
        self.assertFalse([item for item in self.twists.since(0.0) if moves(item.value)])
        self.assertEqual(self.requests.since(0.0), [])

    def test_push_to_talk_replaces_the_wake_word(self):
        """Held it is enough; let go it counts no longer."""
        self._ready()
        push = rospy.Publisher('/mhri_voice/push_to_talk', Bool, queue_size=10)
        wait_until(push.get_num_connections, 'nobody listens to push-to-talk')
        push.publish(True)
        first = self._drive('drive forward')
        push.publish(False)
        self.twists.wait(rests, first, HEAR_S)
        begun = self._say('drive forward')
        item = self.node.heard.wait(lambda item: True, begun, HEAR_S).value
        self.assertFalse(item.accepted, item)
        self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])
        push.unregister()


class Wishes(VoiceTest):
    """What others carry out."""

    def test_selection_recording_and_mode(self):
        """To the panel and to the mux, with the robots of the panel's list."""
        self._ready()
        for text, wish in (('robot select bot two', ('select', ('bot2',))),
                           ('robot start recording', ('record', ())),
                           ('robot stop recording', ('stop_recording', ()))):
            begun = self._said(text, ' '.join((wish[0],) + wish[1]))
            self.assertEqual(self.requests.wait(lambda value: True, begun, HEAR_S).value, wish)
        rospy.set_param('/mhri/robots', ROBOTS + ['tango'])
        self._said('robot select number four', 'select tango')
        numbers = {name: number for number, name in enumerate(ROBOTS, 1)}
        rospy.set_param('/mhri/robot_numbers', {**numbers, 'tango': 6})
        self._said('robot select number six', 'select tango')
        self._said('robot use joystick')
        self.modes.wait(lambda _: self.modes.last() == 'joy', patience_s=HEAR_S)
        wait_until(lambda: not self.node.listeners(), 'still listens', HEAR_S)
        self.assertFalse([item for item in self.twists.since(0.0) if moves(item.value)])


class Missing(VoiceTest):
    """What the node says where something is missing, without falling."""

    def _restart(self, *arguments, **more):
        self.node.end()
        clear_parameters()
        self.node = self._start(*arguments, **more)
        self.statuses = Recorder('/diagnostics', DiagnosticArray, lambda message: [
            (status.level, status.message) for status in message.status
            if 'microphone' in status.name])
        self.addCleanup(self.statuses.close)

    def _wait_said(self, *parts):
        """Wait until the service and the diagnostics say it, as a warning."""
        self.node.resume()
        self.node.wait_words(*parts)
        self.statuses.wait(lambda found: found and found[0][0] == 1 and all(
            part in found[0][1] for part in parts), patience_s=START_S)

    def test_no_pocketsphinx(self):
        """Names the package."""
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, 'pocketsphinx.py'), 'w') as stream:
                stream.write('raise ModuleNotFoundError("No module named \'pocketsphinx\'")\n')
            path = os.pathsep.join([folder, os.environ.get('PYTHONPATH', '')])
            self._restart('_source:=' + self.microphone.path, env={'PYTHONPATH': path})
            self._wait_said('install python3-pocketsphinx')
            self.assertTrue(self.node.process.running())

    def test_a_recording_is_played_once(self):
        """A robot must not be driven by it again and again."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'said.wav')
            speech.write_wav(path, 'robot turn left')
            self._restart('_source:=' + path)
            self._ready()
            first = self.twists.wait(moves, patience_s=HEAR_S)
            self.assertEqual(first.value, LEFT_TWIST)
            zero = self.twists.wait(rests, first.at, HEAR_S)
            self.node.joys.wait(lambda _: len(self.node.joys.since(zero.at)) > 80,
                                patience_s=START_S)
            self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)])

    def test_no_microphone(self):
        """It is looked for once a second, which costs little."""
        self._restart('_source:=microphone:none of this name')
        self._wait_said('looking for a microphone', 'no microphone')
        spent = self.node.spent_cpu(2.0)
        print('MEASURED looking for a microphone: {:.2f} % of a core'.format(100.0 * spent))
        self.assertLess(spent, 0.7)
        rospy.set_param('/mhri_voice/source', self.microphone.path)
        self.node.wait_words('reading the sound stream')


class Suite(unittest.TestSuite):
    """All of the above."""

    def __init__(self):
        load = unittest.defaultTestLoader.loadTestsFromTestCase
        super().__init__([load(case) for case in (Words, Wishes, Missing)])


if __name__ == '__main__':
    rospy.init_node('voice_words_test')
    rostest.rosrun('mhri', 'voice_words', 'voice_words_test.Suite', sys.argv)
