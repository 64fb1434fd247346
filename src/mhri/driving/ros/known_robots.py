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
from mhri.robots.found_streams import FoundStreams
from mhri.robots.ros.registry import RobotRegistry
from mhri.robots.twins import twins_on_graph

PERIOD_S = 1.0
# How long to look at the whole graph after a new node reads or publishes a robot's velocity [s].
AGAIN_S = 5.0


class KnownRobots:
    """A thread that opens and closes lines as robots enter and leave the list.

    A robot is known while it is in the screen's list (parameter ``/mhri/robots``) or selected. Once
    selected it stays known, also to the next drive, until it has left the list: a robot that was
    driven needs its zero, even if it was deselected meanwhile.

    :param types: {name: RobotType}
    :param open_line: called with (name, RobotType, whether it is only presumed), on the thread;
        replaces an open line
    :param close_line: called with a name, on the thread
    :param watched: returns {name: (topics, prefixes of topics)} of the robots whose other
        publishers are to be reported
    :param on_publishers: called with a name and {(caller id, topic)}, on the thread
    :param readers: returns {name: its nodes that read one velocity topic} of robots with several
    :param on_twins: called with a name and the nodes that are a robot each, on the thread
    :param nodes: returns {name: frozenset of the nodes that read or publish the robot's velocity}
    :param unheard: see :class:`mhri.graph.ros.announcer.Announcer`; of robots that are present
    :param memory: :class:`mhri.graph.ros.stand_by.Memory` of the previous drive
    """

    def __init__(self, types, open_line, close_line, unheard, memory, watched, on_publishers,
                 readers, on_twins, nodes):
        # A new type replaces the line, which stops the robot: not for a camera.
        self._registry = RobotRegistry(types, lambda: FoundStreams(('odometry', 'scan')))
        self._open_line = open_line
        self._close_line = close_line
        self._announcer = Announcer(unheard)
        self._memory = memory
        self._watched = watched
        self._on_publishers = on_publishers
        self._readers, self._on_twins = readers, on_twins
        self._nodes = nodes
        self._known_nodes, self._new_at = {}, -math.inf
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
        changing = self._changing(time.monotonic())
        known = () if changing else self._registry.seen()
        for name, robot_type in self._registry.look(wanted, known).items():
            if self._open.get(name) != robot_type:
                self._open[name] = robot_type
                self._open_line(name, robot_type, self._registry.presumed(name))
        watched, readers = self._watched(), self._readers() if changing else {}
        if watched or readers:
            published = api.call('getSystemState')[0]
            self._report_publishers(published, watched)
            kinds = dict(api.call('getTopicTypes')) if readers else {}
            for name, nodes in readers.items():
                self._on_twins(name, twins_on_graph(name, published, kinds, nodes))

    def _changing(self, now):
        """Return whether a node that reads or publishes the velocity of a robot is new.

        It stays new for a few seconds: a multiplexer may still be starting. And it may show that
        another robot is only an input of this one.
        """
        before, self._known_nodes = self._known_nodes, self._nodes()
        if any(nodes - before.get(name, frozenset())
               for name, nodes in self._known_nodes.items()):
            self._new_at = now
        return now - self._new_at < AGAIN_S

    def _report_publishers(self, published, watched):
        """Report the publishers of the robots' topics and of topics with their prefixes."""
        for name, (topics, prefixes) in watched.items():
            self._on_publishers(name, {
                (node, topic) for topic, nodes in published
                if topic in topics or topic.startswith(prefixes) for node in nodes})
