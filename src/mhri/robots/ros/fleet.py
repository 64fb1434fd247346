# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots of the panel: their types and links, made and repaired off the GUI thread."""
import threading
import time
from dataclasses import replace

import rospy

from mhri.base.names import topic_of
from mhri.base.robot_types import resolve_robot_type, Seen
from mhri.base.views import GONE, RobotView, WAITING
from mhri.graph.ros.master_api import MasterError
from mhri.robots.link_quality import LinkQuality
from mhri.robots.ros.bot_feeds import BotFeeds
from mhri.robots.ros.controls import Controls
from mhri.robots.ros.look import robot_facts
from mhri.robots.ros.robot_link import RobotLink


class Fleet:
    """The links of the robots in the list.

    :param types: {name: RobotType}
    :param gates: :class:`mhri.driving.ros.gates_client.GatesClient`
    :param worker: :class:`mhri.graph.ros.worker.Worker` for the feeds of the tiles
    :param clock: function that returns seconds that never go back
    :param wall: function that returns the time of day [s since 1970]
    :param told: called with what the operator is to read
    """

    def __init__(self, types, gates, worker, clock=time.monotonic, wall=time.time, told=None):
        self._types = types
        self._gates = gates
        self._worker = worker
        self._clock = clock
        self._wall = wall
        self._lock = threading.Lock()
        self._links = {}
        self._wanted = set()
        self._problems = {}
        self._seen = {}
        self._stopped = False
        #: makes what measures a robot's link
        self.quality = LinkQuality
        #: who has control of robots that are linked
        self.controls = Controls(told or rospy.loginfo)

    def want(self, name):
        """Note that a robot is in the list; :meth:`connect` makes its link."""
        with self._lock:
            self._wanted.add(name)

    def drop(self, name):
        """Forget a robot; return its link for :meth:`RobotLink.close`, or None."""
        with self._lock:
            self._wanted.discard(name)
            link = self._links.pop(name, None)
            self._seen.pop(name, None)
        self.controls.forget(name)
        return link

    def connect(self, name, facts=None):
        """Make the link of a robot, or a new one if its type has changed (blocking).

        :param facts: its :class:`mhri.robots.ros.look.Facts` if already known
        """
        try:
            if facts is None:
                facts = robot_facts(rospy.get_name(), [name], self._types)[name]
        except (MasterError, ValueError, OSError) as error:
            rospy.logwarn('%s: %s', name, error)
            return
        news = facts.seen is not None and facts.seen.anything()
        with self._lock:
            seen = facts.seen if news else self._seen.get(name, Seen())
        robot_type, errors = resolve_robot_type(self._types, name, facts.parameters, seen)
        with self._lock:
            old = self._links.get(name)
            self._report(name, errors)
            if name not in self._wanted or old and (
                    old.robot_type == robot_type
                    or not (facts.parameters.get('robot_type') or news)):
                return
            self._seen[name] = seen
            self._links.pop(name, None)
        if old is not None:
            old.close()
        link = RobotLink(name, robot_type, self._gates, BotFeeds(name, robot_type, self._worker),
                         self._clock, self._wall, self.quality)
        with self._lock:
            wanted = name in self._wanted
            if wanted:
                self._links[name] = link
                self.controls.watch(name)
            stopped = self._stopped
        if not wanted:  # forgotten meanwhile
            link.close()
        elif stopped:
            link.on_stop(True, self._clock())

    def _report(self, name, errors):
        """Log problems of a robot's parameters once."""
        words = [str(error) for error in errors]
        if words and self._problems.get(name) != words:
            for text in words:
                rospy.logwarn('%s', text)
        self._problems[name] = words

    def supervise(self):
        """Look again at the type of each silent robot: it may have started meanwhile.

        A robot within reach keeps its type: a topic that comes or goes never changes it on the
        move.
        """
        with self._lock:
            names = [name for name in self._wanted if name not in self._links
                     or self._links[name].view().link in (WAITING, GONE)
                     or self._links[name].robot_type.name == 'generic']
            seen = {name: self._seen.get(name, Seen()) for name in names
                    if name in self._links and self._is_reached(name)}
        try:
            facts = robot_facts(rospy.get_name(), names, self._types, seen)
        except (MasterError, ValueError, OSError) as error:
            rospy.logdebug('cannot look at the robots now: %s', error)
            return
        for name in names:
            self.connect(name, facts[name])
        with self._lock:
            links = list(self._links.values())
        for link in links:
            link.listen_to_guard()

    def _is_reached(self, name):
        """Tell whether the gates send a robot's commands to where this screen thinks it listens.

        If they send them elsewhere, they have looked later.
        """
        gate = self._gates.robot(name)
        return gate is not None and (gate.guarded or gate.topic in [
            topic_of(name, topic) for topic in self._links[name].robot_type.command])

    def on_stop(self, stopped, now):
        """Begin or end the proof of a stop for every robot."""
        with self._lock:
            self._stopped = stopped
            links = list(self._links.values())
        for link in links:
            link.on_stop(stopped, now)

    def on_gates(self, gates):
        """Take in what the gates say of each robot (a list of ``mhri/RobotGate``)."""
        with self._lock:
            links = [(self._links[gate.name], gate) for gate in gates if gate.name in self._links]
        for link, gate in links:
            link.on_gate(gate)

    def robot_type(self, name):
        """Return the :class:`RobotType` of a robot, None before its link is made."""
        with self._lock:
            link = self._links.get(name)
        return link.robot_type if link else None

    def camera_bits_per_s(self):
        """Return how much of the network all pictures on show take now [bit/s]."""
        with self._lock:
            links = list(self._links.values())
        return sum(link.feeds.bits_per_s() for link in links)

    def feeds(self, name):
        """Return the :class:`BotFeeds` of a robot, None before its link is made."""
        with self._lock:
            link = self._links.get(name)
        return link.feeds if link else None

    def view(self, name, **ours):
        """Return the :class:`RobotView` of one robot; ``ours`` is what the screen knows of it."""
        with self._lock:
            link = self._links.get(name)
            problems = self._problems.get(name)
        if link is None:
            return RobotView(name=name, note='looking for it', **ours)
        view = self.controls.seen(link.view())
        return replace(view, note=view.note or (problems[0] if problems else ''), **ours)

    def close(self):
        """Unregister the topics of all robots (blocking)."""
        with self._lock:
            self._wanted.clear()
            self.controls.close()
            links, self._links = list(self._links.values()), {}
        for link in links:
            link.close()
