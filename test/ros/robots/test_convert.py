# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages turned into values: nothing of a robot's motion may be left behind."""
import math

from nav_msgs.msg import Odometry
import pytest

from mhri.robots.link import Motion
from mhri.robots.ros.odometry import MOTIONS


def test_odometry_keeps_all_three_velocities_and_the_pose():
    """A robot that slides sideways moves."""
    message = Odometry()
    twist, pose = message.twist.twist, message.pose.pose
    twist.linear.x, twist.linear.y, twist.angular.z = 0.1, -0.5, 0.2
    pose.position.x, pose.position.y = 3.0, 4.0
    pose.orientation.z, pose.orientation.w = math.sin(0.25), math.cos(0.25)
    assert MOTIONS['nav_msgs/Odometry'](message) == Motion(
        0.1, 0.2, 3.0, 4.0, pytest.approx(0.5), -0.5)


@pytest.mark.parametrize('spoil, problem', [
    (lambda message: setattr(message.twist.twist.linear, 'x', 1e30), 'speed of 1e+30 m/s'),
    (lambda message: setattr(message.pose.pose.position, 'y', -1e30), 'place of -1e+30 m'),
    (lambda message: setattr(message.pose.pose.orientation, 'x', 1e30), 'quaternion of 1e+30')])
def test_odometry_that_cannot_be_is_refused_where_it_comes_in(spoil, problem):
    message = Odometry()
    message.pose.pose.orientation.w = 1.0
    assert MOTIONS['nav_msgs/Odometry'](message).is_standstill()
    spoil(message)
    motion = MOTIONS['nav_msgs/Odometry'](message)
    assert motion.problem == problem and not motion.is_standstill()
