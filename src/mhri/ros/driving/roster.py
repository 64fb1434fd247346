# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which robots the gates know, and of what type they are: asked of the master off their path."""
import threading
import time

import rospy

from mhri.core.robots.names import name_problem
from mhri.core.robots.robot_types import resolve_robot_type, Seen
from mhri.ros.graph.look import robot_facts
from mhri.ros.graph.master_api import MasterApi, MasterError

ROBOTS_PARAMETER = '/mhri/robots'
# What was ever checked, for the gates after these: a robot that was driven needs their zero, even
# where it was unchecked meanwhile.
DRIVEN_PARAMETER = '/mhri_gates/robots'
PERIOD_S = 1.0
# A robot that is heard and does not listen is told of its topics again this often.
ANNOUNCE_S = 5.0
MOST_ROBOTS = 64


def _names(value):
    """Return the names of robots in a parameter, whatever else it holds."""
    return [name for name in value if isinstance(name, str) and name_problem(name) is None] \
        if isinstance(value, list) else []


class Roster:
    """A thread that opens and closes gates as robots come into the list and go.

    A robot is known while it is in the screen's list (parameter ``/mhri/robots``) or checked, and
    once checked it stays until it has left the list; the gates after these know it as well.

    :param types: {name: RobotType}
    :param open_gate: called with (name, RobotType), on the thread; replaces what was open
    :param close_gate: called with a name, on the thread
    :param unheard: returns [(topic, type)] that robots which are heard do not listen to
    """

    def __init__(self, types, open_gate, close_gate, unheard):
        self._types = types
        self._open_gate = open_gate
        self._close_gate = close_gate
        self._unheard = unheard
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
        threading.Thread(target=self._run, name='roster', daemon=True).start()
        return self

    def check(self, names):
        """Take note of the robots that are checked; returns at once."""
        self._checked = frozenset(names)
        if not self._checked <= set(self._open):
            self._changed.set()

    def _run(self):
        while not rospy.is_shutdown():
            self._changed.wait(PERIOD_S)
            self._changed.clear()
            try:
                self._look()
                self._announce(time.monotonic())
            except (MasterError, OSError) as error:
                rospy.logdebug('the robots cannot be looked at now: %s', error)
            except Exception as error:  # without this thread no robot would ever be added
                rospy.logerr_throttle(
                    10.0, 'the robots could not be looked at: {}'.format(repr(error)[:300]))

    def _look(self):
        """Compare what is wanted with what is open.

        :raises MasterError: the master cannot be asked now; what is open stays
        """
        api = MasterApi(rospy.get_name(), timeout_s=2.0)
        listed, driven = map(_names, api.call_many([
            ('getParam', ROBOTS_PARAMETER), ('getParam', DRIVEN_PARAMETER)]))
        if not self._recalled:
            self._recalled = True
            self._ever.update(dict.fromkeys(driven))
        listed = frozenset(listed)
        gone, self._listed = self._listed - listed - self._checked, listed
        self._ever.update(dict.fromkeys(sorted(self._checked)))
        for name in gone:
            self._ever.pop(name, None)
        known = list(self._ever)[:MOST_ROBOTS]
        if known != driven:
            # Before their gates are open: nobody is driven who is not written down.
            api.call('setParam', DRIVEN_PARAMETER, known)
        wanted = list(dict.fromkeys(sorted(self._checked) + sorted(listed) + list(self._ever)))
        wanted = wanted[:MOST_ROBOTS]
        for name in set(self._open) - set(wanted):
            del self._open[name]
            self._seen.pop(name, None)
            self._close_gate(name)
        seen = {name: self._seen[name] for name in wanted if name in self._seen}
        for name, facts in robot_facts(rospy.get_name(), wanted, self._types, seen).items():
            self._settle(name, facts)

    def _announce(self, now):
        """Register topics again that robots should listen to and do not.

        The master tells a robot of a new publisher once: one that hung or was out of reach just
        then would never know.

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
        """Open the gate of a robot, or another one where its type has changed."""
        news = facts.seen is not None and facts.seen.anything()
        seen = facts.seen if news else self._seen.get(name, Seen())
        robot_type, errors = resolve_robot_type(self._types, name, facts.parameters, seen)
        words = [str(error) for error in errors]
        if words != self._problems.get(name, []):
            self._problems[name] = words
            for text in words:
                rospy.logwarn('%s', text)
        # A type never changes under way for a topic or parameter that only went.
        if name in self._open and (self._open[name] == robot_type
                                   or not (facts.parameters.get('robot_type') or news)):
            return
        if news:
            self._seen[name] = seen
        self._open[name] = robot_type
        self._open_gate(name, robot_type)
