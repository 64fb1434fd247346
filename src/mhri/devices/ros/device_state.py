# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which device an input node has, for the screen: ``device_state`` beside its ``set_suspended``.

``diagnostic_msgs/DiagnosticStatus``, latched, on change: ``name`` is what the device is, e.g.
'pad'; ``hardware_id`` the name of the open device, or of the one that would open if the node were
resumed, '' if there is none; ``message`` why there is none and the remedy, or what the present one
needs; OK if there is a device, WARN if there is none, STALE if the node cannot tell without opening
it. ``values`` has a ``there`` for each device that could be opened instead.
"""
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
import rospy

from mhri.base.text import tidy_text
from mhri.base.views import DeviceView

THERE = 'there'
MOST_DEVICES = 20


def state_topic(service):
    """Return the name of the topic beside a service ``set_suspended``."""
    return service.rpartition('/')[0] + '/device_state'


class DeviceState:
    """The node's side.

    :param service: resolved name of its ``set_suspended``
    :param kind: what the device is, e.g. 'pad'
    """

    def __init__(self, service, kind):
        self._kind = kind
        self._told = None
        self._topic = rospy.Publisher(state_topic(service), DiagnosticStatus, queue_size=1,
                                      latch=True)

    def tell(self, device, note, there=()):
        """Say which device there is; repeating the same costs nothing."""
        if (device, note, there) != self._told:
            self._told = device, note, there
            level = DiagnosticStatus.OK if device else \
                DiagnosticStatus.WARN if note else DiagnosticStatus.STALE
            self._topic.publish(level=level, name=self._kind, message=note, hardware_id=device,
                                values=[KeyValue(THERE, name) for name in there])


class DeviceStates:
    """The panel's side: what the input nodes say, for as long as they live."""

    def __init__(self):
        self._subscribers = {}
        self._said = {}

    def follow(self, services):
        """Listen to the nodes of the present sources (blocking: it asks the master).

        :param services: {source: name of its ``set_suspended``}
        """
        for key in set(self._subscribers) - set(services.items()):
            self._subscribers.pop(key).unregister()
        for key in set(services.items()) - set(self._subscribers):
            self._subscribers[key] = rospy.Subscriber(
                state_topic(key[1]), DiagnosticStatus, self._hear, callback_args=key[0],
                queue_size=1)

    def _hear(self, message, source):
        self._said[source] = DeviceView(source, *map(tidy_text, (
            message.hardware_id, message.message, message.name)), tuple(
                tidy_text(pair.value) for pair in message.values[:MOST_DEVICES]
                if pair.key == THERE and pair.value))

    def views(self):
        """Return a :class:`mhri.base.views.DeviceView` of each device known now."""
        return tuple(self._said[source] for (source, _), subscriber in
                     sorted(list(self._subscribers.items()))
                     if source in self._said and subscriber.get_num_connections())

    def unregister(self):
        """Stop listening (blocking: it asks the master)."""
        self.follow({})
