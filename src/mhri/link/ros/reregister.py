# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Registers the running nodes of a robot again after its master has restarted."""
import xmlrpc.client

import rospy

from mhri.graph.ros.parallel_calls import connectable
from mhri.graph.ros.master_api import ERRORS, MasterApi, TimedTransport
from mhri.link.lost_registrations import MasterState, registrations

TIMEOUT_S = 1.0


class Reregistration:
    """Remembers the registered nodes, and registers them again with a restarted master.

    Connections outlive the master, but nodes that start later, such as a restarted link, would
    find neither the guard nor the sensors.
    """

    def __init__(self):
        self._known = None

    def look(self):
        """Query the master (blocking); to be called about once a second.

        :raises MasterError: the master is unavailable
        """
        api = MasterApi(rospy.get_name(), TIMEOUT_S)
        run, state, types = api.call_many([('getPid',), ('getSystemState',), ('getTopicTypes',)])
        now = MasterState(run, state, dict(map(tuple, types)), {})
        calls = [('lookupNode', node) for node in now.nodes()]
        calls += [('lookupService', name) for name, _ in state[2]]
        uris = dict(zip([name for _, name in calls], api.call_many(calls) if calls else ()))
        known, self._known = self._known, MasterState(
            run, state, now.types, {name: uri for name, uri in uris.items() if uri})
        if known is not None and known.run != run:
            self._register(known, now)

    def _register(self, known, now):
        """Register the running nodes that the master has lost."""
        own = rospy.get_name()
        calls = registrations(known, now, connectable(known.uris.values()), own)
        for node, rows in calls.items():
            answers = MasterApi(node, TIMEOUT_S).call_many(rows)
            for (method, name, _, uri), found in zip(rows, answers):
                if method == 'registerSubscriber' and found:
                    self._introduce(uri, name, found)
        if calls:
            rospy.loginfo('the ROS master had lost %s: registered again',
                          ', '.join(sorted(calls)))

    @staticmethod
    def _introduce(uri, topic, publishers):
        """Inform a node of the publishers of a topic, like the master."""
        try:
            with xmlrpc.client.ServerProxy(uri, transport=TimedTransport(TIMEOUT_S)) as node:
                node.publisherUpdate('/master', topic, publishers)
        except ERRORS as error:
            rospy.logdebug('%s: %s', uri, error)
