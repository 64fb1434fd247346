# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Counts impossible values on a topic, and logs them ever more rarely, at most once a second."""
import math
import threading

import genpy
import rospy

from mhri.graph.ros.rospy_inside import keep_link

LOG_EVERY_S, LOG_AT_LEAST_S = 1.0, 60.0


class Refusals:
    """The refusals of one topic, from any thread.

    :param topic: its full name, for the log
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, topic, clock):
        self._topic = topic
        self._clock = clock
        self._lock = threading.Lock()
        self._count = 0
        self._due_at, self._pause_s = -math.inf, LOG_EVERY_S

    @property
    def count(self):
        """Number of messages with a refused part so far."""
        return self._count

    def read(self, message, message_class):
        """Return a message as one of its class, None if its bytes are not valid.

        :param message: of the class, or ``rospy.AnyMsg``, if another subscriber of the topic in
            this program subscribed bytes
        """
        if not isinstance(message, rospy.AnyMsg):
            return message
        try:
            found = message_class().deserialize(message._buff)
            keep_link(found, message)
            return found
        except (genpy.DeserializationError, UnicodeDecodeError) as error:
            self.note('a {} of these bytes ({})'.format(message_class._type, error))
            return None

    def note(self, problem, verdict='is impossible'):
        """Count a message, and log its problem unless just logged.

        :param problem: the impossible part in words, e.g. 'angular velocity of 1e+30 rad/s'
        :param verdict: the predicate of the log line
        """
        now = self._clock()
        with self._lock:
            self._count += 1
            count = self._count
            if now < self._due_at:
                return
            self._due_at = now + self._pause_s
            self._pause_s = min(LOG_AT_LEAST_S, 2.0 * self._pause_s)
        rospy.logwarn('%s: %s %s; left out (%d so far)', self._topic, problem, verdict, count)
