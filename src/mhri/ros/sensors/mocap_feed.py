# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's pose by motion capture, where a vrpn_client_node tracks it."""
import threading
import time

from geometry_msgs.msg import PoseStamped
import rospy

from mhri.core.robots.mocap import Pose
from mhri.ros.convert import yaw_of
from mhri.ros.graph.unsubscribe import unsubscribe

TOPIC = '/vrpn_client_node/{}/pose'


class MocapFeed:
    """The newest ``geometry_msgs/PoseStamped`` of ``/vrpn_client_node/<robot>/pose``.

    Subscribed between :meth:`open` and :meth:`close`; a robot that nobody tracks has no pose.

    :param robot: the robot's name, which is that of its rigid body in the tracker
    """

    def __init__(self, robot, clock=time.monotonic):
        self._topic = TOPIC.format(robot)
        self._clock = clock
        self._lock = threading.Lock()
        self._subscriber = None
        self._message = None
        self._pose = None
        self._heard_at = None

    def open(self):
        """Begin to listen (blocking: it asks the master)."""
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
        """Return the newest :class:`mhri.core.robots.mocap.Pose`, None before the first."""
        with self._lock:
            message, self._message = self._message, None
            if message is not None:
                if isinstance(message, rospy.AnyMsg):
                    message = PoseStamped().deserialize(message._buff)
                place = message.pose.position
                self._pose = Pose(place.x, place.y, yaw_of(message.pose.orientation))
            return self._pose

    def age_s(self):
        """Return the age of the newest pose [s], None before the first."""
        with self._lock:
            return None if self._heard_at is None else self._clock() - self._heard_at
