# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot on a task senses: when it counts as silent."""
from types import SimpleNamespace

from nav_msgs.msg import Odometry
import pytest
import rospy

from mhri.graph.ros.resources import robot_types
from mhri.tasks.ros.robot_senses import RobotSenses
from mhri.tasks.run import Facts, missing_senses


@pytest.fixture
def robot(monkeypatch):
    """A robot at time ``now``; ``say`` hands a message of odometry to it."""
    heard = {}
    monkeypatch.setattr(rospy, 'Subscriber', lambda topic, kind, hear, *more, **options: heard.
                        setdefault(topic, lambda message: hear(message, *more)))
    made = SimpleNamespace(now=10.0)
    made.senses = RobotSenses('bot1', robot_types()[0]['turtlebot3'], lambda: made.now)

    def say(speed_mps, w=1.0):
        message = Odometry()
        message.pose.pose.orientation.w = w
        message.twist.twist.linear.x = speed_mps
        heard['/bot1/odom'](message)
        made.senses.look()
    made.say = say
    return made


def test_odometry_that_cannot_be_is_silence(robot):
    """It says where the robot is no better than none."""
    assert robot.senses.ages()['odometry_age_s'] is None
    robot.say(0.1)
    robot.now = 10.5
    for speed_mps in (1e30, float('nan')):
        robot.say(speed_mps)
        assert robot.senses.ages()['odometry_age_s'] == 0.5
    robot.say(0.1)
    assert robot.senses.ages()['odometry_age_s'] == 0.0


def test_without_an_orientation_no_task_has_a_pose_and_hears_why(robot):
    robot.say(0.1, w=0.0)
    told = robot.senses.ages()
    waits_for = missing_senses(Facts(robot.now, **told))
    assert told['odometry_age_s'] is None and '(0, 0, 0, 0)' in waits_for
    robot.say(0.1)
    assert not robot.senses.ages()['odometry_note'] and robot.senses.pose is not None
