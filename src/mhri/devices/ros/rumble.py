# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lets the hand feel one thing: robots were stopped or lost."""
import rospy
from std_msgs.msg import Bool, Empty

from mhri.graph.ros.in_force import InForce, STOP_SERVICE


class Rumble:
    """Calls ``shake`` when stop-all is engaged, and at every message of a topic.

    Subscribes to ``/robot_controller/stop_all`` (``std_msgs/Bool``) and to ``topic``
    (``std_msgs/Empty``: a robot was lost). A stop engaged before this node started shakes nobody.
    """

    def __init__(self, shake, topic):
        self._shake = shake
        self._stopped = True
        InForce(STOP_SERVICE).start().subscribe('/robot_controller/stop_all', Bool,
                                                self._on_stop_all, queue_size=10)
        rospy.Subscriber(topic, Empty, self._on_lost, queue_size=1)

    def _on_stop_all(self, message):
        engaged = message.data and not self._stopped
        self._stopped = message.data
        if engaged:
            self._shake()

    def _on_lost(self, _):
        self._shake()
