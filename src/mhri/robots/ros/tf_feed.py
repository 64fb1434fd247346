# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A cheap tf listener: a dozen robots send 600 messages a second, few of which matter here.

``tf2_ros`` creates objects for each message. Here names and numbers are read from the bytes, and
transforms are computed only for requested frames. Waking up for each message would still cost a
quarter of a core, so the thread of each connection sleeps a moment after reading, and then finds
several messages together.
"""
import threading
import time

import rospy
from tf2_msgs.msg import TFMessage

from mhri.base.tf_tree import frame_name, TfTree
from mhri.base.wire import Wire
from mhri.graph.ros.messages import bytes_of
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe

MAX_TRANSFORMS = 1000
# Sleep of a connection, and maximum spacing of messages that were read together [s].
SLEEPS_S, TOGETHER_S = 0.1, 0.02


def transforms(buff):
    """Yield (parent, child, 7 numbers) of the bytes of a ``tf2_msgs/TFMessage``.

    :raises ValueError: they are malformed
    """
    wire = Wire('tf2_msgs/TFMessage', buff)
    for _ in range(min(wire.numbers('<I')[0], MAX_TRANSFORMS)):
        wire.header()
        names = [frame_name(bytes(wire.array()).decode()) for _ in ('parent', 'child')]
        yield (*names, wire.numbers('<7d'))


class TfFeed:
    """The :class:`TfTree` of ``/tf`` and ``/tf_static``, while any user has it open.

    :param clock: monotonic seconds: the age of a transform counts from its receipt, whatever clock
        its sender has
    """

    def __init__(self, clock):
        self._clock = clock
        self._users = set()
        self._lock = threading.Lock()
        self._tree = TfTree()
        self._subscribers = []
        self._opening = threading.Lock()
        self._refusals = Refusals('/tf', clock)
        self._thread = threading.local()
        self._closed = threading.Event()

    def open(self, user=None):
        """Subscribe (blocking: it asks the master); idempotent.

        :param user: identifies the user until it calls :meth:`close`, if there are several
        """
        with self._opening:
            self._users.add(user)
            if self._subscribers:
                return
            self._closed.clear()
            # Many robots repeat fixed transforms, such as that of a laser, on /tf.
            self._subscribers = [
                rospy.Subscriber(topic, bytes_of(TFMessage), self._hear, topic == '/tf_static')
                for topic in ('/tf', '/tf_static')]

    def close(self, user=None):
        """Unsubscribe once no other user is left (blocking: it asks the master)."""
        with self._opening:
            self._users.discard(user)
            if self._users:
                return
            self._closed.set()
            subscribers, self._subscribers = self._subscribers, []
            for subscriber in subscribers:
                unsubscribe(subscriber)

    def _hear(self, message, static):
        at_s = None if static else self._clock()
        try:
            found = list(transforms(message._buff))
        except ValueError:
            self._refusals.note('a message of these bytes')
            return
        with self._lock:
            for parent, child, numbers in found:
                self._tree.add(parent, child, numbers, at_s)
        if not static:
            self._rest()

    def _rest(self):
        """Wait for further messages of this connection, once for all that were read together."""
        if self._clock() - getattr(self._thread, 'woke_at', -SLEEPS_S) > TOGETHER_S:
            self._closed.wait(SLEEPS_S)
            self._thread.woke_at = self._clock()

    def find(self, frame, other):
        """Return the pose of a frame in another one, see :meth:`TfTree.find`."""
        with self._lock:
            return self._tree.find(frame, other)

    def child_above(self, parent, frame):
        """Return the child of a frame above another, see :meth:`TfTree.child_above`."""
        with self._lock:
            return self._tree.child_above(parent, frame)

    def matrix(self, frame, other):
        """Return the matrix of a frame in another one, see :meth:`TfTree.matrix`."""
        with self._lock:
            found = self._tree.matrix(frame, other)
        return None if found is None else found[0]

    def knows(self, frame):
        """Return whether a frame is known."""
        with self._lock:
            return self._tree.knows(frame)


#: Shared by everything that draws in a process: separate ones would all wake up per message.
SHARED = TfFeed(time.monotonic)
