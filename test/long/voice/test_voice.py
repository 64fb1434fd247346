# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The voice's node as it is shipped: speech of espeak-ng into a FIFO, Twists and requests out."""
import contextlib
import signal
import time

import psutil
import pytest
import rospy
from std_msgs.msg import Bool

from support.input_nodes import is_neutral
from support.own_node import own_node
from support.ros_system import wait_for
from support.node_tools import measured, moves, rests
from support.voice_case import HEAR_S, LEFT_TWIST, ROBOTS, START_S, VoiceTest

system = own_node('voice', '../../support/mux.launch')
# Who is misheard says it again.
pytestmark = pytest.mark.timeout(600)


class Voice(VoiceTest):
    """Every test starts a node of its own."""

    def test_a_spoken_motion_lasts_two_seconds_and_what_is_lost_is_a_zero(self):
        """A lost microphone and a lost listener are found again, and nothing moves by itself.

        Suspended it opens nothing; killed, no process listens any longer.
        """
        self.assertEqual((self.node.listeners(), self.node.joys.since(0.0)), ([], []))
        self._ready()
        first = self._drive()
        heard = [item.value for item in self.node.heard.since(0.0) if item.value.accepted]
        self.assertEqual(heard[-1:], [('robot drive forward', 'forward 0.50', True, '')])
        self.twists.wait(rests, first, HEAR_S)
        begun = next(item.value.stamp for item in self.node.joys.since(0.0)
                     if not is_neutral(item.value))
        # The robot's zero may be here before the neutral Joy behind it.
        neutral = self.node.joys.wait(
            lambda value: value.stamp > begun and is_neutral(value), 0.0, HEAR_S)
        lasted = measured('a spoken command lasts', neutral.value.stamp - begun)
        self.assertTrue(1.5 < lasted < 2.5, lasted)
        self._drive()
        pulled = self.microphone.pull()
        zero = self.twists.wait(rests, pulled)
        measured('pulled to first zero Twist', zero.at - pulled)
        self._one_neutral(pulled, 'pulled to neutral Joy', 0.4)
        self.microphone.plug()
        begun = self.node.joys.wait(lambda value: True, pulled + 0.5, START_S).at
        self.waits.settle('', patience_s=START_S)
        self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])
        self._drive('robot turn left', LEFT_TWIST)
        old, begun = self.node.listeners(), time.monotonic()
        for process in old:
            with contextlib.suppress(psutil.NoSuchProcess):
                process.kill()
        self.node.joys.wait(lambda value: value.frame.endswith('lost'), begun)
        wait_for(lambda: self.node.listeners() and self.node.listeners() != old, what='none begins',
                 timeout_s=START_S)
        self._drive()
        listeners = self.node.listeners()
        begun = self.node.process.send(signal.SIGKILL)
        self.twists.wait(rests, begun)
        self.assertEqual(psutil.wait_procs(listeners, START_S)[1], [])

    def test_talk_moves_nothing_and_requests_reach_the_panel_and_the_mux(self):
        """Talk: a sentence with the words in it, or a command without the wake word.

        Requests: with the robots of the panel's list, and the numbers that they have there.
        """
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
        for text, wish in (('robot select bot two', ('select', ('bot2',))),
                           ('robot stop recording', ('stop_recording', ()))):
            begun = self._said(text, ' '.join((wish[0],) + wish[1]))
            self.assertEqual(self.requests.wait(lambda value: True, begun, HEAR_S).value, wish)
        rospy.set_param('/mhri/robots', ROBOTS + ['tango'])
        numbers = {name: number for number, name in enumerate(ROBOTS, 1)}
        rospy.set_param('/mhri/robot_numbers', {**numbers, 'tango': 6})
        self._said('robot select number six', 'select tango')
        self.assertFalse([item for item in self.twists.since(0.0) if moves(item.value)])
        # Push-to-talk replaces the wake word; while held it is sent again, as the screen does.
        push = rospy.Publisher('/mhri_voice/push_to_talk', Bool, queue_size=10)
        wait_for(push.get_num_connections, what='nobody listens to push-to-talk')
        push.publish(True)
        held = rospy.Timer(rospy.Duration(1.0), lambda _: push.publish(True))
        self.addCleanup(held.shutdown)
        self._drive('drive forward')
        held.shutdown()
        push.unregister()
        self._said('robot use joystick')
        self.modes.wait_newest('joy', patience_s=HEAR_S)
        wait_for(lambda: not self.node.listeners(), what='still listens', timeout_s=HEAR_S)
