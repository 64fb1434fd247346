# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which robots a session keeps, and what is published: asked of the master now and then."""
import rospy

from mhri.base.names import name_problem
from mhri.base.robot_types import resolve_robot_type, Seen
from mhri.graph.ros.master_api import MasterApi
from mhri.robots.ros.look import look_for_robots, robot_facts, shipped_ignore_list
from mhri.session.topics import robot_entry

ROBOTS, NUMBERS = '/mhri/robots', '/mhri/robot_numbers'
# Those that were ever driven: a program of a lab's own drives robots that no screen lists.
DRIVEN = '/mhri_gates/robots'


class GraphRobots:
    """The robots of a screen's list and those that were driven; without a list all there are.

    :param types: {name: RobotType}
    ``kinds`` is {name: RobotType}, ``entries`` {name: what ``session.yaml`` says of it},
    ``published`` a set of topics.
    """

    def __init__(self, types):
        self._types = types
        self._seen = {}
        self.kinds = {}
        self.entries = {}
        self.published = frozenset()

    def look(self):
        """Ask the master (blocking); return the names of the robots that are new.

        :raises MasterError: it cannot be asked now; everything stays
        """
        api = MasterApi(rospy.get_name(), timeout_s=2.0)
        listed, numbers, driven, published = api.call_many([
            ('getParam', ROBOTS), ('getParam', NUMBERS), ('getParam', DRIVEN),
            ('getPublishedTopics', '')])
        self.published = frozenset(topic for topic, _ in published or ())
        names = _names(listed) + _names(driven)
        if listed is None:
            found = look_for_robots(rospy.get_name(), shipped_ignore_list(), types=self._types)
            names += [item.name for item in found.live if item.problem is None]
        names = list(dict.fromkeys(names))
        facts = robot_facts(rospy.get_name(), names, self._types,
                            {name: self._seen[name] for name in names if name in self._seen})
        new = [name for name in names if name not in self.kinds]
        numbers = numbers if isinstance(numbers, dict) else {}
        kinds, entries = {}, {}
        for name in names:
            if facts[name].seen is not None:
                self._seen[name] = facts[name].seen
            kinds[name], _ = resolve_robot_type(self._types, name, facts[name].parameters,
                                                self._seen.get(name, Seen()))
            entries[name] = robot_entry(name, numbers.get(name, 0), kinds[name],
                                        facts[name].parameters, self.published)
        self.kinds, self.entries = kinds, entries
        return new


def _names(value):
    return [name for name in value if isinstance(name, str) and name_problem(name) is None] \
        if isinstance(value, list) else []
