# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Says on ``/mux/advice`` what keeps the active source from driving, and what to do about it."""
import rospy
from std_msgs.msg import String

from mhri.driving.advice import advice, Heard, MESSAGE_TYPES
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.worker import Worker

PERIOD_S = 1.0


class Advice:
    """Publishes ``/mux/advice`` (``std_msgs/String``, latched: a sentence, '' for none) on change.

    It asks the master for the type of a topic only while it hears nothing from the source.

    :param facts: returns (active :class:`mhri.driving.ros.source_topic.SourceTopic`, waits_for)
    """

    def __init__(self, facts):
        self._facts = facts
        self._said = None
        self._api = MasterApi(rospy.get_name(), timeout_s=1.0)
        self._topic = rospy.Publisher('/mux/advice', String, queue_size=10, latch=True)
        self._worker = Worker('advice', self._advise, PERIOD_S)

    def start(self):
        """Begin, on a thread of its own."""
        self._worker.start()

    def stop(self):
        """End; returns at once."""
        self._worker.stop()

    def _advise(self):
        """Look once, and publish what has changed."""
        topic, waits_for = self._facts()
        connected = topic.connected()
        stranger = self._stranger(topic.source, connected) if waits_for == 'source' else None
        words = advice(topic.source, waits_for, Heard(
            frozenset(connected), stranger, topic.spoke, topic.refusal, topic.rival))
        if words != self._said:
            self._said = words
            self._topic.publish(data=words)
            if words:
                rospy.logwarn('%s', words)

    def _stranger(self, source, connected):
        """Return (node, message type) of a publisher of another type than the source's."""
        try:
            state, types = self._api.call_many([('getSystemState',), ('getTopicTypes',)])
        except MasterError:
            return None
        kind = dict(types or ()).get(source.topic)
        nodes = set(dict(state[0] if state else ()).get(source.topic, ())) - connected
        if not nodes or kind in (None, '*', MESSAGE_TYPES[source.kind]):
            return None
        return sorted(nodes)[0], kind
