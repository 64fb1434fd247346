# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A node for the map alone: robots that go round in circles in a room, and who says where they are.

It stands in for robots (odometry 30 Hz, scans 10 Hz, ``/map``) and for what mhri_tasks says of the
map (``/mhri_tasks/places`` at 10 Hz, and its services, which do what they are asked).
Words: the names of the robots; those after ``--`` are not placed.
"""
import math
import sys

from geometry_msgs.msg import Point32, Pose2D
from nav_msgs.msg import OccupancyGrid, Odometry
import numpy as np
import rospy
from sensor_msgs.msg import LaserScan

from mhri.msg import Mark, Place, Places, TaskList
from mhri.srv import FitPlace, SetFence, SetMark, SetPlace

WIDTH_M, HEIGHT_M, CELL_M, BEAMS = 16.0, 12.0, 0.05, 360
NOWHERE = Pose2D(math.nan, math.nan, math.nan)


def room():
    """Return the ``nav_msgs/OccupancyGrid`` of an empty room with its origin in the middle."""
    cells = np.zeros((round(HEIGHT_M / CELL_M), round(WIDTH_M / CELL_M)), np.int8)
    for edge in (cells[:3], cells[-3:], cells[:, :3], cells[:, -3:]):
        edge[:] = 100
    message = OccupancyGrid(data=cells.ravel().tolist())
    message.header.frame_id = 'map'
    message.info.resolution = CELL_M
    message.info.height, message.info.width = cells.shape
    message.info.origin.position.x, message.info.origin.position.y = -WIDTH_M / 2, -HEIGHT_M / 2
    message.info.origin.orientation.w = 1.0
    return message


def walls(x_m, y_m, heading):
    """Return what a laser there measures of the room [m]."""
    angles = heading + np.linspace(-math.pi, math.pi, BEAMS, endpoint=False)
    with np.errstate(divide='ignore'):
        across = (np.sign(np.cos(angles)) * WIDTH_M / 2 - x_m) / np.cos(angles)
        along = (np.sign(np.sin(angles)) * HEIGHT_M / 2 - y_m) / np.sin(angles)
    return np.minimum(across, along)


class Robot:
    """One robot: a circle around the origin of its own odometry."""

    def __init__(self, name, number, placed):
        self.name = name
        self.origin = Pose2D(-5.0 + 2.5 * (number % 5), -3.0 + 2.5 * (number // 5), 0.4 * number) \
            if placed else NOWHERE
        self._odometry = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        self._scan = rospy.Publisher('/{}/scan'.format(name), LaserScan, queue_size=1)

    def publish(self, now, tick):
        """Say where it is, and with each third tick what it sees."""
        turn = 0.3 * now.to_sec() % (2.0 * math.pi)
        message = Odometry()
        message.header.stamp = now
        message.pose.pose.position.x = math.cos(turn)
        message.pose.pose.position.y = math.sin(turn)
        heading = turn + math.pi / 2.0
        message.pose.pose.orientation.z = math.sin(heading / 2.0)
        message.pose.pose.orientation.w = math.cos(heading / 2.0)
        message.twist.twist.linear.x, message.twist.twist.angular.z = 0.3, 0.3
        self._odometry.publish(message)
        if tick % 3 == 0 and math.isfinite(self.origin.x):
            cos, sin = math.cos(self.origin.theta), math.sin(self.origin.theta)
            ranges = walls(self.origin.x + math.cos(turn) * cos - math.sin(turn) * sin,
                           self.origin.y + math.cos(turn) * sin + math.sin(turn) * cos,
                           self.origin.theta + heading)
            scan = LaserScan(angle_min=-math.pi, angle_max=math.pi, range_max=30.0,
                             angle_increment=2.0 * math.pi / BEAMS, ranges=ranges.tolist())
            scan.header.stamp = now
            self._scan.publish(scan)


class World:
    """All of them, and what is said of them."""

    def __init__(self, names, loose):
        self._robots = {name: Robot(name, number, name not in loose)
                        for number, name in enumerate((*names, *loose))}
        self._marks, self._fence = {}, []
        self._map = rospy.Publisher('/map', OccupancyGrid, queue_size=1, latch=True)
        self._map.publish(room())
        self._places = rospy.Publisher('/mhri_tasks/places', Places, queue_size=1, latch=True)
        self._list = rospy.Publisher('/mhri_tasks/list', TaskList, queue_size=1, latch=True)
        self._list.publish(TaskList())
        rows = (
            ('set_place', SetPlace, self._set_place), ('set_mark', SetMark, self._set_mark),
            ('set_fence', SetFence, self._set_fence),
            ('fit_place', FitPlace, lambda request: (False, 'there is no laser')))
        self._services = [rospy.Service('/mhri_tasks/' + name, kind, serve)
                          for name, kind, serve in rows]

    def _set_place(self, request):
        robot = self._robots.get(request.robot)
        if robot is None:
            return False, 'no such robot'
        robot.origin = request.pose if request.placed else NOWHERE
        return True, 'placed' if request.placed else 'taken off'

    def _set_mark(self, request):
        self._marks.pop(request.name, None)
        if request.there:
            self._marks[request.name] = request.pose
        return True, 'marked'

    def _set_fence(self, request):
        self._fence = [Point32(corner.x, corner.y, 0.0) for corner in request.corners]
        return True, 'drawn'

    def run(self):
        """Speak until the end."""
        rate, tick = rospy.Rate(30.0), 0
        while not rospy.is_shutdown():
            now = rospy.Time.now()
            for robot in self._robots.values():
                robot.publish(now, tick)
            if tick % 3 == 0:
                message = Places(
                    robots=[Place(robot.name, Place.HAND, 'placed by hand' if math.isfinite(
                        robot.origin.x) else 'not placed: place it by hand on the map', math.nan,
                        robot.origin) for robot in self._robots.values()],
                    marks=[Mark(*row) for row in self._marks.items()], fence=self._fence)
                message.header.frame_id = 'map'
                self._places.publish(message)
            tick += 1
            try:
                rate.sleep()
            except rospy.ROSInterruptException:
                return


if __name__ == '__main__':
    rospy.init_node('mhri_tasks')
    words = sys.argv[1:]
    split = words.index('--') if '--' in words else len(words)
    World(words[:split], words[split + 1:]).run()
