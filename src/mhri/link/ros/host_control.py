# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The host's view of control over a linked robot: publishes it, and requests control."""
from dataclasses import replace
import json
import threading

import rospy
from std_srvs.srv import Trigger, TriggerResponse

from mhri.link.control import ControlStatus, LEAVE
from mhri.msg import LinkControl

# Timeout of the robot's answer, and period of repeating the request [s].
ANSWER_S, AGAIN_S = 2.0, 0.2


class HostControl:
    """Publishes ``~state`` (``mhri/LinkControl``, latched), offers ``~take_control`` (``Trigger``).

    :param host: name of this computer on the link
    :param secret: whether the link has keys
    :param send: sends bytes to the robot
    """

    def __init__(self, name, host, secret, send):
        self._name = name
        self._send = send
        self._answered = threading.Condition()
        self._standing = ControlStatus()
        self._heard = False
        self._asked = 0
        self.state = LinkControl(host=host, keys=secret)
        self._publisher = rospy.Publisher('~state', LinkControl, queue_size=5, latch=True)
        self._publisher.publish(self.state)
        rospy.Service('~take_control', Trigger, self._take)

    def tick(self, linked, problem=''):
        """Update whether the robot is linked, or why it is not."""
        with self._answered:
            self._say(replace(self._standing, said=problem) if problem else self._standing, linked)

    def on_control_status(self, standing):
        """Handle a status from the robot."""
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
        """Request control; if another host has it, a second request takes it."""
        with self._answered:
            self._asked = number = max(self._asked, self._standing.asked) + 1
            tries = round(ANSWER_S / AGAIN_S) if self._heard and self.state.linked else 0
        for _ in range(tries):
            # Not under the lock: messages are received under the lock of the sender.
            self._send(json.dumps([number]).encode('ascii'))
            with self._answered:
                if self._answered.wait_for(lambda: self._standing.asked >= number, AGAIN_S):
                    answer = self._standing.answer
                    return TriggerResponse(
                        not answer, answer or 'this computer has control of ' + self._name)
        return TriggerResponse(False, '{} does not answer: is it linked?'.format(self._name))

    def leave(self):
        """Release control before this end of the link closes."""
        self._send(LEAVE)
