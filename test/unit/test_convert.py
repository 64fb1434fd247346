# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages turned into values: nothing of a robot's motion may be left behind."""
import math

import pytest

pytest.importorskip('nav_msgs.msg')

from nav_msgs.msg import Odometry  # noqa: E402

from mhri.core.robots.link import Motion  # noqa: E402
from mhri.ros.convert import motion_from_odometry  # noqa: E402


def test_odometry_keeps_all_three_velocities_and_the_pose():
    """A robot that slides sideways moves."""
    message = Odometry()
    twist, pose = message.twist.twist, message.pose.pose
    twist.linear.x, twist.linear.y, twist.angular.z = 0.1, -0.5, 0.2
    pose.position.x, pose.position.y = 3.0, 4.0
    pose.orientation.z, pose.orientation.w = math.sin(0.25), math.cos(0.25)
    assert motion_from_odometry(message) == Motion(0.1, 0.2, 3.0, 4.0, pytest.approx(0.5), -0.5)
