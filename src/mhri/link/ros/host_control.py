# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who is in control of a linked robot, on the host: says it, and asks for it."""
import json
import threading

import rospy
from std_srvs.srv import Trigger, TriggerResponse

from mhri.link.control import Standing
from mhri.msg import LinkControl

# The robot answers a request within this, or not at all [s]; meanwhile it is repeated.
ANSWER_S, AGAIN_S = 2.0, 0.2
LEAVE = b'[0]'


class HostControl:
    """Publishes ``~state`` (``mhri/LinkControl``, latched), offers ``~take_control`` (``Trigger``).

    :param host: what this computer is called on the link
    :param secret: with keys
    :param send: sends bytes down
    """

    def __init__(self, name, host, secret, send):
        self._name = name
        self._send = send
        self._answered = threading.Condition()
        self._standing = Standing()
        self._heard = False
        self._asked = 0
        self.state = LinkControl(host=host, keys=secret)
        self._publisher = rospy.Publisher('~state', LinkControl, queue_size=5, latch=True)
        self._publisher.publish(self.state)
        rospy.Service('~take_control', Trigger, self._take)

    def tick(self, linked):
        """Take note of whether the robot is heard."""
        with self._answered:
            self._say(self._standing, linked)

    def on_standing(self, standing):
        """Take in what the robot says."""
        with self._answered:
            if standing.said and standing.said != self._standing.said:
                rospy.loginfo('%s: %s', self._name, standing.said)
            self._standing, self._heard = standing, True
            self._say(standing, self.state.linked)
            self._answered.notify_all()

    def _say(self, standing, linked):
        state = LinkControl(self.state.host, linked, self.state.keys, standing.may,
                            standing.holder, standing.asking, standing.said)
        if state != self.state:
            self.state = state
            self._publisher.publish(state)

    def _take(self, _):
        """Ask for control; where another host has it, ask twice."""
        with self._answered:
            self._asked = number = max(self._asked, self._standing.asked) + 1
            tries = round(ANSWER_S / AGAIN_S) if self._heard and self.state.linked else 0
        for _ in range(tries):
            # Not under the lock: what comes in is taken in under that of the sender.
            self._send(json.dumps([number]).encode('ascii'))
            with self._answered:
                if self._answered.wait_for(lambda: self._standing.asked >= number, AGAIN_S):
                    answer = self._standing.answer
                    return TriggerResponse(
                        not answer, answer or 'this computer has control of ' + self._name)
        return TriggerResponse(False, '{} does not answer: is it linked?'.format(self._name))

    def leave(self):
        """Give up control: this end of the link is closed."""
        self._send(LEAVE)
