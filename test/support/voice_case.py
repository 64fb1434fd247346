# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A node of the voice for each test, beside a mux, and somebody who speaks to it."""
from collections import namedtuple
import shutil
import sys
import time

import psutil
import rospy
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

from mhri.msg import Heard, PanelRequest
from support import graph
from support import speech
from support.input_nodes import InputCase, InputNode, START_S
from support.room import Room
from support.node_tools import measured, moves, NEUTRAL, Process, Recorder, Stick
from support.ros_system import insist, NotYet, wait_for

ROBOTS = ['bot1', 'bot2', 'rover']
# Half of the speed limit is what a spoken drive begins with.
FORWARD_TWIST = (0.25, 0.0)
LEFT_TWIST = (0.0, 0.75)
VOICES = [speech.Voice(name, 150, 50) for name in ('en-us+m3', 'en-us+f2', 'en-us')] * 2
# On a loaded machine recognising takes longer than the word.
HEAR_S = 30.0
TOOLS = ('espeak-ng', 'sox')
HeardItem = namedtuple('HeardItem', 'text command accepted reason')


def require_speech():
    """Fail in plain words where nobody can speak here, or nobody can hear.

    :raises AssertionError: names the packages that are missing
    """
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    try:
        import pocketsphinx  # noqa: F401
    except ImportError:
        missing.append('python3-pocketsphinx')
    if missing:
        raise AssertionError('install {} (and pocketsphinx-en-us): speech cannot be tested without'
                             .format(', '.join(missing)))


class VoiceNode(InputNode):
    """``mhri_voice`` in a process, suspended."""

    def __init__(self, *arguments):
        self.heard = Recorder(graph.HEARD, Heard, lambda message: HeardItem(
            message.text, message.command, message.accepted, message.reason))
        super().__init__('mhri_voice', graph.VOICE, lambda: Process(
            [sys.executable, '-c', 'from mhri.nodes.mhri_voice import main; main()', *arguments]))
        self.heard.wait_publisher(START_S)

    def listeners(self):
        """Return the processes it has begun."""
        return psutil.Process(self.pid).children(recursive=True)

    def wait_words(self, *parts):
        """Wait until the state in words has these parts."""
        wait_for(lambda: all(part in self.words() for part in parts),
                 what='never said {}: {}'.format(parts, self.process.said()), timeout_s=START_S)

    def end(self):
        """Make sure that everything is gone."""
        super().end()
        self.heard.close()


class VoiceTest(InputCase):
    """A mux, and a node of its own for each test."""

    def setUp(self):
        """Begin with the virtual joystick's mode, in which the mux suspends the voice."""
        require_speech()
        if rospy.has_param('/mhri_voice'):
            rospy.delete_param('/mhri_voice')
        rospy.set_param('/mhri/robots', ROBOTS)
        self.microphone = Room()
        self.stick = Stick(graph.STICK).wait_listener()
        self.stick.hold(NEUTRAL)
        self.stops = Recorder(graph.STOP_ALL, Bool, lambda message: message.data)
        self.requests = Recorder(graph.PANEL_REQUEST, PanelRequest, lambda message: (
            message.action, tuple(message.robots)))
        super().setUp()
        self._release()
        self.node = VoiceNode('_source:=' + self.microphone.path)
        self.requests.wait_publisher()

    def tearDown(self):
        """Leave nothing behind."""
        self._release()
        super().tearDown()
        self.microphone.end()
        self.stick.silence()
        for recorder in (self.stops, self.requests):
            recorder.close()

    def _release(self):
        """Take stop-all back, once the stick is known to be at neutral."""
        release = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)
        wait_for(lambda: release(False).success, what='stop-all cannot be released')

    def _ready(self):
        """Choose the voice's mode; wait until the mux would follow a command."""
        self._mode('voice')
        self.node.joys.wait(lambda value: True, 0.0, START_S)
        self.waits.settle('', patience_s=START_S)

    def _resume(self):
        """Listen although another source drives."""
        self.assertTrue(self.node.resume().success)
        self.node.wait_words('reading the sound stream')

    def _say(self, text):
        """Say something; return when it began."""
        begun = time.monotonic()
        self.microphone.say(text)
        return begun

    def _said(self, text, command='', release=True):
        """Say something until it is taken, as a person would; return when that was begun.

        :param command: what it has to be taken for; any beginning of it
        :param release: whether to release a stop that it was taken for

        A recogniser that understands nineteen of twenty would fail one of twenty tests.
        """
        voices = iter(VOICES)

        def taken():
            voice = next(voices, None)
            assert voice is not None, '"{}" was never taken'.format(text)
            begun = time.monotonic()
            self.out = self.microphone.say(text, voice)
            # What is left of an earlier stop is no answer to this.
            item = self.node.heard.wait(lambda item: 'stop' not in item.text or 'stop' in text,
                                        begun, HEAR_S).value
            wrong = item.command == 'stop' and 'stop' not in text
            if item.accepted and item.command.startswith(command) and not wrong:
                return begun
            if release:
                self._release()
            raise NotYet(str(item))
        return insist(taken, '"{}" to be taken'.format(text), 10 * HEAR_S)

    def _drive(self, text='robot drive forward', twist=FORWARD_TWIST):
        """Say something that drives, at rest; return when the first Twist came.

        The mux may wait for neutral, where it has missed the voice for half a second meanwhile.
        """
        def driven():
            begun = self._said(text)
            try:
                return self.twists.wait(moves, begun, HEAR_S)
            except NotYet as error:
                assert [item for item in self.waits.since(begun - HEAR_S) if item.value], error
                # What is said may sound like a stop on the way, which is carried out at once.
                self._release()
                self.waits.settle('', patience_s=START_S)
                raise
        first = insist(driven, '"{}" to drive'.format(text), 10 * HEAR_S)
        self.assertEqual(first.value, twist)
        measured('end of "{}" to Twist'.format(text), first.at - self.out)
        return first.at
