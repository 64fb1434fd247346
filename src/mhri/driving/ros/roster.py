# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which robots the gates know, and their types: asked of the master, off the driving path."""
import math
import threading
import time

import rospy

from mhri.base.names import name_problem
from mhri.base.robot_types import resolve_robot_type, Seen
from mhri.driving.seat import MOST_ROBOTS
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.robots.ros.look import robot_facts

ROBOTS_PARAMETER = '/mhri/robots'
# Every robot ever checked, for the next gates: a robot that was driven needs their zero, even if it
# was unchecked meanwhile.
DRIVEN_PARAMETER = '/mhri_gates/robots'
PERIOD_S = 1.0
# How often a robot that is heard but does not listen is told again about its topics [s].
ANNOUNCE_S = 5.0
# How long to look again at a robot that publishes its own velocity [s].
AGAIN_S = 5.0


def _names(value):
    """Return the valid robot names in a parameter of any shape."""
    return [name for name in value if isinstance(name, str) and name_problem(name) is None] \
        if isinstance(value, list) else []


class Roster:
    """A thread that opens and closes gates as robots enter and leave the list.

    A robot is known while it is in the screen's list (parameter ``/mhri/robots``) or checked. Once
    checked it stays known, also to the next gates, until it has left the list.

    :param types: {name: RobotType}
    :param open_gate: called with (name, RobotType), on the thread; replaces what was open
    :param close_gate: called with a name, on the thread
    :param watched: returns {name: (topics, prefixes of topics)} of those whose other publishers are
        to be told
    :param on_publishers: called with a name and {(caller id, topic)}, on the thread
    :param insiders: returns {name: frozenset of the robot's own nodes that publish its velocity} of
        robots that are driven as generic
    :param unheard: returns a list of (topic, type) to which robots that are heard do not listen
    :param memory: :class:`mhri.graph.ros.stand_by.Memory` of the gates before
    """

    def __init__(self, types, open_gate, close_gate, unheard, memory, watched, on_publishers,
                 insiders):
        self._types = types
        self._open_gate = open_gate
        self._close_gate = close_gate
        self._unheard = unheard
        self._memory = memory
        self._watched = watched
        self._on_publishers = on_publishers
        self._insiders = insiders
        self._inside = {}
        self._announced_at = 0.0
        self._checked = frozenset()
        self._ever = {}
        self._recalled = False
        self._listed = frozenset()
        self._open = {}
        self._seen = {}
        self._problems = {}
        self._changed = threading.Event()

    def start(self):
        """Begin; returns at once."""
        # The first look is now: robots on a task, which nobody checks, wait for their zero, too.
        self._changed.set()
        threading.Thread(target=self._run, name='roster', daemon=True).start()
        return self

    def check(self, names):
        """Note the checked robots; returns at once."""
        self._checked = frozenset(names)
        if not self._checked <= set(self._open):
            self._changed.set()

    def look_now(self):
        """Look at once; returns at once."""
        self._changed.set()

    def _run(self):
        while not rospy.is_shutdown():
            self._changed.wait(PERIOD_S)
            self._changed.clear()
            try:
                self._look()
                self._announce(time.monotonic())
            except (MasterError, OSError) as error:
                rospy.logdebug('cannot look at the robots now: %s', error)
            except Exception as error:  # without this thread no robot would ever be added
                rospy.logerr_throttle(
                    10.0, 'could not look at the robots: {}'.format(repr(error)[:300]))

    def _look(self):
        """Open and close gates as needed.

        :raises MasterError: the master cannot be asked now; what is open stays
        """
        api = MasterApi(rospy.get_name(), timeout_s=2.0)
        listed, driven = map(_names, api.call_many([
            ('getParam', ROBOTS_PARAMETER), ('getParam', DRIVEN_PARAMETER)]))
        if not self._recalled:
            self._recalled = True
            # A master started anew knows nothing of those who were driven.
            self._ever.update(dict.fromkeys(driven + _names(self._memory.recall('robots'))))
        listed = frozenset(listed)
        gone, self._listed = self._listed - listed - self._checked, listed
        self._ever.update(dict.fromkeys(sorted(self._checked)))
        for name in gone:
            self._ever.pop(name, None)
        known = list(self._ever)[:MOST_ROBOTS]
        self._memory.keep('robots', known)
        if known != driven:
            # Before their gates open: never drive a robot that is not noted.
            api.call('setParam', DRIVEN_PARAMETER, known)
        wanted = list(dict.fromkeys(sorted(self._checked) + sorted(listed) + list(self._ever)))
        wanted = wanted[:MOST_ROBOTS]
        for name in set(self._open) - set(wanted):
            del self._open[name]
            self._seen.pop(name, None)
            self._close_gate(name)
        self._look_again(time.monotonic())
        seen = {name: self._seen[name] for name in wanted if name in self._seen}
        for name, facts in robot_facts(rospy.get_name(), wanted, self._types, seen).items():
            self._settle(name, facts)
        watched = self._watched()
        if watched:
            self._tell_publishers(api.call('getSystemState')[0], watched)

    def _look_again(self, now):
        """Look again at robots whose velocity topics have new publishers of their own.

        For a few seconds: a multiplexer may only come up.
        """
        for name, inside in self._insiders().items():
            known, at = self._inside.get(name, (frozenset(), -math.inf))
            if inside - known:
                at = now
            self._inside[name] = inside, at
            if now - at < AGAIN_S:
                self._seen.pop(name, None)

    def _tell_publishers(self, published, watched):
        """Tell who publishes the topics of robots, and those that begin like them."""
        for name, (topics, prefixes) in watched.items():
            self._on_publishers(name, {
                (node, topic) for topic, nodes in published
                if topic in topics or topic.startswith(prefixes) for node in nodes})

    def _announce(self, now):
        """Register again the topics that robots should listen to and do not.

        The master announces a new publisher only once: a robot that hung or was out of reach at
        that moment would never know.

        :raises MasterError: the master cannot be told now
        """
        if now - self._announced_at < ANNOUNCE_S:
            return
        self._announced_at = now
        own = rospy.get_node_uri()
        calls = [('registerPublisher', topic, kind, own) for topic, kind in self._unheard()]
        if calls:
            MasterApi(rospy.get_name(), timeout_s=2.0).call_many(calls)

    def _settle(self, name, facts):
        """Open the gate of a robot, or replace it if its type has changed."""
        news = facts.seen is not None and facts.seen.anything()
        seen = facts.seen if news else self._seen.get(name, Seen())
        robot_type, errors = resolve_robot_type(self._types, name, facts.parameters, seen)
        words = [str(error) for error in errors]
        if words != self._problems.get(name, []):
            self._problems[name] = words
            for text in words:
                rospy.logwarn('%s', text)
        if news or facts.seen is not None and facts.parameters.get('robot_type') == 'generic':
            self._seen[name] = seen
        # A topic or parameter that merely vanished never changes a type under way.
        if name in self._open and (self._open[name] == robot_type
                                   or not (facts.parameters.get('robot_type') or news)):
            return
        self._open[name] = robot_type
        self._open_gate(name, robot_type)
