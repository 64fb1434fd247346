# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The receiving end of a velocity topic: what a robot is sent, and when."""
import math
import time

from geometry_msgs.msg import Twist
import rospy


class VelocityEnd:
    """The receiving end of one velocity topic."""

    def __init__(self, topic):
        self.received = []
        self.subscriber = rospy.Subscriber(topic, Twist, self._on_twist, queue_size=50,
                                           tcp_nodelay=True)

    def _on_twist(self, message):
        self.received.append((time.monotonic(), message.linear.x, message.angular.z))

    def __repr__(self):
        """Say what came last."""
        return '{}: {}'.format(self.subscriber.resolved_name, self.received[-5:])

    def connected(self):
        return self.subscriber.get_num_connections() > 0

    def moves(self):
        """Return whether the last word was to move."""
        return any(any(entry[1:]) for entry in self.received[-1:])

    def after(self, when):
        return [entry for entry in list(self.received) if entry[0] >= when]

    def is_silent(self, seconds=0.5):
        """Return whether nothing was heard for so long [s], but something before that."""
        return bool(self.received) and time.monotonic() - self.received[-1][0] > seconds

    def last(self):
        """Return the last command, NaN before the first."""
        return self.received[-1][1:] if self.received else (math.nan, math.nan)

    def values(self):
        return [entry[1:] for entry in list(self.received)]
