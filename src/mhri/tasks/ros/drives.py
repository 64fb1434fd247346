# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads drives from bags: the poses of a robot, by its odometry or by motion capture."""
import os

import rospkg

from mhri.base.geometry import Pose
from mhri.recording.folder import NotASession
from mhri.recording.ros.bag_set import BagSet
from mhri.robots.ros.convert import yaw_of
from mhri.robots.ros.odometry import MOTIONS
from mhri.tasks.replay import MAX_PLACES, thinned

POSE = 'geometry_msgs/PoseStamped'
READABLE = tuple(MOTIONS) + (POSE,)
# Maximum number of messages to read: an hour at 50 Hz.
MAX_MESSAGES = 200000


class DriveError(Exception):
    """An unreadable drive; the text names the reason and the remedy."""


def read_drive(path, topics):
    """Return the poses of a drive in order (blocking: reads the file).

    :param path: path of a bag, relative to ``$ROS_HOME``
    :param topics: candidate topics; the first one in the bag is read
    :raises DriveError: there is no drive
    """
    path = os.path.join(rospkg.get_ros_home(), os.path.expanduser(path))
    try:
        bags = BagSet([path])
    except NotASession as error:
        raise DriveError('{}: {}'.format(path, error))
    try:
        return _read(bags, path, topics)
    except DriveError:
        raise
    except Exception as error:  # rosbag may raise anything for a damaged file
        raise DriveError('{}: cannot be read: {}'.format(
            path, getattr(error, 'strerror', None) or error))
    finally:
        bags.close()


def _read(bags, path, topics):
    found = {connection.topic: connection.kind for connection in bags.connections()
             if connection.kind in READABLE}
    topic = next((topic for topic in topics if topic in found), None)
    if topic is None:
        raise DriveError('; '.join(['{}: it has no {}; topic could be: {}'.format(
            path, ' or '.join(topics) or 'odometry', ', '.join(sorted(found)) or 'none of it')]
            + bags.problems))
    read = _pose_of(found[topic])
    poses = []
    wanted = bags.after(bags.start_ns - 1, lambda one: (one.topic, one.kind) == (
        topic, found[topic]))
    for number, recorded in enumerate(wanted):
        pose = read(recorded.message())
        if pose is not None:
            poses.append(pose)
        if number >= MAX_MESSAGES:
            raise DriveError('{}: longer than {} messages: cut it with rosbag filter'.format(
                path, MAX_MESSAGES))
    poses = thinned(poses)
    if len(poses) > MAX_PLACES:
        raise DriveError('{}: the drive is too long, cut it with rosbag filter'.format(path))
    return poses


def _pose_of(kind):
    """Return a function from a message of a type to its :class:`Pose`, or None."""
    if kind == POSE:
        def read(message):
            """Return the pose of a geometry_msgs/PoseStamped."""
            place = message.pose.position
            pose = Pose(place.x, place.y, yaw_of(message.pose.orientation))
            return pose if pose.is_finite() else None
        return read

    def read_odometry(message):
        """Return the pose of an odometry message."""
        motion = MOTIONS[kind](message)
        return motion and motion.pose
    return read_odometry
