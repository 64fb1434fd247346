# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells a robot's master that was restarted which nodes there are."""
import xmlrpc.client

import rospy

from mhri.graph.ros.knock import knock
from mhri.graph.ros.master_api import ERRORS, MasterApi, TimedTransport
from mhri.link.forgotten import Known, registrations

TIMEOUT_S = 1.0


class Recall:
    """Remembers who is registered, and registers them again with a master that has forgotten them.

    Their connections outlive the master; but who comes later, such as this link started once more,
    would find neither the guard nor the sensors.
    """

    def __init__(self):
        self._known = None

    def look(self):
        """Ask the master (blocking); call it every second or so.

        :raises MasterError: it cannot be asked now
        """
        api = MasterApi(rospy.get_name(), TIMEOUT_S)
        run, state, types = api.call_many([('getPid',), ('getSystemState',), ('getTopicTypes',)])
        now = Known(run, state, dict(map(tuple, types)), {})
        calls = [('lookupNode', node) for node in now.nodes()]
        calls += [('lookupService', name) for name, _ in state[2]]
        uris = dict(zip([name for _, name in calls], api.call_many(calls) if calls else ()))
        known, self._known = self._known, Known(
            run, state, now.types, {name: uri for name, uri in uris.items() if uri})
        if known is not None and known.run != run:
            self._tell(known, now)

    def _tell(self, known, now):
        """Register those that the master does not know and that live."""
        own = rospy.get_name()
        calls = registrations(known, now, knock(known.uris.values()), own)
        for node, rows in calls.items():
            answers = MasterApi(node, TIMEOUT_S).call_many(rows)
            for (method, name, _, uri), found in zip(rows, answers):
                if method == 'registerSubscriber' and found:
                    self._introduce(uri, name, found)
        if calls:
            rospy.loginfo('the ROS master had forgotten %s: registered again',
                          ', '.join(sorted(calls)))

    @staticmethod
    def _introduce(uri, topic, publishers):
        """Tell a node of the publishers of a topic, as the master does."""
        try:
            with xmlrpc.client.ServerProxy(uri, transport=TimedTransport(TIMEOUT_S)) as node:
                node.publisherUpdate('/master', topic, publishers)
        except ERRORS as error:
            rospy.logdebug('%s: %s', uri, error)
