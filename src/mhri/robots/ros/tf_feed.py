# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tf says, for little: a dozen robots tell it 600 messages a second, of which few matter here.

``tf2_ros`` makes objects of each. Here names and numbers are read from the bytes as they are; what
becomes of them is worked out for the frames that are asked for, when they are asked for. Waking up
for each message would still cost a quarter of a core: the thread of a connection, which rospy gives
each publisher, sleeps a moment after it has read, and then finds several of them together.
"""
import struct
import threading
import time

import rospy
from tf2_msgs.msg import TFMessage

from mhri.base.tf_tree import frame_name, TfTree
from mhri.graph.ros.messages import bytes_of
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe

MOST_TRANSFORMS = 1000
# How long a connection sleeps, and what comes within so short a time was read together [s].
SLEEPS_S, TOGETHER_S = 0.1, 0.02
_COUNT, _NUMBERS = struct.Struct('<I'), struct.Struct('<7d')
# Of a std_msgs/Header what is before its frame: number and stamp.
_HEADER_BYTES = 12


def transforms(buff):
    """Yield (parent, child, 7 numbers) of the bytes of a ``tf2_msgs/TFMessage``.

    :raises struct.error: they are none
    :raises UnicodeDecodeError: likewise
    """
    at = _COUNT.size
    for _ in range(min(_COUNT.unpack_from(buff)[0], MOST_TRANSFORMS)):
        names, at = [], at + _HEADER_BYTES
        for _ in ('parent', 'child'):
            length, = _COUNT.unpack_from(buff, at)
            at += _COUNT.size
            names.append(frame_name(buff[at:at + length].decode()))
            at += length
        yield (*names, _NUMBERS.unpack_from(buff, at))
        at += _NUMBERS.size


class TfFeed:
    """The :class:`TfTree` of ``/tf`` and ``/tf_static``, while anybody has it open.

    :param clock: seconds, monotonic: a transform is as old as its hearing, whatever clock its
        sender has
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
        """Begin to listen (blocking: it asks the master); once more changes nothing.

        :param user: whoever needs it until it calls :meth:`close`, where there are several
        """
        with self._opening:
            self._users.add(user)
            if self._subscribers:
                return
            self._closed.clear()
            # Many robots tell of what never moves, such as a laser, on /tf again and again.
            self._subscribers = [
                rospy.Subscriber(topic, bytes_of(TFMessage), self._hear, topic == '/tf_static')
                for topic in ('/tf', '/tf_static')]

    def close(self, user=None):
        """Stop listening once no other user is left (blocking: it asks the master)."""
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
        except (struct.error, UnicodeDecodeError):
            self._refusals.note('a message of these bytes')
            return
        with self._lock:
            for parent, child, numbers in found:
                self._tree.see(parent, child, numbers, at_s)
        if not static:
            self._rest()

    def _rest(self):
        """Let the next messages of this connection gather, once for all that were read together."""
        if self._clock() - getattr(self._thread, 'woke_at', -SLEEPS_S) > TOGETHER_S:
            self._closed.wait(SLEEPS_S)
            self._thread.woke_at = self._clock()

    def find(self, frame, other):
        """Return where a frame lies in another one, as :meth:`TfTree.find` has it."""
        with self._lock:
            return self._tree.find(frame, other)

    def child_above(self, parent, frame):
        """Return the child of a frame above another, as :meth:`TfTree.child_above` has it."""
        with self._lock:
            return self._tree.child_above(parent, frame)

    def matrix(self, frame, other):
        """Return the matrix of a frame in another one, as :meth:`TfTree.matrix` has it."""
        with self._lock:
            found = self._tree.matrix(frame, other)
        return None if found is None else found[0]

    def knows(self, frame):
        """Tell whether anything was said of a frame."""
        with self._lock:
            return self._tree.knows(frame)


#: For all that draw in one process: each that listened by itself would wake up for each message.
SHARED = TfFeed(time.monotonic)
