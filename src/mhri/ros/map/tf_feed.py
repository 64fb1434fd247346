# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tf says, for little: a dozen robots tell it 600 messages a second, of which few matter here.

``tf2_ros`` makes objects of each. Here names and numbers are read from the bytes as they are; what
becomes of them is worked out for the frames that are asked for, when they are asked for.
"""
import struct
import threading

import rospy
from tf2_msgs.msg import TFMessage

from mhri.core.map.tf_tree import frame_name, TfTree
from mhri.ros.graph.rospy_inside import unsubscribe
from mhri.ros.messages import bytes_of
from mhri.ros.sensors.refusals import Refusals

MOST_TRANSFORMS = 1000
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
    """The :class:`TfTree` of ``/tf`` and ``/tf_static``, from :meth:`open` on.

    :param clock: seconds, monotonic: a transform is as old as its hearing, whatever clock its
        sender has
    """

    def __init__(self, clock):
        self._clock = clock
        self._lock = threading.Lock()
        self._tree = TfTree()
        self._subscribers = []
        self._refusals = Refusals('/tf', clock)

    def open(self):
        """Begin to listen (blocking: it asks the master)."""
        if not self._subscribers:
            self._subscribers = [
                rospy.Subscriber('/tf', bytes_of(TFMessage), self._hear, False, tcp_nodelay=True),
                rospy.Subscriber('/tf_static', bytes_of(TFMessage), self._hear, True)]

    def close(self):
        """Stop listening (blocking: it asks the master)."""
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

    def find(self, frame, other):
        """Return where a frame lies in another one, as :meth:`TfTree.find` has it."""
        with self._lock:
            return self._tree.find(frame, other)

    def knows(self, frame):
        """Tell whether anything was said of a frame."""
        with self._lock:
            return self._tree.knows(frame)
