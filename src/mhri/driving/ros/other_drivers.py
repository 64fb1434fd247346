# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Other commanders of a robot: the other publishers of its velocity topics."""
import struct
import time

from geometry_msgs.msg import Twist
import rospy

from mhri.graph.ros.rospy_inside import caller_of, others_only, publishers, type_of, unsubscribe

# A node silent for this long no longer counts as commanding [s].
HEARD_S = 1.0
# Maximum numbers of distinguished nodes and of subscribed topics.
MAX_NODES, MAX_TOPICS = 16, 16
_COMPONENTS = struct.Struct('<6d')


def _is_zero(message):
    """Return whether the bytes of a message (``rospy.AnyMsg``) are a Twist of zeros."""
    if type_of(message) != Twist._type or len(message._buff) != _COMPONENTS.size:
        return False
    return not any(_COMPONENTS.unpack(message._buff))


class OtherDrivers:
    """Subscribes velocity topics of a robot, and tracks all publishers but this node.

    Messages of any type count. Not thread-safe except for the callbacks.

    :param on_motion: called, on a ROS thread, with the caller id of a node that has just sent a
        nonzero message, and the topic
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, on_motion, clock=time.monotonic):
        self._on_motion = on_motion
        self._clock = clock
        self._heard_at = {}
        self._subscribers = {}
        self._met = set()

    def listen(self, topics):
        """Subscribe absolute topics that are not subscribed yet (blocking: calls the master)."""
        for topic in topics:
            if topic not in self._subscribers and len(self._subscribers) < MAX_TOPICS:
                others_only(topic)
                self._subscribers[topic] = rospy.Subscriber(
                    topic, rospy.AnyMsg, self._on_message, topic, queue_size=1, tcp_nodelay=True)

    def _on_message(self, message, topic):
        caller = caller_of(message)
        if caller == rospy.get_name():
            return
        now, key = self._clock(), (caller, topic)
        if key not in self._heard_at and len(self._heard_at) >= MAX_NODES:
            self._heard_at = {kept: at for kept, at in self._heard_at.items() if now - at < HEARD_S}
        if key in self._heard_at or len(self._heard_at) < MAX_NODES:
            self._heard_at[key] = now
        if not _is_zero(message):
            self._on_motion(caller, topic)

    def connected(self):
        """Return {(caller id, topic)} of the connected other publishers, even silent ones."""
        own = rospy.get_name()
        found = {(caller, topic) for topic, subscriber in list(self._subscribers.items())
                 for caller in publishers(subscriber) if caller != own}
        if not found <= self._met:
            self._met = found | self._met if len(self._met) < 10 * MAX_NODES else found
        return found

    def out_of_reach(self, registered):
        """Return the registered publishers that were never connected.

        A node that is no longer connected has ended, even if the master still lists it.

        :param registered: {(caller id, topic)}
        """
        return registered - self._met

    def heard(self, now):
        """Return {(caller id, topic)} of the publishers of the last second."""
        return {key for key, at in list(self._heard_at.items()) if now - at < HEARD_S}

    def close(self):
        """Unsubscribe (blocking: calls the master)."""
        subscribers, self._subscribers = self._subscribers, {}
        for subscriber in subscribers.values():
            unsubscribe(subscriber)
