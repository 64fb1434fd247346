# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots that the gates know, as the tasks see them: made and opened on the worker's thread."""
import re
import threading

import numpy as np
import rospy

from mhri.base.robot_types import resolve_robot_type
from mhri.graph.ros.master_api import MasterApi
from mhri.robots.ros.look import robot_facts
from mhri.tasks.base import circles, NOWHERE, Other, Senses
from mhri.tasks.ros.robot_senses import RobotSenses

# Of the map no more is looked at than what a robot may have to stand before [m].
FLOOR_M = 1.5
NUMBERS_PARAMETER = '/mhri/robot_numbers'


class SeenRobots:
    """A :class:`RobotSenses` for each robot that the gates know.

    :param types: {name: RobotType}
    :param clock: seconds, monotonic
    :param frames: :class:`mhri.robots.ros.tf_feed.TfFeed`, None: without tf
    """

    def __init__(self, types, clock, frames=None):
        self._types = types
        self._clock = clock
        self._frames = frames
        self._lock = threading.Lock()
        self._robots = {}
        self._numbers = {}
        # (robot, its pose in the frame of the map, its rank) of all that are placed, after a look.
        self._placed = None

    def know(self, names):
        """See exactly these robots (blocking: it asks the master).

        :raises MasterError: the master cannot be asked now
        """
        with self._lock:
            new = [name for name in names if name not in self._robots]
            gone = [self._robots.pop(name) for name in set(self._robots) - set(names)]
        for robot in gone:
            robot.close()
        for name, robot_type in self._types_of(new).items():
            robot = RobotSenses(name, robot_type, self._clock, self._frames)
            with self._lock:
                self._robots[name] = robot

    def _types_of(self, names):
        facts = robot_facts(rospy.get_name(), names, self._types) if names else {}
        return {name: resolve_robot_type(self._types, name, facts[name].parameters,
                                         *([facts[name].seen] if facts[name].seen else []))[0]
                for name in names}

    def open(self, names):
        """Have these robots sense all they can (blocking: it asks the master).

        :raises MasterError: the master cannot be asked now
        """
        for name, robot_type in self._types_of(names).items():
            robot = self.get(name)
            if robot is None or robot.robot_type != robot_type:
                self.know([other for other in self.names() if other != name])
                self.know(self.names() + [name])
                robot = self.get(name)
            robot.open()
        api = MasterApi(rospy.get_name(), timeout_s=2.0)
        numbers = api.call_many([('getParam', NUMBERS_PARAMETER)])[0]
        self._numbers = numbers if isinstance(numbers, dict) else {}

    def look(self):
        """Read what has come of every robot."""
        self._placed = None
        for robot in self.all():
            robot.look()

    def all(self):
        """Return every :class:`RobotSenses`."""
        with self._lock:
            return list(self._robots.values())

    def names(self):
        """Return the robots that are seen."""
        with self._lock:
            return list(self._robots)

    def get(self, name):
        """Return the :class:`RobotSenses` of a robot, None where it is not seen."""
        with self._lock:
            return self._robots.get(name)

    def senses(self, robot, now_s, busy, place_of, fence=(), floor=None):
        """Return the :class:`Senses` of a robot, None before it is heard.

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
        """Return the other robots that are placed."""
        if self._placed is None:
            self._placed = [(other, pose, self._rank(other.name)) for other, pose in (
                (other, _pose_of(other, place_of(other.name))) for other in self.all())
                            if pose is not None]
        rank = self._rank(robot.name)
        return {other.name: Other(pose, other.name in busy and number < rank, other.body.radius_m)
                for other, pose, number in self._placed if other is not robot}

    def _rank(self, name):
        """Return what says who goes first: the robot's number, else that in its name."""
        number = self._numbers.get(name)
        digits = re.search(r'(\d{1,9})\Z', name)
        named = int(digits.group(1)) if digits else 10 ** 9
        return (number if isinstance(number, int) else named, name)


def _pose_of(robot, place):
    """Return the :class:`Pose` of a robot in the frame of the map, None where it is not known."""
    return place.pose(robot.pose) if place.is_fresh else None
