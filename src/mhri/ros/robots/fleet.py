# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots of the panel: their types, links and gates, made and mended off the GUI thread."""
import threading
import time
from dataclasses import replace

import rospy

from mhri.core.robots.robot_types import resolve_robot_type, Seen
from mhri.core.screen.views import GONE, LIVE, RobotView, SILENT, WAITING
from mhri.ros.robots.bot_feeds import BotFeeds
from mhri.ros.driving.gate import Gate
from mhri.ros.graph.look import robot_facts
from mhri.ros.graph.master_api import MasterError
from mhri.ros.robots.robot_link import RobotLink


# A robot that is heard and does not listen is told of its publishers again this often.
ANNOUNCE_S = 5.0


class Fleet:
    """The links of the robots in the list.

    :param types: {name: RobotType}
    :param bank: :class:`mhri.ros.driving.gates.GateBank`
    :param worker: :class:`mhri.ros.worker.Worker` for the feeds of the windows
    :param on_sent: see :class:`mhri.ros.driving.gate.Gate`
    """

    def __init__(self, types, bank, worker, on_sent, clock=time.monotonic):
        self._types = types
        self._bank = bank
        self._worker = worker
        self._on_sent = on_sent
        self._clock = clock
        self._lock = threading.Lock()
        self._links = {}
        self._wanted = set()
        self._problems = {}
        self._seen = {}
        self._announced = {}

    def want(self, name):
        """Take note that a robot is in the list; :meth:`connect` makes its link."""
        with self._lock:
            self._wanted.add(name)

    def drop(self, name):
        """Stop a robot and forget it; return its link for :meth:`RobotLink.close`, or None."""
        with self._lock:
            self._wanted.discard(name)
            link = self._links.pop(name, None)
            self._seen.pop(name, None)
            self._announced.pop(name, None)
        self._bank.remove(name)
        return link

    def connect(self, name, facts=None):
        """Make the link of a robot, or a new one where its type has changed (blocking).

        :param facts: its :class:`mhri.ros.graph.look.Facts` where they are known already
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
            self._bank.remove(name)
            old.close()
        link = RobotLink(name, robot_type, Gate.of_type(name, robot_type, self._on_sent),
                         BotFeeds(name, robot_type, self._worker))
        with self._lock:
            self._links[name] = link
        self._bank.add(link.gate)
        if self._bank.stopped:
            link.on_stop(True, self._clock())

    def _report(self, name, errors):
        """Log problems of a robot's parameters once."""
        words = [str(error) for error in errors]
        if words and self._problems.get(name) != words:
            for text in words:
                rospy.logwarn('%s', text)
        self._problems[name] = words

    def supervise(self):
        """Look again at the type of each robot that is not heard: it may have come up meanwhile.

        What was seen of one that can be reached stays: a type never changes under way for a topic
        that comes or goes.
        """
        with self._lock:
            names = [name for name in self._wanted if name not in self._links
                     or self._links[name].view().link in (WAITING, GONE)
                     or self._links[name].robot_type.name == 'generic']
            seen = {name: self._seen.get(name, Seen()) for name in names
                    if name in self._links and self._links[name].gate.reachable()}
        try:
            facts = robot_facts(rospy.get_name(), names, self._types, seen)
        except (MasterError, ValueError, OSError) as error:
            rospy.logdebug('the robots cannot be looked at now: %s', error)
            return
        for name in names:
            self.connect(name, facts[name])
        with self._lock:
            links = list(self._links.values())
        self._announce(links)
        for link in links:
            link.listen_to_guard()

    def _announce(self, links):
        """Let robots that are heard, but not reached, know who speaks to them."""
        now = self._clock()
        for link in links:
            due = now - self._announced.get(link.name, link.added_at) >= ANNOUNCE_S
            if due and link.view().link == LIVE and not (
                    link.gate.follows and link.gate.reachable()):
                self._announced[link.name] = now
                self._bank.announce(link.name)

    def hold_silent(self):
        """Hold the robots that were heard and are not any more; let go those that are heard again.

        Called several times a second, on a thread.
        """
        self._bank.drop_cut()
        with self._lock:
            links = list(self._links.values())
        for link in links:
            held = link.view().link in (SILENT, GONE) or not link.heard_since(link.gate.lost_at)
            if held != link.gate.rule.held:
                self._bank.hold(link.name, held)

    def on_stop(self, stopped, now):
        """Begin or end the proof of a stop for every robot."""
        with self._lock:
            links = list(self._links.values())
        for link in links:
            link.on_stop(stopped, now)

    def robot_type(self, name):
        """Return the :class:`RobotType` of a robot, None before its link is made."""
        with self._lock:
            link = self._links.get(name)
        return link.robot_type if link else None

    def camera_bits_per_s(self):
        """Return what the pictures on show of all robots take of the network now [bit/s]."""
        with self._lock:
            links = list(self._links.values())
        return sum(link.feeds.bits_per_s() for link in links)

    def feeds(self, name):
        """Return the :class:`BotFeeds` of a robot, None before its link is made."""
        with self._lock:
            link = self._links.get(name)
        return link.feeds if link else None

    def view(self, name, selected, recording=False):
        """Return the :class:`RobotView` of one robot."""
        with self._lock:
            link = self._links.get(name)
            problems = self._problems.get(name)
        if link is None:
            return RobotView(name=name, selected=selected, recording=recording,
                             note='looking for it')
        view = link.view()
        return replace(view, selected=selected, recording=recording,
                       note=view.note or (problems[0] if problems else ''))

    def close(self):
        """Give the topics of all robots back (blocking)."""
        with self._lock:
            self._wanted.clear()
            links, self._links = list(self._links.values()), {}
        for link in links:
            link.close()
