# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots of the mux with their sensors, for the tasks; managed on the worker's thread."""
import re
import threading

import numpy as np
import rospy

from mhri.base.names import NUMBERS
from mhri.graph.ros.master_api import MasterApi
from mhri.robots.found_streams import FoundStreams
from mhri.robots.ros.registry import RobotRegistry
from mhri.tasks.base import circles, NOWHERE, Other, Senses
from mhri.tasks.ros.robot_senses import RobotSenses

# Radius of the map around a robot within which it may have to stop [m].
FLOOR_M = 1.5


class SensedRobots:
    """A :class:`RobotSenses` for each robot of the mux.

    :param types: {name: RobotType}
    :param clock: seconds, monotonic
    :param frames: :class:`mhri.robots.ros.tf_feed.TfFeed`, None: without tf
    """

    def __init__(self, types, clock, frames=None):
        self._registry = RobotRegistry(
            types, lambda: FoundStreams(('odometry', 'scan', 'battery')))
        self._clock = clock
        self._frames = frames
        self._lock = threading.Lock()
        self._robots = {}
        self._numbers = {}
        # (robot, its pose in the frame of the map, its rank) of all placed robots, once computed.
        self._placed = None

    def sense_only(self, names):
        """Sense exactly these robots (blocking: calls the master).

        :raises MasterError: the master is unavailable
        """
        with self._lock:
            gone = [self._robots.pop(name) for name in set(self._robots) - set(names)]
        for robot in gone:
            robot.close()
            self._registry.forget(robot.name)
        self._look_at([name for name in names if name not in self.names()])

    def _look_at(self, names):
        """Sense robots, with new senses if their type has changed."""
        for name, robot_type in self._registry.look(names).items():
            before = self.get(name)
            if before is None or before.robot_type != robot_type:
                robot = RobotSenses(name, robot_type, self._clock, self._frames)
                with self._lock:
                    self._robots[name] = robot
                if before is not None:
                    before.close()
            if self._registry.no_odometry(name):
                self.get(name).odometry_note = self._registry.no_odometry(name)

    def open(self, names):
        """Open all sensors of these robots (blocking: calls the master).

        :raises MasterError: the master is unavailable
        """
        self._look_at(names)
        for name in names:
            self.get(name).open()
        api = MasterApi(rospy.get_name(), timeout_s=2.0)
        numbers = api.call_many([('getParam', NUMBERS)])[0]
        self._numbers = numbers if isinstance(numbers, dict) else {}

    def look(self):
        """Process the new messages of every robot."""
        self._placed = None
        for robot in self.all():
            robot.look()

    def all(self):
        """Return every :class:`RobotSenses`."""
        with self._lock:
            return list(self._robots.values())

    def names(self):
        """Return the names of the sensed robots."""
        with self._lock:
            return list(self._robots)

    def get(self, name):
        """Return the :class:`RobotSenses` of a robot, or None."""
        with self._lock:
            return self._robots.get(name)

    def senses(self, robot, now_s, busy, place_of, fence=(), floor=None):
        """Return the :class:`Senses` of a robot, None before its first odometry.

        :param robot: a :class:`RobotSenses`
        :param busy: names of the robots that are on a task
        :param place_of: function from a name to its :class:`mhri.map.places.Place`
        :param fence: corners (x, y) [m] in the frame of the map
        :param floor: the :class:`mhri.map.floor.Floor` of the map, None without one
        """
        odometry, place = robot.pose, place_of(robot.name)
        if odometry is None:
            return None
        placed = place.is_fresh
        pose = place.pose(odometry) if placed else odometry
        others = self._others(robot, busy, place_of) if placed else {}
        return Senses(now_s, pose, odometry, robot.captured(),
                      robot.points(circles(pose, others.values())), others,
                      np.array(fence if placed else ()).reshape(-1, 2),
                      floor.edge(pose, FLOOR_M) if floor and placed else NOWHERE)

    def _others(self, robot, busy, place_of):
        """Return the other placed robots."""
        if self._placed is None:
            self._placed = [(other, pose, self._rank(other.name)) for other, pose in (
                (other, _pose_of(other, place_of(other.name))) for other in self.all())
                            if pose is not None]
        rank = self._rank(robot.name)
        return {other.name: Other(pose, other.name in busy and number < rank, other.body.radius_m)
                for other, pose, number in self._placed if other is not robot}

    def _rank(self, name):
        """Return the rank for the right of way: the robot's number, else that in its name."""
        number = self._numbers.get(name)
        digits = re.search(r'(\d{1,9})\Z', name)
        named = int(digits.group(1)) if digits else 10 ** 9
        return (number if isinstance(number, int) else named, name)


def _pose_of(robot, place):
    """Return the :class:`Pose` of a robot in the frame of the map, None if unknown."""
    return place.pose(robot.pose) if place.is_fresh else None
