# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's newest laser scan."""
import threading
import time

import numpy as np
import rospy
from sensor_msgs.msg import LaserScan

from mhri.core.robots.names import topic_of
from mhri.ros.graph.unsubscribe import unsubscribe


class ScanFeed:
    """The newest ``sensor_msgs/LaserScan``; subscribed between :meth:`open` and :meth:`close`.

    :param robot: the robot's name (namespace)
    :param topics: relative to the namespace; of several that speak the newest message counts
    """

    def __init__(self, robot, topics, clock=time.monotonic):
        self._topics = [topic_of(robot, topic) for topic in topics]
        self._clock = clock
        self._lock = threading.Lock()
        self._subscribers = []
        self._message = None
        self._heard_at = None

    def open(self):
        """Begin to listen (blocking: it asks the master)."""
        # No queue_size, for the sake of a recorder of the same topic in this program.
        self._subscribers = [rospy.Subscriber(topic, LaserScan, self._hear, tcp_nodelay=True)
                             for topic in self._topics]

    def close(self):
        """Stop listening and forget (blocking: it asks the master)."""
        subscribers, self._subscribers = self._subscribers, []
        for subscriber in subscribers:
            unsubscribe(subscriber)
        with self._lock:
            self._message = self._heard_at = None

    def _hear(self, message):
        with self._lock:
            self._message, self._heard_at = message, self._clock()

    def take(self):
        """Return (ranges, angle_min, angle_increment, range_max), or None where nothing is new.

        ``ranges`` is an array [m] in which NaN stands for no measurement: nothing within reach, too
        near, or outside what the sensor says it can. Angles [rad] begin ahead and grow to the left.
        """
        with self._lock:
            message, self._message = self._message, None
        if message is None:
            return None
        if isinstance(message, rospy.AnyMsg):
            message = LaserScan().deserialize(message._buff)
        ranges = np.array(message.ranges, dtype=float)
        with np.errstate(invalid='ignore'):
            ranges[~((ranges >= message.range_min) & (ranges <= message.range_max))] = np.nan
        return ranges, message.angle_min, message.angle_increment, message.range_max

    def age_s(self):
        """Return the age of the newest scan [s], None before the first."""
        with self._lock:
            return None if self._heard_at is None else self._clock() - self._heard_at
