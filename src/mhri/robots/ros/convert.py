# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Turns messages into values and back."""
import math
import struct

import genpy
from geometry_msgs.msg import Twist
import rospy
from sensor_msgs.msg import Joy

from mhri.base.limits import Velocity

# With its length before it.
_TWIST = struct.Struct('<I6d')
# linear.x and angular.z of six.
_PLANAR = struct.Struct('<d32xd')
# Number, time, and how long frame_id is.
_HEADER = struct.Struct('<4I')
_COUNT = struct.Struct('<I')


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


def packed_twist(linear_mps, angular_rad_s):
    """Return the same as bytes, the length before them: what TCPROS sends."""
    return _TWIST.pack(_TWIST.size - 4, linear_mps, 0.0, 0.0, 0.0, 0.0, angular_rad_s)


def from_twist(message):
    """Return the planar part of a ``geometry_msgs/Twist`` as a :class:`Velocity`."""
    return Velocity(message.linear.x, message.angular.z)


def yaw_of(quaternion):
    """Return the heading [rad, (-pi, pi]] of an orientation about the vertical axis."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


class PlanarTwist(Twist):
    """``geometry_msgs/Twist`` as a :class:`Velocity`, ``velocity``, for subscribers.

    What genpy generates makes an object of every part of a message. At a stick's pace hardly any of
    that code is in the processor's cache when it is needed: it takes longer than the rules do.
    """

    def __init__(self):
        self.velocity = None

    def deserialize(self, data):
        """Read it from bytes.

        :raises genpy.DeserializationError: they are too few, or too many
        """
        try:
            self.velocity = Velocity(*_PLANAR.unpack(data))
        except struct.error as error:
            raise genpy.DeserializationError(error)
        return self


class ShortJoy(Joy):
    """``sensor_msgs/Joy`` with ``axes``, ``buttons`` and ``frame_id``, but without its header."""

    def __init__(self):
        self.frame_id, self.axes, self.buttons = '', (), ()

    def deserialize(self, data):
        """Read it from bytes.

        :raises genpy.DeserializationError: they are too few
        """
        try:
            at = _HEADER.size + _HEADER.unpack_from(data)[3]
            self.frame_id = data[_HEADER.size:at].decode('utf-8', 'replace')
            self.axes, at = _numbers(data, at, 'f')
            self.buttons, at = _numbers(data, at, 'i')
        except struct.error as error:
            raise genpy.DeserializationError(error)
        return self


def _numbers(data, at, kind):
    """Return an array that begins there as a tuple, and where it ends."""
    count, = _COUNT.unpack_from(data, at)
    at += _COUNT.size
    return struct.unpack_from('<{}{}'.format(count, kind), data, at), at + 4 * count


def is_driven(robot):
    """Tell whether the velocity the gates last sent to a robot is not zero.

    :param robot: ``mhri/RobotGate``
    """
    sent = robot.sent
    return any((sent.linear.x, sent.linear.y, sent.angular.z))


def round_trip_s(robot):
    """Return the round trip to a robot [s] as measured by the gates; None if unknown.

    :param robot: ``mhri/RobotGate``
    """
    return robot.round_trip_s if math.isfinite(robot.round_trip_s) else None
