# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A subscription to raw bytes that can be opened and closed any number of times.

rospy's own leaks resources when unregistered (ros_comm issues 544, 1998, 2373; the project is
archived, so they will stay): the epoll handle of each topic, which is in a reference cycle and so
stays open until the garbage collector collects its oldest generation; and, if a publisher's machine
does not answer, a thread that requests a connection for ever.
"""
import io

import rospy

from mhri.graph.ros.parallel_calls import connectable
from mhri.graph.ros.master_api import MasterApi
from mhri.graph.ros.rospy_inside import type_of, unsubscribe

# Maximum size of one read from the socket [bytes]; the rest follows the next time. From 64 kB to 16
# MB the CPU time per picture was measured to be the same.
BUFF_SIZE = 1 << 20


class Subscription:
    """The messages of one topic as bytes, of any type.

    rospy has one connection for all subscribers of a topic in a program, with the class of the
    first and the queue size of the last. So this sets no queue size, lest a recorder of the same
    topic miss messages: the callback only stores, so no queue can build up.

    :param on_bytes: called with (type, bytes-like) on rospy's thread; it must return at once
    """

    def __init__(self, topic, on_bytes):
        self.topic = topic
        self._on_bytes = on_bytes
        self._subscriber = rospy.Subscriber(topic, rospy.AnyMsg, self._on_message,
                                            buff_size=BUFF_SIZE, tcp_nodelay=True)

    def _on_message(self, message):
        message_type = type_of(message)
        if isinstance(message, rospy.AnyMsg):
            self._on_bytes(message_type, message._buff)
        else:  # another subscriber in this program was first
            buffer = io.BytesIO()
            message.serialize(buffer)
            self._on_bytes(message_type, buffer.getbuffer())

    def connections(self):
        """Return the number of connected publishers."""
        return self._subscriber.get_num_connections()

    def close(self):
        """Unsubscribe without leaking resources (blocking: calls the master)."""
        unsubscribe(self._subscriber)


def reachable(caller_id, topic, timeout_s=1.0):
    """Return whether any publisher of a topic answers (blocking for at most 3 s).

    rospy's thread for a publisher that does not answer lives as long as the program: so subscribe
    only reachable topics.

    :raises MasterError: the master cannot be reached
    """
    return bool(connectable(MasterApi(caller_id, timeout_s).publisher_uris(topic)))
