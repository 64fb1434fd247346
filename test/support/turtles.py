#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A node with the topics of turtlesim, and as many turtles as it is told.

``turtles.py NAME ...``: each turtle has ``NAME/pose`` (``turtlesim/Pose``, 62.5 Hz) and obeys
``NAME/cmd_vel`` for 1 s, as turtlesim_node has it. It sets no parameters.
"""
import math
import os
import sys
import time

sys.path.append(os.path.join(os.path.dirname(os.path.realpath(__file__)), 'messages'))

from geometry_msgs.msg import Twist  # noqa: E402
import rospy  # noqa: E402
from turtlesim.msg import Pose  # noqa: E402

PERIOD_S = 0.016
WATCHDOG_S = 1.0


class Turtle:

    def __init__(self, name):
        self._command = (-WATCHDOG_S, 0.0, 0.0)
        self._x = self._y = 5.544445
        self._theta = 0.0
        self._publisher = rospy.Publisher(name + '/pose', Pose, queue_size=1)
        rospy.Subscriber(name + '/cmd_vel', Twist, self._obey, queue_size=1)

    def _obey(self, message):
        self._command = (time.monotonic(), message.linear.x, message.angular.z)

    def step(self):
        at, linear, angular = self._command
        if time.monotonic() - at > WATCHDOG_S:
            linear = angular = 0.0
        self._theta = math.remainder(self._theta + angular * PERIOD_S, 2.0 * math.pi)
        self._x += linear * math.cos(self._theta) * PERIOD_S
        self._y += linear * math.sin(self._theta) * PERIOD_S
        self._publisher.publish(Pose(self._x, self._y, self._theta, linear, angular))


def main():
    rospy.init_node('turtlesim')
    turtles = [Turtle(name) for name in rospy.myargv()[1:]]
    rate = rospy.Rate(1.0 / PERIOD_S)
    while not rospy.is_shutdown():
        for turtle in turtles:
            turtle.step()
        try:
            rate.sleep()
        except rospy.ROSInterruptException:
            break


if __name__ == '__main__':
    main()
