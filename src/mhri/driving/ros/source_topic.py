# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The topic of one source, and its connected, accepted and lost publishers."""
import time

from geometry_msgs.msg import Twist
import rospy

from mhri.devices.ros.input_node import LOST
from mhri.driving.sources import TWIST
from mhri.graph.ros.non_blocking import read_inline
from mhri.graph.ros.rospy_inside import caller_of, link_of, publishers
from mhri.robots.ros.convert import ShortJoy

# Maximum length of a text taken from a message.
LONGEST_TEXT = 200
_LATELY_S = 3.0


class SourceTopic:
    """Subscribes a source's topic (``sensor_msgs/Joy`` or ``geometry_msgs/Twist``).

    :param source: :class:`mhri.driving.sources.Source`
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, source, clock=time.monotonic):
        self.source = source
        self._clock = clock
        self._subscriber = None
        self._is_twist = source.kind == TWIST
        self._links, self._count = {}, 0
        self._newest = None, None, None
        self._heard = None
        self._rival = self._refusal = None

    def open(self, on_message):
        """Subscribe; ``on_message(message, self)`` is called on rospy's threads."""
        kind = Twist if self._is_twist else ShortJoy
        self._subscriber = read_inline(rospy.Subscriber(
            self.source.topic, kind, on_message, callback_args=self, queue_size=1,
            tcp_nodelay=True))

    def connected(self):
        """Return the caller ids of the connected publishers."""
        return publishers(self._subscriber) if self._subscriber else set()

    def on_heard(self, caller, owner):
        """Store the publisher of a message; one that is not the owner is a rival."""
        if caller == owner:
            self._heard = caller
        else:
            self._rival = self._clock(), caller

    def device_of(self, message):
        """Return (identity of the device, its ``header.frame_id``, whether it is lost).

        A restarted node has the same name but another connection.
        """
        link, frame = link_of(message), '' if self._is_twist else message.frame_id
        known, said, found = self._newest
        if link is known and frame == said:
            return found
        caller, name = caller_of(message), frame[:LONGEST_TEXT]
        known, number = self._links.get(caller, (None, 0))
        if link is not known:
            # Never the number of another connection, also after this one has gone.
            number = self._count = self._count + 1
            self._links[caller] = (link, number)
        lost = name.endswith(LOST)
        name = name[:-len(LOST)] if lost else name
        found = (caller, number, name), name, lost
        self._newest = link, frame, found
        return found

    def has_gone(self):
        """Return whether the accepted publisher has disconnected, once for each time."""
        if self._heard is None or self._heard in self.connected():
            return False
        self._links.pop(self._heard, None)
        self._heard = None
        return True

    def refuse(self, reason):
        """Store why a message could not be used, '' if it was used."""
        self._refusal = (self._clock(), str(reason)[:LONGEST_TEXT]) if reason else None

    @property
    def spoke(self):
        """Whether a message of the accepted publisher was received."""
        return self._heard is not None

    @property
    def refusal(self):
        """Why the newest message could not be used, '' if it was used or is long ago."""
        said = self._refusal
        return said[1] if said and self._clock() - said[0] < _LATELY_S else ''

    @property
    def rival(self):
        """A second publisher that was refused recently, else ''."""
        said = self._rival
        return said[1] if said and self._clock() - said[0] < _LATELY_S else ''
