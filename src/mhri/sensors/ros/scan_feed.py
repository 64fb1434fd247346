# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's newest laser scan."""
import threading
import time

import rospy
from sensor_msgs.msg import LaserScan

from mhri.base.names import topic_of
from mhri.base.plausible import beams_problem, thinned
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe
from mhri.sensors.readings import no_return_of, read_ranges

# More than one per pixel around the view; a scan with more is thinned out to this.
MOST_POINTS = 4000
# What types say that do not say it.
NO_RETURN = {}


class ScanFeed:
    """The newest ``sensor_msgs/LaserScan``; subscribed between :meth:`open` and :meth:`close`.

    :param robot: the robot's name (namespace)
    :param topics: relative to the namespace; if several speak, the newest message counts
    :param no_return: see :class:`mhri.base.robot_types.RobotType`
    """

    def __init__(self, robot, topics, clock=time.monotonic, no_return=NO_RETURN):
        self._topics = [topic_of(robot, topic) for topic in topics]
        self._clock = clock
        self._no_return = no_return
        self._lock = threading.Lock()
        self._subscribers = []
        self._message = None
        self._heard_at = None
        #: tf frame of the newest scan that was taken
        self.frame = ''
        self._refusals = [Refusals(topic, clock) for topic in self._topics]

    def open(self):
        """Start listening (blocking: it asks the master)."""
        # No queue_size, for the sake of a recorder of the same topic in this program.
        self._subscribers = [rospy.Subscriber(topic, LaserScan, self._hear, refusals,
                                              tcp_nodelay=True)
                             for topic, refusals in zip(self._topics, self._refusals)]

    def close(self):
        """Stop listening and forget (blocking: it asks the master)."""
        subscribers, self._subscribers = self._subscribers, []
        for subscriber in subscribers:
            unsubscribe(subscriber)
        with self._lock:
            self._message = self._heard_at = None

    def _hear(self, message, refusals):
        message = refusals.read(message, LaserScan)
        if message is None:
            return
        problem = beams_problem(len(message.ranges), message.angle_min, message.angle_increment)
        if problem:
            refusals.note(problem)
            return
        with self._lock:
            self._message, self._heard_at = message, self._clock()

    def note(self, problem, verdict):
        """Count and log why a scan is not used, see :meth:`Refusals.note`."""
        self._refusals[0].note(problem, verdict)

    def refused(self):
        """Return the number of impossible scans left out."""
        return sum(refusals.count for refusals in self._refusals)

    def take(self):
        """Return (ranges, angle_min, angle_increment, range_max), or None if nothing is new.

        ``ranges`` is an array [m] in which NaN means no measurement: nothing within reach, too
        near, or outside the sensor's stated limits, see
        :func:`mhri.sensors.readings.read_ranges`. There are at most
        :data:`MOST_POINTS`, each the nearest of the beams around it. Angles [rad] begin ahead and
        grow to the left.
        """
        with self._lock:
            message, self._message = self._message, None
        if message is None:
            return None
        self.frame = message.header.frame_id
        readings = read_ranges(message.ranges, message.range_min, message.range_max,
                               no_return_of(self._no_return, message.range_max))
        ranges, together = thinned(readings.ranges, MOST_POINTS)
        step = message.angle_increment
        return (ranges, message.angle_min + 0.5 * (together - 1) * step, together * step,
                message.range_max)

    def age_s(self):
        """Return the age of the newest scan [s], None before the first."""
        with self._lock:
            return None if self._heard_at is None else self._clock() - self._heard_at
