# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where laser and depth camera sit: tf, else the type; and scans of a laser that is turned over."""
from dataclasses import replace
import math
from types import SimpleNamespace

from nav_msgs.msg import Odometry
import numpy as np
import pytest
from sensor_msgs.msg import LaserScan

from mhri.base.geometry import Pose
from mhri.base.tf_tree import OdometryFrames, TfTree
from mhri.graph.ros.resources import robot_types
from mhri.sensors.ros.beams import read_beams
from mhri.sensors.ros.mounts import Mounts, NoPlace

KIND = replace(robot_types()[0]['turtlebot3'], laser_x_m=-0.05, depth_x_m=0.1, depth_z_m=0.2)
LEVEL, OVER, TILTED = (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.5, 0.0, math.sqrt(0.75))


def mounts(*edges, base='bot1/base_footprint', kind=KIND, odometry=''):
    """Return the mounts of a robot whose tf says (parent, child, x, quaternion)."""
    tree = TfTree()
    for parent, child, x, turn in edges:
        tree.add(parent, child, (x, 0.0, 0.0) + turn, None)

    def matrix(frame, other):
        found = tree.matrix(frame, other)
        return found and found[0]
    made = Mounts(kind, SimpleNamespace(matrix=matrix, child_above=tree.child_above))
    message = Odometry(child_frame_id=base)
    message.header.frame_id = odometry
    made.frames = OdometryFrames.of(message)
    return made


CHAIN = (('bot1/base_footprint', 'bot1/base_link', 0.01, LEVEL),)


@pytest.mark.parametrize('edges, base, pose, over', [
    ((), 'bot1/base_footprint', Pose(-0.05, 0.0, 0.0), False),
    (CHAIN + (('bot1/base_link', 'scan', -0.064, LEVEL),), '/bot1/base_footprint',
     Pose(-0.054, 0.0, 0.0), False),
    (CHAIN + (('bot1/base_link', 'scan', 0.2, OVER),), 'bot1/base_footprint',
     Pose(0.21, 0.0, 0.0), True),
    (CHAIN + (('bot1/base_link', 'scan', 0.2, TILTED),), 'bot1/base_footprint',
     Pose(-0.05, 0.0, 0.0), False),
    (CHAIN + (('another', 'scan', 0.2, LEVEL),), 'bot1/base_footprint', Pose(-0.05, 0.0, 0.0),
     False),
    (CHAIN + (('bot1/base_link', 'scan', 0.2, LEVEL),), '', Pose(-0.05, 0.0, 0.0), False)])
def test_where_a_laser_sits(edges, base, pose, over):
    found, turned_over = mounts(*edges, base=base).laser('/scan')
    assert (found.x_m, found.y_m, found.heading_rad) == pytest.approx(
        (pose.x_m, pose.y_m, pose.heading_rad))
    assert turned_over == over


# As stage_ros says it: all on /tf, and no child_frame_id.
STAGE = (('robot_0/odom', 'robot_0/base_footprint', 7.0, LEVEL),
         ('robot_0/base_footprint', 'robot_0/base_link', 0.01, LEVEL),
         ('robot_0/base_link', 'robot_0/base_laser_link_1', -0.2, (0.0, 0.0, 1.0, 0.0)))


@pytest.mark.parametrize('base', ['', 'base_footprint'])
def test_a_base_that_odometry_does_not_name_is_the_child_of_its_frame(base):
    found, _ = mounts(*STAGE, base=base, odometry='/robot_0/odom').laser(
        'robot_0/base_laser_link_1')
    assert (found.x_m, abs(found.heading_rad)) == pytest.approx((-0.19, math.pi))


@pytest.mark.parametrize('edges', [(), STAGE])
def test_of_several_lasers_none_looks_ahead_because_nobody_knows_better(edges):
    twins = replace(KIND, scan=('scan', 'rear_scan'))
    for number in (0, 1):
        with pytest.raises(NoPlace):
            mounts(*edges, kind=twins).laser('robot_0/base_laser_link_1', number)


def test_the_type_says_where_each_of_several_lasers_sits():
    twins = replace(KIND, scan=('scan', 'rear_scan'),
                    lasers=((0.2, 0.0, 0.0), (-0.2, 0.1, math.pi)))
    assert [mounts(kind=twins).laser('', number)[0] for number in (0, 1)] == [
        Pose(0.2, 0.0, 0.0), Pose(-0.2, 0.1, math.pi)]


def test_where_a_camera_sits():
    matrix, height_known = mounts().camera('eye')
    assert height_known and matrix[:3, 3].tolist() == [0.1, 0.0, 0.2]
    assert (matrix[:3, :3] @ (0.0, 0.0, 1.0)).tolist() == [1.0, 0.0, 0.0]
    assert not mounts(kind=replace(KIND, depth_z_m=0.0)).camera('eye')[1]
    matrix, height_known = mounts(('bot1/base_footprint', 'eye', 0.3, LEVEL)).camera('eye')
    assert height_known and matrix[0, 3] == pytest.approx(0.3)


@pytest.mark.parametrize('turn, left', [(LEVEL, 1.0), (OVER, -1.0)])
def test_a_laser_that_is_turned_over_counts_to_the_right(turn, left):
    scan = LaserScan(angle_min=0.0, angle_increment=math.pi / 2, range_max=5.0,
                     ranges=[float('inf'), 1.0, float('inf'), float('inf')])
    scan.header.frame_id = 'scan'
    points = read_beams(scan, mounts(('bot1/base_footprint', 'scan', 0.2, turn))).points()
    assert np.allclose(points, [[0.2, left]])


def test_without_tf_a_scan_is_taken_where_the_type_says():
    scan = LaserScan(angle_increment=0.1, range_max=5.0, ranges=[1.0])
    assert read_beams(scan, Mounts(KIND)).points()[0] == pytest.approx((0.95, 0.0))
    assert read_beams(scan).points()[0] == pytest.approx((1.0, 0.0))
