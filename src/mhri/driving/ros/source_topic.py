# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The topic of one source: who publishes there, who may, and who has gone."""
import time

from geometry_msgs.msg import Twist
import rospy

from mhri.devices.ros.input_node import LOST
from mhri.driving.ownership import Ownership
from mhri.driving.sources import TWIST
from mhri.graph.ros.prompt import hear_promptly
from mhri.graph.ros.rospy_inside import caller_of, link_of, publishers
from mhri.robots.ros.convert import ShortJoy

# The longest text taken from a message.
LONGEST_TEXT = 200
_LATELY_S = 3.0


class SourceTopic:
    """Subscribes a source's topic (``sensor_msgs/Joy`` or ``geometry_msgs/Twist``).

    :param source: :class:`mhri.driving.sources.Source`
    :param strangers: :class:`mhri.graph.ros.in_force.Strangers`, for further publishers
    :param clock: function returning seconds that never go back
    """

    def __init__(self, source, strangers, clock=time.monotonic):
        self.source = source
        self._strangers = strangers
        self.ownership = Ownership()
        self._clock = clock
        self._subscriber = None
        self._is_twist = source.kind == TWIST
        self._links = {}
        self._newest = None, None, None
        self._heard = None
        self._rival = self._refusal = None

    def open(self, on_message):
        """Subscribe; ``on_message(message, self)`` is called on rospy's threads."""
        kind = Twist if self._is_twist else ShortJoy
        self._subscriber = hear_promptly(rospy.Subscriber(
            self.source.topic, kind, on_message, callback_args=self, queue_size=1,
            tcp_nodelay=True))

    def connected(self):
        """Return the caller ids of the connected publishers."""
        return publishers(self._subscriber) if self._subscriber else set()

    def admits(self, message):
        """Tell whether a message counts; a second publisher's does not."""
        caller = caller_of(message)
        # Its own connection may not be in rospy's list yet.
        if not self.ownership.admits(caller, self.connected() | {caller}):
            self._rival = (self._clock(), caller)
            self._strangers.refuse(caller, self.source.topic)
            return False
        self._heard = caller
        return True

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
            number += 1
            self._links[caller] = (link, number)
        lost = name.endswith(LOST)
        name = name[:-len(LOST)] if lost else name
        found = (caller, number, name), name, lost
        self._newest = link, frame, found
        return found

    def has_gone(self):
        """Tell, once, that the publisher listened to is no longer connected."""
        if self._heard is None or self._heard in self.connected():
            return False
        self._links.pop(self._heard, None)
        self._heard = None
        return True

    def refuse(self, reason):
        """Note why a message could not be used, '' if it could."""
        self._refusal = (self._clock(), str(reason)[:LONGEST_TEXT]) if reason else None

    @property
    def spoke(self):
        """Whether anything was heard from its publisher."""
        return self._heard is not None

    @property
    def refusal(self):
        """Why the newest message could not be used, '' if it could or is long ago."""
        said = self._refusal
        return said[1] if said and self._clock() - said[0] < _LATELY_S else ''

    @property
    def rival(self):
        """(node, owner) if a second publisher was refused lately, else None."""
        said = self._rival
        return (said[1], self.ownership.owner) if said and self._clock() - said[0] < _LATELY_S \
            else None
