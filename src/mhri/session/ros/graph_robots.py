# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots of a session and the published topics, polled from the master."""
import rospy

from mhri.base.names import DRIVEN, names_in, NUMBERS, ROBOTS
from mhri.graph.ros.master_api import MasterApi
from mhri.robots.ros.graph_scan import look_for_robots, shipped_ignore_list
from mhri.robots.ros.registry import RobotRegistry
from mhri.session.topics import robot_entry


class GraphRobots:
    """The robots listed by a screen and those driven; without a list, all robots on the graph.

    Driven robots are included because a lab's program may drive robots that no screen lists.

    :param types: {name: RobotType}
    ``kinds`` is {name: RobotType}, ``entries`` {name: its entry of ``session.yaml``},
    ``published`` the set of published topics.
    """

    def __init__(self, types):
        self._types = types
        self._registry = RobotRegistry(types)
        self.kinds = {}
        self.entries = {}
        self.published = frozenset()

    def scan(self):
        """Poll the master (blocking); return the names of new robots.

        :raises MasterError: the master does not answer; nothing is changed
        """
        api = MasterApi(rospy.get_name(), timeout_s=2.0)
        listed, numbers, driven, published = api.call_many([
            ('getParam', ROBOTS), ('getParam', NUMBERS), ('getParam', DRIVEN),
            ('getPublishedTopics', '')])
        self.published = frozenset(topic for topic, _ in published or ())
        names = names_in(listed) + names_in(driven)
        if listed is None:
            found = look_for_robots(rospy.get_name(), shipped_ignore_list(), types=self._types)
            names += [item.name for item in found.live if item.problem is None]
        kinds = self._registry.look(dict.fromkeys(names), self._registry.seen())
        new = [name for name in kinds if name not in self.kinds]
        numbers = numbers if isinstance(numbers, dict) else {}
        self.entries = {name: robot_entry(
            name, numbers.get(name, 0), kind, self._registry.parameters[name], self.published)
                        for name, kind in kinds.items()}
        self.kinds = kinds
        return new
