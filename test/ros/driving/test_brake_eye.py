# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The eye of the obstacle brake: which odometry it accepts."""
import io
import math

from nav_msgs.msg import Odometry
import numpy as np
import pytest
import rospy

from mhri.base.limits import Velocity
from mhri.driving.ros.brake_eye import BrakeEye
from mhri.graph.ros.resources import robot_types
from mhri.sensors.brake import Scan

FAST = Velocity(0.5, 0.0)


def new_eye():
    """Return one that is asked for."""
    made = BrakeEye('bot1', robot_types()[0]['turtlebot3'], clock=lambda: 0.0)
    made.brake.ask(True)
    return made


def odometry(x_m, y_m, speed_mps=0.0):
    """Return a message as the gates have it: in bytes."""
    message, buffer = Odometry(), io.BytesIO()
    message.pose.pose.position.x, message.pose.pose.position.y = x_m, y_m
    message.pose.pose.orientation.w = 1.0
    message.twist.twist.linear.x = speed_mps
    message.serialize(buffer)
    found = rospy.AnyMsg()
    found._buff = buffer.getvalue()
    return found


def meets(way_m):
    """Return a scan that meets something ahead at that way, and looks nowhere else."""
    return Scan(np.array([way_m] + [math.nan] * 359), 0.0, 2 * math.pi / 360, 0.12, 10.0)


def allowed(eye, x_m, y_m):
    """Return what is allowed after a scan made at a place, and 0.3 m further on."""
    eye.on_odometry(odometry(x_m, y_m), 1.0)
    eye.brake.see(meets(0.8), 1.0)
    first = eye.brake.allow(FAST, 1.0).linear_mps
    eye.on_odometry(odometry(x_m + 0.3, y_m), 1.1)
    return first, eye.brake.allow(FAST, 1.0).linear_mps


def test_a_place_in_a_national_grid_is_one_like_any_other():
    near, far = allowed(new_eye(), 1.0, 2.0), allowed(new_eye(), 5_900_000.0, -420_000.0)
    assert near[1] < near[0] and far == pytest.approx(near, abs=1e-6)


def test_odometry_that_cannot_be_moves_nothing_and_is_said_once_a_second(monkeypatch):
    eye, said = new_eye(), []
    monkeypatch.setattr(rospy, 'logwarn', lambda *words: said.append(words[0] % words[1:]))
    before = allowed(eye, 0.0, 0.0)[1]
    for number in range(20):
        eye.on_odometry(odometry(5.0, 0.0, 1e30), 2.0 + number)
    assert eye.brake.allow(FAST, 1.0).linear_mps == before
    line, = said
    assert 'bot1' in line and '1e+30' in line
