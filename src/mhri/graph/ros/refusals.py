# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Counts the impossible things that a topic says, and logs them at most once a second."""
import threading

import genpy
import rospy

LOG_EVERY_S = 1.0


class Refusals:
    """The refusals of one topic, from any thread.

    :param topic: its full name, for the log
    :param clock: seconds, monotonic
    """

    def __init__(self, topic, clock):
        self._topic = topic
        self._clock = clock
        self._lock = threading.Lock()
        self._count = 0
        self._logged_at = None

    @property
    def count(self):
        """Number of messages with a refused part so far."""
        return self._count

    def read(self, message, message_class):
        """Return a message as one of its class, None if its bytes are not valid.

        :param message: of the class, or ``rospy.AnyMsg``, which comes if another subscriber of the
            topic in this program asked for bytes
        """
        if not isinstance(message, rospy.AnyMsg):
            return message
        try:
            return message_class().deserialize(message._buff)
        except (genpy.DeserializationError, UnicodeDecodeError) as error:
            self.note('a {} of these bytes ({})'.format(message_class._type, error))
            return None

    def note(self, problem, verdict='is impossible'):
        """Count a message, and log what is wrong with it unless just logged.

        :param problem: the impossible part in words, e.g. 'angular velocity of 1e+30 rad/s'
        :param verdict: what is wrong with it
        """
        now = self._clock()
        with self._lock:
            self._count += 1
            count = self._count
            if self._logged_at is not None and now - self._logged_at < LOG_EVERY_S:
                return
            self._logged_at = now
        rospy.logwarn('%s: %s %s; left out (%d so far)', self._topic, problem, verdict, count)
