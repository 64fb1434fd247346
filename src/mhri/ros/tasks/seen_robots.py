# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots that the gates know, as the tasks see them: made and opened on the worker's thread."""
import re
import threading

import rospy

from mhri.core.robots.robot_types import resolve_robot_type
from mhri.core.tasks.base import circles, Other, Senses
from mhri.ros.graph.look import robot_facts
from mhri.ros.graph.master_api import MasterApi
from mhri.ros.sensors.mocap_feed import TOPIC as MOCAP_TOPIC
from mhri.ros.tasks.robot_senses import RobotSenses

NUMBERS_PARAMETER = '/mhri/robot_numbers'
# A place that is older is no place [s].
OLD_S = 0.5


class SeenRobots:
    """A :class:`RobotSenses` for each robot that the gates know.

    :param types: {name: RobotType}
    :param clock: seconds, monotonic
    """

    def __init__(self, types, clock):
        self._types = types
        self._clock = clock
        self._lock = threading.Lock()
        self._robots = {}
        self._numbers = {}

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
            robot = RobotSenses(name, robot_type, self._clock)
            with self._lock:
                self._robots[name] = robot

    def _types_of(self, names):
        facts = robot_facts(rospy.get_name(), names, self._types) if names else {}
        return {name: resolve_robot_type(self._types, name, facts[name].parameters,
                                         *([facts[name].seen] if facts[name].seen else []))[0]
                for name in names}

    def open(self, names):
        """Have these robots sense all they can, and motion capture every robot that it sees.

        Blocking: it asks the master.

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
        published = {topic for topic, _ in api.call('getSystemState')[0]}
        for name in self.names():
            robot = self.get(name)
            if robot is not None and MOCAP_TOPIC.format(name) in published:
                robot.track()
            elif robot is not None and name in names:
                # Only of who begins: whoever is on its way keeps to its frame, or is lost.
                robot.untrack()
        numbers = api.call_many([('getParam', NUMBERS_PARAMETER)])[0]
        self._numbers = numbers if isinstance(numbers, dict) else {}

    def look(self):
        """Read what has come of every robot."""
        for robot in self._all():
            robot.look()

    def _all(self):
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

    def senses(self, robot, now_s, busy):
        """Return the :class:`Senses` of a robot, None before it is heard.

        :param robot: a :class:`RobotSenses`
        :param busy: names of the robots that are on a task
        """
        captured = robot.captured()
        if robot.pose is None or (robot.tracked and captured is None):
            return None
        others = self._others(robot, busy) if captured else {}
        pose = captured or robot.pose
        return Senses(now_s, pose, robot.pose, captured,
                      robot.points(circles(pose, others.values())), others)

    def _others(self, robot, busy):
        """Return the others that share the frame of motion capture with a robot."""
        rank, others = self._rank(robot.name), {}
        for other in self._all():
            age_s, pose = other.ages()['place_age_s'], other.captured()
            if other is not robot and pose is not None and age_s is not None and age_s < OLD_S:
                others[other.name] = Other(pose, other.name in busy
                                           and self._rank(other.name) < rank,
                                           other.body.radius_m)
        return others

    def _rank(self, name):
        """Return what says who goes first: the robot's number, else that in its name."""
        number = self._numbers.get(name)
        digits = re.search(r'(\d{1,9})\Z', name)
        named = int(digits.group(1)) if digits else 10 ** 9
        return (number if isinstance(number, int) else named, name)
