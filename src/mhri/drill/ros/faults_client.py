# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen's client of faults: finds simulated robots and their active faults.

Looks up ``/<robot>/base/set_fault`` (``mhri/SetFault``) at the master, which only simulated robots
provide, and calls it. All blocking calls run on a worker.
"""
import queue

import rospy

from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.node_client import call
from mhri.graph.ros.rospy_inside import is_initialised
from mhri.graph.ros.worker import Worker
from mhri.srv import SetFault

LOOK_S = 2.0
_SERVICE = '/{}/base/set_fault'


class FaultsClient:
    """The client; every method returns at once."""

    def __init__(self):
        self._names = self._simulated = ()
        self._watched = False
        self._news = queue.Queue()
        self._worker = Worker('faults', self._look, LOOK_S).start()

    def follow(self, names):
        """Set the robots to check for simulated ones."""
        self._names = tuple(names)

    def watch(self, watched):
        """Start or stop polling the active faults of the robots."""
        self._watched = watched
        self._worker.do(self._look)

    def simulated(self):
        """Return the names of the simulated robots."""
        return self._simulated

    def ask(self, robot, key, value, duration_s):
        """Request a fault; see ``SetFault.srv``."""
        self._worker.do(self._call, robot, key, value, duration_s)

    def take_news(self):
        """Return the answers since the last call: [(robot, success, sentence)]."""
        news = []
        while not self._news.empty():
            news.append(self._news.get())
        return news

    def close(self):
        """Stop polling."""
        self._worker.stop()

    def _look(self):
        """Find the simulated robots; while the page is open, poll their faults."""
        names = self._names
        if not names or not is_initialised():
            return
        try:
            found = MasterApi(rospy.get_name(), timeout_s=1.0).call_many(
                [('lookupService', _SERVICE.format(name)) for name in names])
        except MasterError as error:
            rospy.logdebug('simulated robots cannot be looked for now: %s', error)
            return
        self._simulated = tuple(name for name, uri in zip(names, found) if uri)
        for name in self._simulated if self._watched else ():
            self._call(name, '', 0.0, 0.0)

    def _call(self, robot, key, value, duration_s):
        answer = call(_SERVICE.format(robot), SetFault, key, value, duration_s, log=rospy.logdebug)
        self._news.put((robot, answer.success, answer.message) if answer else (
            robot, False, '{} does not answer: its driver is dead, or does not run'.format(robot)))
