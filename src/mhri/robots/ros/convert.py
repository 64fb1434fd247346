# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts messages to values and back."""
import math
import struct

import genpy
from geometry_msgs.msg import Twist
import rospy
from sensor_msgs.msg import Joy

from mhri.base.geometry import heading_of
from mhri.base.limits import Velocity

# Length, then the message.
_TWIST = struct.Struct('<I6d')
# Everything before frame_id, with number and time 0; the velocity follows frame_id.
_STAMPED = struct.Struct('<I12xI')
# Number, time, and the length of frame_id.
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


def to_twist(linear_mps, angular_rad_s, lateral_mps=0.0):
    """Return a planar ``geometry_msgs/Twist`` (REP-103: x forward, y to the left, z up)."""
    message = Twist()
    message.linear.x, message.linear.y = linear_mps, lateral_mps
    message.angular.z = angular_rad_s
    return message


def packed_twist(linear_mps, angular_rad_s, lateral_mps=0.0):
    """Return the same as bytes after their length, as TCPROS sends it."""
    return _TWIST.pack(_TWIST.size - 4, linear_mps, lateral_mps, 0.0, 0.0, 0.0, angular_rad_s)


def packed_guard_zero(frame_id):
    """Return a zero ``geometry_msgs/TwistStamped`` as bytes after their length."""
    text = frame_id.encode()
    return _STAMPED.pack(_STAMPED.size - 4 + len(text) + 48, len(text)) + text + bytes(48)


def from_twist(message):
    """Return the planar part of a ``geometry_msgs/Twist`` as a :class:`Velocity`."""
    return Velocity(message.linear.x, message.angular.z, message.linear.y)


def yaw_of(quaternion):
    """Return the heading of an orientation about the vertical axis [rad], NaN if it has none."""
    return heading_of(quaternion.x, quaternion.y, quaternion.z, quaternion.w)


def turn_of(heading_rad):
    """Return (z, w) of the orientation of a heading; x and y are 0."""
    return math.sin(0.5 * heading_rad), math.cos(0.5 * heading_rad)


class ShortJoy(Joy):
    """``sensor_msgs/Joy`` with ``axes``, ``buttons`` and ``frame_id``, but without its header."""

    def __init__(self):
        self.frame_id, self.axes, self.buttons = '', (), ()

    def deserialize(self, data):
        """Read the message from bytes.

        :raises genpy.DeserializationError: the bytes are too few
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
    """Return the array at an offset as a tuple, and the offset of its end."""
    count, = _COUNT.unpack_from(data, at)
    at += _COUNT.size
    return struct.unpack_from('<{}{}'.format(count, kind), data, at), at + 4 * count


def round_trip_s(robot):
    """Return the round trip to a robot [s] as measured by the drive; None if unknown.

    :param robot: ``mhri/RobotDrive``
    """
    return robot.round_trip_s if math.isfinite(robot.round_trip_s) else None
