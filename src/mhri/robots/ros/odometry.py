# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a message of odometry means: a row for each type of message."""
from mhri.graph.ros.messages import message_class
from mhri.robots.link import Motion
from mhri.robots.ros.convert import yaw_of


def _of_odometry(message):
    pose, twist, turn = message.pose.pose, message.twist.twist, message.pose.pose.orientation
    return Motion.told(twist.linear.x, twist.angular.z, pose.position.x, pose.position.y,
                       yaw_of(turn), twist.linear.y, turn=(turn.x, turn.y, turn.z, turn.w))


def _of_turtle_pose(message):
    return Motion.told(message.linear_velocity, message.angular_velocity, message.x, message.y,
                       message.theta, 0.0)


#: {type of :data:`mhri.base.robot_types.ODOMETRY_TYPES`: function of a message that returns its
#: :class:`Motion`, in which what cannot be is NaN}
MOTIONS = {'nav_msgs/Odometry': _of_odometry, 'turtlesim/Pose': _of_turtle_pose}


def odometry_of(robot_type):
    """Return (class of a robot's messages of odometry, function that returns their Motion).

    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :raises MessageMissing: the package of the messages is not installed here
    """
    return message_class(robot_type.odometry_type), MOTIONS[robot_type.odometry_type]
