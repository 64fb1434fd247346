# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Readers of odometry: a row for each type of message."""
from typing import Any, NamedTuple, Optional, Tuple

from mhri.base.tf_tree import OdometryFrames
from mhri.graph.ros.messages import message_class
from mhri.graph.ros.rospy_inside import link_of
from mhri.robots.link import Motion
from mhri.robots.ros.convert import header_of, yaw_of


class Reading(NamedTuple):
    """An odometry message: motion, (number, stamp [s]) if its type has them, frames, sender.

    ``source`` is the same object for all messages of one connection.
    """

    motion: Motion
    header: Optional[Tuple[int, float]]
    frames: OdometryFrames
    source: Any


def _of_odometry(message):
    pose, twist, turn = message.pose.pose, message.twist.twist, message.pose.pose.orientation
    return Motion.reported(twist.linear.x, twist.angular.z, pose.position.x, pose.position.y,
                           yaw_of(turn), twist.linear.y, turn=(turn.x, turn.y, turn.z, turn.w))


def _of_turtle_pose(message):
    return Motion.reported(message.linear_velocity, message.angular_velocity, message.x, message.y,
                           message.theta, 0.0)


#: {type of :data:`mhri.base.robot_types.ODOMETRY_TYPES`: function of a message that returns its
#: :class:`Motion`, with NaN for impossible values}
MOTIONS = {'nav_msgs/Odometry': _of_odometry, 'turtlesim/Pose': _of_turtle_pose}


def odometry_of(robot_type):
    """Return (class of a robot's odometry messages, function that reads them).

    The function returns a :class:`Reading`, as :class:`mhri.graph.ros.stream.Stream` requires.

    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :raises MessageMissing: the package of the messages is not installed
    """
    motion_of = MOTIONS[robot_type.odometry_type]

    def read(message, note):
        motion = motion_of(message)
        if motion.problem:
            note(motion.problem)
        return Reading(motion, header_of(message, type(message)), OdometryFrames.of(message),
                       link_of(message))
    return message_class(robot_type.odometry_type), read
