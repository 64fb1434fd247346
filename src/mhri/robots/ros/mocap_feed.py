# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's pose from motion capture, if a vrpn_client_node tracks it."""
import math
import threading
import time

from geometry_msgs.msg import PoseStamped
import rospy

from mhri.base.mocap import Pose
from mhri.base.plausible import PLACE, QUATERNION, sifted
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe
from mhri.robots.ros.convert import yaw_of

TOPIC = '/vrpn_client_node/{}/pose'
_KINDS = (PLACE,) * 2 + (QUATERNION,) * 4


class MocapFeed:
    """The newest ``geometry_msgs/PoseStamped`` of ``/vrpn_client_node/<robot>/pose``.

    Subscribed between :meth:`open` and :meth:`close`; a robot that nobody tracks has no pose.

    :param robot: the robot's name, also that of its rigid body in the tracker
    """

    def __init__(self, robot, clock=time.monotonic):
        self._topic = TOPIC.format(robot)
        self._clock = clock
        self._lock = threading.Lock()
        self._subscriber = None
        self._message = None
        self._pose = None
        self._heard_at = None
        self._refusals = Refusals(self._topic, clock)

    def open(self):
        """Start listening (blocking: it asks the master)."""
        self._subscriber = rospy.Subscriber(self._topic, PoseStamped, self._hear, tcp_nodelay=True)

    def close(self):
        """Stop listening and forget (blocking: it asks the master)."""
        subscriber, self._subscriber = self._subscriber, None
        if subscriber is not None:
            unsubscribe(subscriber)
        with self._lock:
            self._message = self._pose = self._heard_at = None

    def _hear(self, message):
        with self._lock:
            self._message, self._heard_at = message, self._clock()

    def pose(self):
        """Return the newest :class:`mhri.base.mocap.Pose`, None before the first."""
        with self._lock:
            message, self._message = self._message, None
            if message is not None:
                self._pose = self._read(message) or self._pose
            return self._pose

    def take(self):
        """Return (pose, when it was heard [s]) where that is new and can be, else None."""
        with self._lock:
            message, self._message = self._message, None
            pose = None if message is None else self._read(message)
            if pose is None or not pose.is_finite():
                return None
            self._pose = pose
            return pose, self._heard_at

    def _read(self, message):
        """Return the :class:`Pose` in a message, NaN if impossible; None for mere bytes."""
        message = self._refusals.read(message, PoseStamped)
        if message is None:
            return None
        place, turn = message.pose.position, message.pose.orientation
        (x, y, *turn_values), problem = sifted(
            _KINDS, (place.x, place.y, turn.x, turn.y, turn.z, turn.w))
        if problem:
            self._refusals.note(problem)
        return Pose(x, y, math.nan if any(map(math.isnan, turn_values)) else yaw_of(turn))

    def refused(self):
        """Return the number of impossible poses left out."""
        return self._refusals.count

    def age_s(self):
        """Return the age of the newest pose [s], None before the first."""
        with self._lock:
            return None if self._heard_at is None else self._clock() - self._heard_at
