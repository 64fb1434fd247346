#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot of which mhri was told nothing: a node with the topics that it is given.

``plain_robot.py COMMAND ODOMETRY [OPTION]...``: reads velocity commands and tells how it moves, 20
times a second (``nav_msgs/Odometry``, or ``turtlesim/Pose`` with ``--turtle``). It obeys at once,
and stops 0.5 s after the last command. ``--sign TOPIC TYPE`` is one more topic that it publishes.
``--halfway`` stops while it comes up: it subscribes its commands when it
gets SIGUSR1. ``--frozen``: its odometry says that it stands, whatever it does.
"""
import argparse
import math
import os
import signal
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), 'messages'))

from genpy.dynamic import generate_dynamic  # noqa: E402
from geometry_msgs.msg import Twist  # noqa: E402
from nav_msgs.msg import Odometry  # noqa: E402
import rospy  # noqa: E402
from turtlesim.msg import Pose  # noqa: E402

PERIOD_S = 0.05
WATCHDOG_S = 0.5


class PlainRobot:

    def __init__(self, options):
        self._turtle, self._lies = options.turtle, options.frozen
        self._lock = threading.Lock()
        self._command = (-WATCHDOG_S, 0.0, 0.0)
        self._moved_at = time.monotonic()
        self._x = self._y = self._yaw = 0.0
        self._publisher = rospy.Publisher(options.odometry, Pose if self._turtle else Odometry,
                                          queue_size=1)
        self._signs = [rospy.Publisher(topic, generate_dynamic(kind, 'uint8 state\n')[kind],
                                       queue_size=1) for topic, kind in options.sign]
        self._topic = options.command
        if not options.halfway:
            self.listen()

    def listen(self):
        rospy.Subscriber(self._topic, Twist, self._obey, queue_size=1, tcp_nodelay=True)

    def _obey(self, message):
        with self._lock:
            now = time.monotonic()
            self._move(now)
            self._command = (now, message.linear.x, message.angular.z)

    def _move(self, now):
        """Go on as it was told, however short that is; return the velocity."""
        at, linear, angular = self._command
        moved_s = max(0.0, min(now, at + WATCHDOG_S) - self._moved_at)
        self._moved_at = now
        self._yaw += angular * moved_s
        self._x += linear * math.cos(self._yaw) * moved_s
        self._y += linear * math.sin(self._yaw) * moved_s
        return (0.0, 0.0) if now > at + WATCHDOG_S else (linear, angular)

    def step(self):
        with self._lock:
            linear, angular = self._move(time.monotonic())
            if self._lies:
                linear = angular = self._x = self._y = self._yaw = 0.0
            self._publisher.publish(self._pose(linear, angular))

    def _pose(self, linear, angular):
        if self._turtle:
            return Pose(self._x, self._y, self._yaw, linear, angular)
        message = Odometry()
        message.pose.pose.position.x, message.pose.pose.position.y = self._x, self._y
        message.pose.pose.orientation.z = math.sin(self._yaw / 2)
        message.pose.pose.orientation.w = math.cos(self._yaw / 2)
        message.twist.twist.linear.x, message.twist.twist.angular.z = linear, angular
        return message


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('command')
    parser.add_argument('odometry')
    parser.add_argument('--turtle', action='store_true')
    parser.add_argument('--sign', nargs=2, action='append', default=[])
    parser.add_argument('--halfway', action='store_true')
    parser.add_argument('--frozen', action='store_true')
    options = parser.parse_args(rospy.myargv()[1:])
    go_on = threading.Event()
    signal.signal(signal.SIGUSR1, lambda *_: go_on.set())
    rospy.init_node('base')
    robot = PlainRobot(options)
    rate = rospy.Rate(1.0 / PERIOD_S)
    while not rospy.is_shutdown():
        if go_on.is_set():
            go_on.clear()
            robot.listen()
        robot.step()
        try:
            rate.sleep()
        except rospy.ROSInterruptException:
            break


if __name__ == '__main__':
    main()
