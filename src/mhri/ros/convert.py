# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Turns messages into values and back."""
import math
import struct

from geometry_msgs.msg import Twist
import rospy

from mhri.core.driving.limits import Velocity
from mhri.core.robots.link import Motion


def header_of(message, message_class):
    """Return (number, stamp [s]) of a message, or None if its type has no header.

    :param message: of the class, or ``rospy.AnyMsg`` with its bytes
    """
    if not message_class._has_header:
        return None
    if isinstance(message, rospy.AnyMsg):
        seq, seconds, nanoseconds = struct.unpack_from('<III', message._buff)
        return seq, seconds + 1e-9 * nanoseconds
    return message.header.seq, message.header.stamp.to_sec()


def to_twist(linear_mps, angular_rad_s):
    """Return a planar ``geometry_msgs/Twist`` (REP-103: x forward, z up)."""
    message = Twist()
    message.linear.x = linear_mps
    message.angular.z = angular_rad_s
    return message


def from_twist(message):
    """Return the planar part of a ``geometry_msgs/Twist`` as a :class:`Velocity`."""
    return Velocity(message.linear.x, message.angular.z)


def yaw_of(quaternion):
    """Return the heading [rad, (-pi, pi]] of an orientation about the vertical axis."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def motion_from_odometry(message):
    """Return the :class:`Motion` of a ``nav_msgs/Odometry``."""
    pose, twist = message.pose.pose, message.twist.twist
    return Motion(twist.linear.x, twist.angular.z, pose.position.x, pose.position.y,
                  yaw_of(pose.orientation), twist.linear.y)


def motion_from_turtle_pose(message):
    """Return the :class:`Motion` of a ``turtlesim/Pose``."""
    return Motion(message.linear_velocity, message.angular_velocity, message.x, message.y,
                  message.theta)
