#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes what a robot does and is told as the robot itself sees it, link or no link.

``observer.py NAME [COMMAND]``: a line is the time [s, monotonic], the speeds [m/s, rad/s] and the
place [m]; or the time and the speeds of a command on that topic.
"""
import os
import sys
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rospy


def write(*numbers):
    """Write a line at once: those of two threads would get into each other."""
    os.write(1, (' '.join('{:.5f}'.format(number) for number in (time.monotonic(),) + numbers)
                 + '\n').encode('ascii'))


def on_odometry(message):
    """Write what it does."""
    twist, place = message.twist.twist, message.pose.pose.position
    write(twist.linear.x, twist.angular.z, place.x, place.y)


if __name__ == '__main__':
    rospy.init_node('observer', anonymous=True)
    name, *commands = sys.argv[1:]
    rospy.Subscriber('/{}/odom'.format(name), Odometry, on_odometry, queue_size=10,
                     tcp_nodelay=True)
    for topic in commands:
        rospy.Subscriber('/{}/{}'.format(name, topic), Twist, lambda message: write(
            message.linear.x, message.angular.z), queue_size=10, tcp_nodelay=True)
    rospy.spin()
