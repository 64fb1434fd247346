# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The eye of the obstacle brake: which odometry it accepts."""
import io
import math
from types import SimpleNamespace

from nav_msgs.msg import Odometry
import numpy as np
import pytest
import rospy
from sensor_msgs.msg import LaserScan

from mhri.base.limits import Velocity
from mhri.driving.ros.brake_eye import BrakeEye
from mhri.graph.ros.resources import robot_types
from mhri.sensors.brake import Scan
from support.ros_system import wait_for

FAST = Velocity(0.5, 0.0)


def new_eye():
    """Return one that is asked for."""
    made = BrakeEye('bot1', robot_types()[0]['turtlebot3'], clock=lambda: 0.0)
    made.brake.ask(True)
    return made


def odometry(x_m, y_m, speed_mps=0.0, w=1.0):
    """Return a message as the gates have it: in bytes."""
    message, buffer = Odometry(), io.BytesIO()
    message.child_frame_id = 'base'
    message.pose.pose.position.x, message.pose.pose.position.y = x_m, y_m
    message.pose.pose.orientation.w = w
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


def test_without_an_orientation_nothing_is_remembered(monkeypatch):
    """Not the pose of before, either: it drives on."""
    monkeypatch.setattr(rospy, 'logwarn', lambda *words: None)
    eye = new_eye()
    eye.on_odometry(odometry(0.0, 0.0), 1.0)
    eye.brake.see(meets(0.15), 1.0)
    eye.brake.see(meets(9.0), 1.0)
    eye.on_odometry(odometry(0.1, 0.0, w=0.0), 1.1)
    assert eye.brake.allow(FAST, 1.0).linear_mps == 0.0, 'a new scan is required'
    eye.brake.see(meets(9.0), 1.1)
    assert eye.brake.allow(FAST, 1.1) == FAST


def test_without_an_orientation_tf_still_says_where_its_laser_is(monkeypatch):
    asked, heard = [], {}
    monkeypatch.setattr(rospy, 'logwarn', lambda *words: None)
    monkeypatch.setattr(rospy, 'Subscriber', lambda topic, kind, hear, *more, **options: heard.
                        setdefault(topic, lambda message: hear(message, *more)))
    tf = SimpleNamespace(open=lambda who: None, child_above=lambda *frames: '',
                         matrix=lambda *frames: asked.append(frames))
    eye = BrakeEye('bot1', robot_types()[0]['turtlebot3'], lambda: 0.0, tf)
    eye.switch(True)
    wait_for(lambda: heard, what='the scan to be subscribed')
    eye.on_odometry(odometry(0.0, 0.0, w=0.0), 1.0)
    scan = LaserScan(angle_increment=0.1, range_max=3.5, ranges=[1.0] * 60)
    scan.header.frame_id = 'laser'
    heard['/bot1/scan'](scan)
    assert ('base', 'laser') in asked


def test_odometry_that_cannot_be_moves_nothing_and_is_said_once_a_second(monkeypatch):
    eye, said = new_eye(), []
    monkeypatch.setattr(rospy, 'logwarn', lambda *words: said.append(words[0] % words[1:]))
    before = allowed(eye, 0.0, 0.0)[1]
    for number in range(20):
        eye.on_odometry(odometry(5.0, 0.0, 1e30), 2.0 + number)
    assert eye.brake.allow(FAST, 1.0).linear_mps == before
    line, = said
    assert 'bot1' in line and '1e+30' in line
