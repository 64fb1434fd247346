# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots in bags of other programs."""
from pathlib import Path

import pytest

from mhri.base.robot_types import load_robot_types
from mhri.recording.folder import NotASession
from mhri.session.foreign import may_be_replayed, name_of_file, robots_of_topics

FOLDER = Path(__file__).resolve().parents[3] / 'resource' / 'robots'
TYPES, _ = load_robot_types((path.name, path.read_text()) for path in sorted(FOLDER.glob('*.yaml')))
ODOMETRY, SCAN, IMU = 'nav_msgs/Odometry', 'sensor_msgs/LaserScan', 'sensor_msgs/Imu'
PICTURE = 'sensor_msgs/CompressedImage'


@pytest.mark.parametrize('topics, robots, prefix', [
    ({'/bot1/odom': ODOMETRY, '/bot2/odom': ODOMETRY, '/bot10/odom': ODOMETRY},
     {'bot1': 1, 'bot2': 2, 'bot10': 3}, ''),
    ({'/odom': ODOMETRY, '/scan': SCAN, '/camera/rgb/image_raw/compressed': PICTURE},
     {'run_3': 1}, '/run_3'),
    ({'/odom': ODOMETRY, '/tf': 'tf2_msgs/TFMessage'}, {'run_3': 1}, '/run_3'),
    ({'/turtle1/pose': 'turtlesim/Pose'}, {'run_3': 1}, '/run_3'),
    ({'/spot/imu': IMU, '/spot/scan': SCAN}, {'spot': 1}, ''),
])
def test_robots_are_known_by_their_topics(topics, robots, prefix):
    found, before = robots_of_topics(topics, TYPES, 'run 3')
    assert {name: robot['number'] for name, robot in found.items()} == robots
    assert before == prefix


def test_a_type_is_known_by_what_only_it_has():
    topics = {'/a/odom': ODOMETRY, '/a/mobile_base/sensors/imu_data': IMU,
              '/b/odom': ODOMETRY, '/b/sensor_state': 'turtlebot3_msgs/SensorState'}
    found, _ = robots_of_topics(topics, TYPES, 'x')
    assert [robot['type'] for robot in found.values()] == ['turtlebot2', 'turtlebot3']


@pytest.mark.parametrize('topics', [
    {}, {'/chatter': 'std_msgs/String'}, {'/bot1/odom': 'std_msgs/String'},
    {'/cmd_vel': 'geometry_msgs/Twist'}])
def test_a_bag_without_a_robot_is_refused_in_words(topics):
    with pytest.raises(NotASession, match='a robot needs'):
        robots_of_topics(topics, TYPES, 'x')


@pytest.mark.parametrize('stem, name', [
    ('run 3', 'run_3'), ('2026-01-02', 'robot_2026_01_02'), ('', 'robot'), ('mux', 'robot_mux')])
def test_a_file_names_its_robot(stem, name):
    assert name_of_file(stem) == name


@pytest.mark.parametrize('topic, kind, may', [
    ('/bot1/odom', ODOMETRY, True), ('/mux/state', 'mhri/DriveState', True),
    ('/bot1/cmd_vel', 'geometry_msgs/Twist', False),
    ('/bot1/mhri_guard/command', 'geometry_msgs/TwistStamped', False),
    ('/team', 'mhri/TeamTwist', False),
    ('/mux_in/joy', 'sensor_msgs/Joy', False), ('/clock', 'rosgraph_msgs/Clock', False),
    ('/bot1/move_base/goal', 'move_base_msgs/MoveBaseActionGoal', False)])
def test_nothing_that_asks_for_anything_is_replayed(topic, kind, may):
    assert may_be_replayed(topic, kind) is may
