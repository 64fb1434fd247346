# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gate of one robot: its rule with the publishers that its words leave by."""
import time

from geometry_msgs.msg import Twist, TwistStamped
import rospy

from mhri.core.driving.gate import GateRule
from mhri.core.driving.limits import ZERO
from mhri.core.robots.names import topic_of
from mhri.ros.convert import to_twist
from mhri.ros.graph.master_api import MasterApi, MasterError
from mhri.ros.graph.prompt import PromptPublisher

# Below a robot's namespace: where its guard (utils/remote/mhri_guard) listens.
GUARD = 'mhri_guard/command'
# A gate that takes over says a zero again that is not older than this.
REPEAT_ZERO_S = 1.0


class Gate:
    """A :class:`GateRule` with the publishers of its robot.

    One publisher for each velocity topic of the template (``geometry_msgs/Twist``, queue of 1:
    newest wins, and nothing is waited for: a dead robot delays nobody); what is sent goes to the
    first one that has a subscriber. Before them all comes the guard that may run on the robot
    (``/<robot>/mhri_guard/command``, ``geometry_msgs/TwistStamped``, stamped by the clock here).

    There may be two of a robot, in two processes (:mod:`mhri.ros.driving.keeper`). One of them
    leads; the
    other one ``follows``: it decides the same and keeps its words to itself. ``lost_at`` is when a
    connection to the robot was last dropped.

    :param name: the robot
    :param topics: absolute names of its velocity topics, in order of preference
    :param limits: :class:`mhri.core.robots.robot_types.Limits`
    :param on_sent: called with (robot, topic, message) after each message; quick
    """

    def __init__(self, name, topics, limits, on_sent=lambda robot, topic, message: None):
        self._on_sent = on_sent
        self.name = name
        self.topics = list(topics)
        self.rule = GateRule(limits)
        self._guard = PromptPublisher('/{}/{}'.format(name, GUARD), TwistStamped)
        self._publishers = [self._guard] + [
            PromptPublisher(topic, Twist) for topic in self.topics]
        self._used = None
        self.follows = False
        self.lost_at = None
        self._zero_at = None

    @classmethod
    def of_type(cls, name, robot_type, on_sent=lambda robot, topic, message: None):
        """Return the gate of a robot of a type (:class:`RobotType`)."""
        topics = [topic_of(name, topic) for topic in robot_type.command]
        return cls(name, topics, robot_type.limits, on_sent)

    def send(self, velocity, now):
        """Publish what the rule returned (None: nothing)."""
        if velocity is None:
            return
        chosen = next((publisher for publisher in self._publishers
                       if publisher.get_num_connections()), None)
        if self._used not in (None, chosen):
            self._publish(self._used, ZERO)
        self._used = chosen
        self._zero_at = now if velocity.is_zero() else None
        if chosen is not None:
            self._on_sent(self.name, chosen.name, self._publish(chosen, velocity))

    def _publish(self, publisher, velocity):
        """Publish, unless the other gate speaks; return the message."""
        message = to_twist(velocity.linear_mps, velocity.angular_rad_s)
        if publisher is self._guard:
            message = TwistStamped(twist=message)
            message.header.stamp = rospy.Time.from_sec(time.time())
        if not self.follows:
            publish = publisher.publish_urgent if velocity.is_zero() else publisher.publish
            publish(message)
        return message

    def follow(self):
        """From now on the other gate of this robot speaks."""
        self.follows = True

    def lead(self):
        """Speak from now on."""
        self.follows = False

    def drop_cut(self):
        """Take back what a link that is cut has not delivered; tell whether there was such a link.

        This gate does not reach the robot any more then. A guard is left what it has: it knows what
        is late.
        """
        return any([publisher.drop_cut() for publisher in self._publishers
                    if publisher is not self._guard])

    def take_over(self, now):
        """Speak again: the other gate has ended, and may have taken its last zero with it."""
        if self.follows:
            self.lead()
            if self._zero_at is not None and now - self._zero_at < REPEAT_ZERO_S:
                self.send(ZERO, self._zero_at)

    def reachable(self):
        """Tell whether any velocity topic has a subscriber."""
        return any(publisher.get_num_connections() for publisher in self._publishers)

    def guarded(self):
        """Tell whether the commands go through a guard on the robot."""
        return self._guard.get_num_connections() > 0

    def announce(self):
        """Tell the master of the velocity topics once more, where nobody listens (blocking).

        It tells a robot of a new publisher once. One that was out of reach then would never know.
        """
        if self.reachable():
            return
        own = rospy.get_node_uri()
        try:
            MasterApi(rospy.get_name()).call_many(
                [('registerPublisher', publisher.resolved_name, publisher.type, own)
                 for publisher in self._publishers])
        except MasterError as error:
            rospy.logdebug('%s: its topics cannot be announced now: %s', self.name, error)

    def unregister(self):
        """Give the topics back (blocking: it asks the master); others may look all the while."""
        publishers, self._publishers = self._publishers, []
        self._used = None
        for publisher in publishers:
            publisher.unregister()
