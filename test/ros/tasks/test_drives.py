# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drives read from bags."""
import random

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
import pytest
import rosbag
import rospy
from std_msgs.msg import String

from mhri.tasks.ros.drives import DriveError, read_drive


@pytest.fixture
def bag(tmp_path):
    """Return a function that writes a bag, ten poses on each topic; it returns its path."""
    def write(**topics):
        path = str(tmp_path / 'drive.bag')
        with rosbag.Bag(path, 'w') as out:
            for number in range(10):
                for topic, kind in topics.items():
                    out.write('/bot1/' + topic, message(kind, number), rospy.Time(1 + number))
        return path
    return write


def message(kind, number):
    made = kind()
    if kind is not String:
        pose = made.pose.pose if kind is Odometry else made.pose
        pose.position.x, pose.orientation.w = 0.1 * number, 1.0
    return made


def test_the_first_topic_that_is_there_is_read(bag):
    path = bag(odom=Odometry, mocap=PoseStamped)
    drive = read_drive(path, ['/bot1/odometry', '/bot1/odom'])
    assert [pose.x_m for pose in drive] == pytest.approx([0.1 * number for number in range(10)])
    assert read_drive(path, ['/bot1/mocap']) == drive


@pytest.mark.parametrize('topics, words', [
    (['/odom'], 'it has no /odom; topic could be: /bot1/odom'),
    (['/bot1/words'], 'it has no /bot1/words; topic could be: /bot1/odom')])
def test_a_topic_that_is_not_there_is_named(bag, topics, words):
    with pytest.raises(DriveError, match=words):
        read_drive(bag(odom=Odometry, words=String), topics)


@pytest.mark.parametrize('data, words', [
    (None, 'cannot be read: No such file'), (b'', 'cannot be read'),
    (b'#ROSBAG V2.0\n', 'cannot be read|no bag'), (b'no bag at all\n', 'cannot be read')])
def test_a_file_that_is_no_bag_is_said(tmp_path, data, words):
    path = tmp_path / 'x.bag'
    if data is not None:
        path.write_bytes(data)
    with pytest.raises(DriveError, match=words):
        read_drive(str(path), ['/bot1/odom'])


def test_a_bag_that_was_not_closed_is_read(bag):
    path = bag(odom=Odometry)
    with open(path, 'r+b') as stream:
        data = stream.read()
        at = data.index(b'index_pos=') + len(b'index_pos=')
        stream.seek(at)
        stream.write(bytes(8))
    assert len(read_drive(path, ['/bot1/odom'])) == 10


@pytest.mark.parametrize('seed', range(10))
def test_a_damaged_bag_is_refused_with_its_name_or_read(bag, seed):
    path, dice = bag(odom=Odometry), random.Random(seed)
    data = bytearray(open(path, 'rb').read())
    for _ in range(dice.choice((1, 20, 200))):
        data[dice.randrange(len(data))] = dice.randrange(256)
    with open(path, 'wb') as out:
        out.write(data)
    try:
        assert all(pose.is_finite() for pose in read_drive(path, ['/bot1/odom']))
    except DriveError as error:
        assert path in str(error)
