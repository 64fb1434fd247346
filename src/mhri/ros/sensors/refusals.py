# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a topic said that cannot be: counted, and logged once a second at most."""
import threading

import genpy
import rospy

LOG_EVERY_S = 1.0


class Refusals:
    """Of one topic, from any thread.

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
        """Messages of which something was refused so far."""
        return self._count

    def read(self, message, message_class):
        """Return a message as one of its class, None if its bytes are none.

        :param message: of the class, or ``rospy.AnyMsg``: what comes where another subscriber of
            the topic in this program asked for bytes
        """
        if not isinstance(message, rospy.AnyMsg):
            return message
        try:
            return message_class().deserialize(message._buff)
        except (genpy.DeserializationError, UnicodeDecodeError) as error:
            self.note('a {} of these bytes ({})'.format(message_class._type, error))
            return None

    def note(self, problem):
        """Count a message, and say what is wrong with it unless that was said just now.

        :param problem: what it says, in words, e.g. 'angular velocity of 1e+30 rad/s'
        """
        now = self._clock()
        with self._lock:
            self._count += 1
            count = self._count
            if self._logged_at is not None and now - self._logged_at < LOG_EVERY_S:
                return
            self._logged_at = now
        rospy.logwarn('%s: %s cannot be; left out (%d so far)', self._topic, problem,
                      count)
