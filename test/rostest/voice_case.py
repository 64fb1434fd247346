# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A node of the voice for each test, beside a mux, and somebody who speaks to it."""
import time
import unittest

from rostest_tools import (
    measured, moves, NEUTRAL, Recorder, Stick, twist_recorder, wait_until)
import rospy
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool
from voice_tools import require_speech, START_S, VoiceNode

from mhri.msg import ControlMode, PanelRequest
from support import speech
from support.room import Room

ROBOTS = ['bot1', 'bot2', 'rover']
# Half of the speed limit is what a spoken drive begins with.
FORWARD_TWIST = (0.25, 0.0)
LEFT_TWIST = (0.0, 0.75)
VOICES = [speech.Voice(name, 150, 50) for name in ('en-us+m3', 'en-us+f2', 'en-us')] * 2
# On a loaded machine recognising takes longer than the word.
HEAR_S = 30.0


def clear_parameters():
    """Leave no parameter of an earlier node behind."""
    if rospy.has_param('/mhri_voice'):
        rospy.delete_param('/mhri_voice')


class VoiceTest(unittest.TestCase):
    """A mux, and a node of its own for each test."""

    def setUp(self):
        """Begin with the virtual joystick's mode, in which the mux suspends the voice."""
        require_speech()
        clear_parameters()
        rospy.set_param('/mhri/robots', ROBOTS)
        self.microphone = Room()
        self.stick = Stick('/mux_in/joy').wait_listener()
        self.stick.hold(NEUTRAL)
        self.select = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        self.modes = Recorder('/mux/mode', ControlMode, lambda message: message.source)
        self.twists = twist_recorder()
        self.waits = Recorder('/mux/waits_for', String, lambda message: message.data)
        self.stops = Recorder('/robot_controller/stop_all', Bool, lambda message: message.data)
        self.requests = Recorder('/panel_in/request', PanelRequest, lambda message: (
            message.action, tuple(message.robots)))
        wait_until(self.select.get_num_connections, 'the mux does not listen')
        self.modes.wait_publisher()
        self.twists.wait_publisher()
        self._mode('joy')
        self._release()
        self.node = self._start('_source:=' + self.microphone.path)

    def _start(self, *arguments, **more):
        node = VoiceNode(*arguments, **more)
        self.requests.wait_publisher()
        return node

    def tearDown(self):
        """Leave nothing behind."""
        self._mode('joy')
        self._release()
        self.node.end()
        self.microphone.end()
        self.stick.silence()
        for recorder in (self.modes, self.twists, self.waits, self.stops, self.requests):
            recorder.close()

    def _mode(self, name):
        self.select.publish(source=name)
        self.modes.wait(lambda _: self.modes.last() == name)

    def _release(self):
        """Take stop-all back, once the stick is known to be at neutral."""
        release = rospy.ServiceProxy('/mux/set_stop_all', SetBool)
        wait_until(lambda: release(False).success, 'stop-all cannot be released')

    def _ready(self):
        """Choose the voice's mode; wait until the mux would follow a command."""
        self._mode('voice')
        self.node.joys.wait(lambda value: True, patience_s=START_S)
        self.waits.wait(lambda _: self.waits.last() == '', patience_s=START_S)

    def _resume(self):
        """Listen although another source drives."""
        self.assertTrue(self.node.resume().success)
        self.node.wait_words('reading the sound stream')

    def _say(self, text):
        """Say something; return when it began."""
        begun = time.monotonic()
        self.microphone.say(text)
        return begun

    def _said(self, text, command=''):
        """Say something until it is taken, as a person would; return when that was begun.

        :param command: what it has to be taken for; any beginning of it

        A recogniser that understands nineteen of twenty would fail one of twenty tests.
        """
        for voice in VOICES:
            begun = time.monotonic()
            self.out = self.microphone.say(text, voice)
            # What is left of an earlier stop is no answer to this.
            item = self.node.heard.wait(lambda item: 'stop' not in item.text or 'stop' in text,
                                        begun, HEAR_S).value
            wrong = item.command == 'stop' and 'stop' not in text
            if item.accepted and item.command.startswith(command) and not wrong:
                return begun
            print('not taken: "{}": {}'.format(text, item))
            self._release()
        raise AssertionError('"{}" was never taken'.format(text))

    def _drive(self, text='robot drive forward', twist=FORWARD_TWIST):
        """Say something that drives, at rest; return when the first Twist came."""
        begun = self._said(text)
        first = self.twists.wait(moves, begun, HEAR_S)
        self.assertEqual(first.value, twist)
        measured('end of "{}" to Twist'.format(text), first.at - self.out)
        return first.at

    def _one_neutral(self, begun, words):
        """Check that the last message after a time is the one neutral one; return its delay."""
        self.node.joys.wait_silence(0.5)
        said = self.node.joys.since(begun)
        neutral = [item for item in said if not any(item.value.axes)]
        self.assertEqual(neutral, said[-1:], 'not one neutral at the end: {}'.format(said[-4:]))
        return measured(words, neutral[0].at - begun)
