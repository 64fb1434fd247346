# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The registry of robots and their types, from the graph."""
import rospy

from mhri.base.config import ConfigError
from mhri.base.robot_types import resolve_robot_type, Seen
from mhri.robots.found_streams import choice_words, found_words, FoundStreams
from mhri.robots.ros.graph_scan import robot_facts


class RobotRegistry:
    """The types of robots, from their parameters and the graph.

    A vanished topic or parameter never changes the type of a robot, which may be moving;
    ``robot_type`` or new topics do. Its sensors may have other names than in its type
    (:class:`mhri.robots.found_streams.FoundStreams`). Not thread-safe except for :meth:`problem`
    and :meth:`no_odometry`.

    :param types: {name: RobotType}
    :param finder: returns the :class:`FoundStreams` of a new robot
    """

    def __init__(self, types, finder=FoundStreams):
        self._types, self._finder = types, finder
        self._seen = {}
        self._kinds = {}
        self._found = {}
        self._problems = {}
        self._no_odometry = {}
        self._said = set()
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
            name: self._seen.get(name, Seen()) for name in known},
            [name for name in names if not self.is_complete(name)])
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
        if news or named or name not in self._kinds:
            self._kinds[name] = kind
        found = self._found.setdefault(name, self._finder())
        # Its type may be about to come, with names of its own.
        kind = found.update(self._kinds[name], None if self.presumed(name) else facts.published,
                            facts.parameters)
        choices = {key: '; to use one: '.join(choice_words(name, key, topics))
                   for key, topics in found.choices.items()}
        self._no_odometry[name] = choices.get('odometry', '')
        self._log(name, kind, [str(error) for error in errors + [
            ConfigError('/' + name, key + ' not found', words) for key, words in choices.items()]])
        return kind

    def _log(self, name, kind, problems):
        for key in kind.found:
            words = '; to set it: '.join(found_words(name, key, kind))
            if words not in self._said:
                self._said.add(words)
                rospy.loginfo('%s', words)
        if problems != self._problems.get(name, []):
            for text in problems:
                rospy.logwarn('%s', text)
        self._problems[name] = problems

    def is_complete(self, name):
        """Return whether nothing about a robot's sensors can be news, so that it is not asked."""
        return name in self._found and self._found[name].complete

    def no_odometry(self, name):
        """Return what there is in place of the odometry of a robot's type, '' for nothing."""
        return self._no_odometry.get(name, '')

    def presumed(self, name):
        """Return whether nothing is known of a robot but its name, so that its type is a guess."""
        return not (self.parameters.get(name) or self._seen.get(name, Seen()).anything())

    def problem(self, name):
        """Return the problem with a robot's parameters or sensors in words, '' for none."""
        return ''.join(self._problems.get(name, [])[:1]).partition(': ')[2]

    def forget(self, name):
        """Forget the type of a robot and its facts."""
        self._seen.pop(name, None)
        self._kinds.pop(name, None)
        self._found.pop(name, None)
