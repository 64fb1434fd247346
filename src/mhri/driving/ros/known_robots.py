# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots known to the drive, and their types: read from the master, off the driving path."""
import math
import threading
import time

import rospy

from mhri.base.names import DRIVEN, names_in, ROBOTS
from mhri.driving.operator_lease import MAX_ROBOTS
from mhri.graph.ros.announcer import Announcer
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.robots.ros.registry import RobotRegistry

PERIOD_S = 1.0
# How long to redetermine the type of a robot that publishes its own velocity [s].
AGAIN_S = 5.0


class KnownRobots:
    """A thread that opens and closes lines as robots enter and leave the list.

    A robot is known while it is in the screen's list (parameter ``/mhri/robots``) or selected. Once
    selected it stays known, also to the next drive, until it has left the list: a robot that was
    driven needs its zero, even if it was deselected meanwhile.

    :param types: {name: RobotType}
    :param open_line: called with (name, RobotType), on the thread; replaces an open line
    :param close_line: called with a name, on the thread
    :param watched: returns {name: (topics, prefixes of topics)} of the robots whose other
        publishers are to be reported
    :param on_publishers: called with a name and {(caller id, topic)}, on the thread
    :param insiders: returns {name: frozenset of the robot's own nodes that publish its velocity} of
        robots that are driven as generic
    :param unheard: see :class:`mhri.graph.ros.announcer.Announcer`; of robots that are present
    :param memory: :class:`mhri.graph.ros.stand_by.Memory` of the previous drive
    """

    def __init__(self, types, open_line, close_line, unheard, memory, watched, on_publishers,
                 insiders):
        self._registry = RobotRegistry(types)
        self._open_line = open_line
        self._close_line = close_line
        self._announcer = Announcer(unheard)
        self._memory = memory
        self._watched = watched
        self._on_publishers = on_publishers
        self._insiders = insiders
        self._inside = {}
        self._checked = frozenset()
        self._ever = {}
        self._recalled = False
        self._listed = frozenset()
        self._open = {}
        self._changed = threading.Event()

    def start(self):
        """Start the thread; return at once."""
        # Look at once: robots on a task, which are not selected, wait for their zero, too.
        self._changed.set()
        threading.Thread(target=self._run, name='known_robots', daemon=True).start()
        return self

    def check(self, names):
        """Set the selected robots; return at once."""
        self._checked = frozenset(names)
        if not self._checked <= set(self._open):
            self._changed.set()

    def look_now(self):
        """Schedule an immediate look; return at once."""
        self._changed.set()

    def _run(self):
        while not rospy.is_shutdown():
            self._changed.wait(PERIOD_S)
            self._changed.clear()
            try:
                self._look()
                self._announcer.announce()
            except (MasterError, OSError) as error:
                rospy.logdebug('cannot look at the robots now: %s', error)
            except Exception as error:  # without this thread no robot would ever be added
                rospy.logerr_throttle(
                    10.0, 'could not look at the robots: {}'.format(repr(error)[:300]))

    def _look(self):
        """Open and close lines as needed.

        :raises MasterError: the master does not answer; open lines stay open
        """
        api = MasterApi(rospy.get_name(), timeout_s=2.0)
        listed, driven = map(names_in, api.call_many([
            ('getParam', ROBOTS), ('getParam', DRIVEN)]))
        if not self._recalled:
            self._recalled = True
            # A restarted master has lost the list of driven robots.
            self._ever.update(dict.fromkeys(driven + names_in(self._memory.recall('robots'))))
        listed = frozenset(listed)
        gone, self._listed = self._listed - listed - self._checked, listed
        self._ever.update(dict.fromkeys(sorted(self._checked)))
        for name in gone:
            self._ever.pop(name, None)
        known = list(self._ever)[:MAX_ROBOTS]
        self._memory.keep('robots', known)
        if known != driven:
            # Before their lines open: never drive a robot that is not in the list.
            api.call('setParam', DRIVEN, known)
        wanted = list(dict.fromkeys(sorted(self._checked) + sorted(listed) + list(self._ever)))
        wanted = wanted[:MAX_ROBOTS]
        for name in set(self._open) - set(wanted):
            del self._open[name]
            self._registry.forget(name)
            self._close_line(name)
        known = self._registry.seen() - self._changing(time.monotonic())
        for name, robot_type in self._registry.look(wanted, known).items():
            if self._open.get(name) != robot_type:
                self._open[name] = robot_type
                self._open_line(name, robot_type)
        watched = self._watched()
        if watched:
            self._report_publishers(api.call('getSystemState')[0], watched)

    def _changing(self, now):
        """Return the robots with new publishers of their own on velocity topics, as a set.

        They stay in it for a few seconds: a multiplexer may still be starting.
        """
        found = set()
        for name, inside in self._insiders().items():
            known, at = self._inside.get(name, (frozenset(), -math.inf))
            if inside - known:
                at = now
            self._inside[name] = inside, at
            if now - at < AGAIN_S:
                found.add(name)
        return found

    def _report_publishers(self, published, watched):
        """Report the publishers of the robots' topics and of topics with their prefixes."""
        for name, (topics, prefixes) in watched.items():
            self._on_publishers(name, {
                (node, topic) for topic, nodes in published
                if topic in topics or topic.startswith(prefixes) for node in nodes})
