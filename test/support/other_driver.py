#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A program of somebody else that drives a robot: it repeats one velocity until it is ended.

``other_driver.py TOPIC HZ M_PER_S [__name:=NAME]``. It knows nothing of stops and cancels.
"""
from geometry_msgs.msg import Twist
import rospy


def main():
    topic, rate_hz, linear = rospy.myargv()[1:4]
    rospy.init_node('other_driver')
    publisher = rospy.Publisher(topic, Twist, queue_size=1)
    message = Twist()
    message.linear.x = float(linear)
    # Not on the main thread: rospy handles SIGTERM there, and closing a connection in the middle of
    # publish() waits for ever for the lock that publish() holds (rospy's QueuedConnection).
    rospy.Timer(rospy.Duration(1.0 / float(rate_hz)), lambda _: publisher.publish(message))
    rospy.spin()


if __name__ == '__main__':
    main()
