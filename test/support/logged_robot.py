#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A light robot without a watchdog: it keeps what it was told last, and writes each word down.

``logged_robot.py NAME LOG [HZ [flipper]]``: subscribes ``/NAME/cmd_vel`` and publishes
``/NAME/odom``, at 20 Hz where nothing else is said. A line of the log is: when [s,
CLOCK_MONOTONIC], linear, angular. With ``flipper`` it subscribes ``/NAME/flipper``; a line of
LOG.flipper is: when, value.
"""
import sys
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rospy
from std_msgs.msg import Float64


def main():
    """Run until shut down."""
    name, path, *more = rospy.myargv(sys.argv)[1:]
    rospy.init_node('base', disable_signals=False)
    last = [0.0, 0.0]
    with open(path, 'a', buffering=1) as log, open(path + '.flipper', 'a', buffering=1) as flips:
        def obey(message):
            last[:] = message.linear.x, message.angular.z
            log.write('{!r} {!r} {!r}\n'.format(time.monotonic(), *last))

        rospy.Subscriber('/{}/cmd_vel'.format(name), Twist, obey, queue_size=50, tcp_nodelay=True)
        if 'flipper' in more:
            rospy.Subscriber('/{}/flipper'.format(name), Float64, lambda message: flips.write(
                '{!r} {!r}\n'.format(time.monotonic(), message.data)), queue_size=50,
                tcp_nodelay=True)
        odometry = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        message = Odometry()
        rate = rospy.Rate(float((more or [20.0])[0]))
        while not rospy.is_shutdown():
            message.header.stamp = rospy.Time.now()
            message.twist.twist.linear.x, message.twist.twist.angular.z = last
            odometry.publish(message)
            try:
                rate.sleep()
            except rospy.ROSInterruptException:
                break


if __name__ == '__main__':
    main()
