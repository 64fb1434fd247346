# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Determines why the active source cannot drive, and the remedy."""
import rospy

from mhri.base.reasons import Reason, SOURCE
from mhri.driving.advice import advice, MESSAGE_TYPES, SourceStatus
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.worker import Worker

PERIOD_S = 1.0


class Advice:
    """Passes advice on when it changes, and logs its text.

    It asks the master for the type of a topic only while the source is silent.

    :param facts: returns (active :class:`mhri.driving.ros.source_topic.SourceTopic`, waits_for)
    :param on_advice: called with the result of :func:`mhri.driving.advice.advice`, on a thread of
        this object
    """

    def __init__(self, facts, on_advice):
        self._facts = facts
        self._on_advice = on_advice
        self._said = '', ''
        self._api = MasterApi(rospy.get_name(), timeout_s=1.0)
        self._worker = Worker('advice', self._advise, PERIOD_S)

    def start(self):
        """Start a thread for it."""
        self._worker.start()

    def stop(self):
        """Stop the thread; return at once."""
        self._worker.stop()

    def _advise(self):
        """Determine the advice, and pass it on if it has changed."""
        topic, waits_for = self._facts()
        connected = topic.connected()
        stranger = self._stranger(topic.source, connected) if waits_for == SOURCE else None
        said = code, about = advice(topic.source, waits_for, SourceStatus(
            frozenset(connected), stranger, topic.spoke, topic.refusal, topic.rival))
        if said != self._said:
            self._said = said
            self._on_advice(code, about)
            if code:
                rospy.logwarn('%s: %s', topic.source.label, Reason(code, (about,)).sentence)

    def _stranger(self, source, connected):
        """Return (node, message type) of a publisher with a type other than the source's."""
        try:
            state, types = self._api.call_many([('getSystemState',), ('getTopicTypes',)])
        except MasterError:
            return None
        kind = dict(types or ()).get(source.topic)
        nodes = set(dict(state[0] if state else ()).get(source.topic, ())) - connected
        if not nodes or kind in (None, '*', MESSAGE_TYPES[source.kind]):
            return None
        return sorted(nodes)[0], kind
