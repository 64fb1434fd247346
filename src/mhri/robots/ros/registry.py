# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The registry of robots and their types, from the graph."""
import rospy

from mhri.base.robot_types import resolve_robot_type, Seen
from mhri.robots.ros.graph_scan import robot_facts


class RobotRegistry:
    """The types of robots, from their parameters and the graph.

    A vanished topic or parameter never changes the type of a robot, which may be moving;
    ``robot_type`` or new topics do. Not thread-safe except for :meth:`problem`.

    :param types: {name: RobotType}
    """

    def __init__(self, types):
        self._types = types
        self._seen = {}
        self._kinds = {}
        self._problems = {}
        #: {name: parameters of the robot, nested}, as of the last query
        self.parameters = {}

    def seen(self):
        """Return the set of names of the robots found on the graph."""
        return set(self._seen)

    def look(self, names, known=()):
        """Return {name: :class:`RobotType`} of robots (blocking: it asks the master).

        :param known: robots whose topics are not queried again, see :func:`robot_facts`
        :raises MasterError: the master is unavailable; nothing changes
        """
        facts = robot_facts(rospy.get_name(), names, self._types, {
            name: self._seen.get(name, Seen()) for name in known})
        return {name: self.note(name, facts[name]) for name in names}

    def note(self, name, facts):
        """Handle the :class:`mhri.robots.ros.graph_scan.Facts` of a robot; return its RobotType.

        Problems of its parameters are logged once.
        """
        named = facts.parameters.get('robot_type')
        news = facts.seen is not None and facts.seen.anything()
        seen = facts.seen if news else self._seen.get(name, Seen())
        if news or facts.seen is not None and named == 'generic':
            self._seen[name] = seen
        elif facts.seen is None:
            self._seen.pop(name, None)
        self.parameters[name] = facts.parameters
        kind, errors = resolve_robot_type(self._types, name, facts.parameters, seen)
        problems = [str(error) for error in errors]
        if problems != self._problems.get(name, []):
            for text in problems:
                rospy.logwarn('%s', text)
        self._problems[name] = problems
        if news or named or name not in self._kinds:
            self._kinds[name] = kind
        return self._kinds[name]

    def presumed(self, name):
        """Return whether nothing is known of a robot but its name, so that its type is a guess."""
        return not (self.parameters.get(name) or self._seen.get(name, Seen()).anything())

    def problem(self, name):
        """Return the problem with the parameters of a robot in words, '' for none."""
        return ''.join(self._problems.get(name, [])[:1])

    def forget(self, name):
        """Forget the type of a robot and its facts."""
        self._seen.pop(name, None)
        self._kinds.pop(name, None)
