#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A network in front of a robot's guard, as a process: frozen, it stalls both ways.

What is said meanwhile waits in its sockets, and comes all at once when it goes on. To everybody
else it is the guard, which has a namespace of its own (the argument): there is no other way to it.
"""
import sys

from geometry_msgs.msg import TwistStamped
import rospy


def carry(source, target):
    """Pass on all that is said on a topic."""
    out = rospy.Publisher(target, TwistStamped, queue_size=1000, tcp_nodelay=True)
    rospy.Subscriber(source, TwistStamped, out.publish, tcp_nodelay=True)


if __name__ == '__main__':
    rospy.init_node('mhri_guard')
    far = sys.argv[1] + '/mhri_guard/'
    carry('mhri_guard/command', far + 'command')
    carry(far + 'echo', 'mhri_guard/echo')
    rospy.spin()
