# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot with a laser ahead and one behind, as stage_ros publishes it: all mounts on /tf alone,
and odometry without ``child_frame_id``."""
import math
import threading

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
import rospy
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

BEAMS = 360
STEP_RAD = 2.0 * math.pi / BEAMS


def edge(parent, child, turn_rad=0.0):
    """Return a transform without a way, turned to the left."""
    made = TransformStamped(child_frame_id=child)
    made.header.frame_id = parent
    made.transform.rotation.z, made.transform.rotation.w = (
        math.sin(0.5 * turn_rad), math.cos(0.5 * turn_rad))
    return made


class TwoLasers:
    """Publishes ``/<name>/front_scan``, ``rear_scan`` and ``stage_odom``, 20 times a second.

    :param around: called for (``LaserScan`` with 360 ranges, counted to the left from straight
        ahead, ``Odometry``): what it measures and where it is; stamped now where they are not
    """

    #: of the robot's type: for its parameter ``/<name>/mhri``
    TYPE = {'scan': ['front_scan', 'rear_scan'], 'odometry': ['stage_odom']}

    def __init__(self, name, around):
        self._name = name
        self._around = around
        self._scans = [rospy.Publisher('/{}/{}'.format(name, topic), LaserScan, queue_size=1)
                       for topic in self.TYPE['scan']]
        self._odometry = rospy.Publisher('/{}/stage_odom'.format(name), Odometry, queue_size=1)
        self._tf = rospy.Publisher('/tf', TFMessage, queue_size=5)
        self._edges = [edge(name + '/odom', name + '/base'),
                       edge(name + '/base', name + '/front_laser'),
                       edge(name + '/base', name + '/rear_laser', math.pi)]
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._done.wait(0.05):
            measured, there = self._around()
            now = rospy.Time.now()
            for each in self._edges:
                each.header.stamp = now
            self._tf.publish(self._edges)
            odometry = Odometry(pose=there.pose, twist=there.twist)
            odometry.header.frame_id = self._name + '/odom'
            odometry.header.stamp = there.header.stamp or now
            self._odometry.publish(odometry)
            for publisher, side, first in zip(self._scans, ('front', 'rear'), (-90, 90)):
                scan = LaserScan(angle_min=-0.5 * math.pi, angle_max=0.5 * math.pi,
                                 angle_increment=STEP_RAD, range_min=measured.range_min,
                                 range_max=measured.range_max)
                scan.header.frame_id = '{}/{}_laser'.format(self._name, side)
                scan.header.stamp = measured.header.stamp or now
                scan.ranges = [measured.ranges[(first + beam) % BEAMS]
                               for beam in range(BEAMS // 2 + 1)]
                publisher.publish(scan)

    def let_go(self):
        """Say nothing any more."""
        self._done.set()
        self._thread.join()
        for publisher in self._scans + [self._odometry, self._tf]:
            publisher.unregister()
