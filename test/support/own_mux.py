#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's own multiplexer, as twist_mux is one, with its lock on: ``own_mux.py OUTPUT INPUT...``.

It reads the inputs and passes nothing on.
"""
from geometry_msgs.msg import Twist
import rospy


def main():
    output, *inputs = rospy.myargv()[1:]
    rospy.init_node('twist_mux')
    publisher = rospy.Publisher(output, Twist, queue_size=1)
    subscribers = [rospy.Subscriber(topic, Twist, lambda message: None, queue_size=1)
                   for topic in inputs]
    rospy.spin()
    del publisher, subscribers


if __name__ == '__main__':
    main()
