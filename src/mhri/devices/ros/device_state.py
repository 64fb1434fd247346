# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The device of an input node, for the screen: ``device_state`` beside its ``set_suspended``.

``diagnostic_msgs/DiagnosticStatus``, latched, on change: ``name`` is the kind of device, e.g.
'pad'; ``hardware_id`` the name of the open device, or of the device that would be opened if the
node were resumed, or ''; ``message`` the reason for a missing device and the remedy, or an action
that the present one needs; the level is OK with a device, WARN without one, STALE if that is
unknown until the node opens it. ``values`` has a ``there`` for each device that could be opened
instead.
"""
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
import rospy

from mhri.base.text import tidy_text
from mhri.base.views import DeviceView

THERE = 'there'
MAX_DEVICES = 20


def state_topic(service):
    """Return the name of the topic beside a service ``set_suspended``."""
    return service.rpartition('/')[0] + '/device_state'


class DeviceState:
    """The node's side.

    :param service: resolved name of its ``set_suspended``
    :param kind: kind of the device, e.g. 'pad'
    """

    def __init__(self, service, kind):
        self._kind = kind
        self._published = None
        self._topic = rospy.Publisher(state_topic(service), DiagnosticStatus, queue_size=1,
                                      latch=True)

    def publish(self, device, note, there=()):
        """Publish the present device; repeating the same costs nothing."""
        if (device, note, there) != self._published:
            self._published = device, note, there
            level = DiagnosticStatus.OK if device else \
                DiagnosticStatus.WARN if note else DiagnosticStatus.STALE
            self._topic.publish(level=level, name=self._kind, message=note, hardware_id=device,
                                values=[KeyValue(THERE, name) for name in there])


class DeviceStates:
    """The screen's side: the states of the input nodes while they are connected."""

    def __init__(self):
        self._subscribers = {}
        self._newest = {}

    def follow(self, services):
        """Subscribe the states of the present sources (blocking: it asks the master).

        :param services: {source: name of its ``set_suspended``}
        """
        for key in set(self._subscribers) - set(services.items()):
            self._subscribers.pop(key).unregister()
        for key in set(services.items()) - set(self._subscribers):
            self._subscribers[key] = rospy.Subscriber(
                state_topic(key[1]), DiagnosticStatus, self._on_state, callback_args=key[0],
                queue_size=1)

    def _on_state(self, message, source):
        self._newest[source] = DeviceView(source, *map(tidy_text, (
            message.hardware_id, message.message, message.name)), tuple(
                tidy_text(pair.value) for pair in message.values[:MAX_DEVICES]
                if pair.key == THERE and pair.value))

    def views(self):
        """Return a :class:`mhri.base.views.DeviceView` of each device known now."""
        return tuple(self._newest[source] for (source, _), subscriber in
                     sorted(list(self._subscribers.items()))
                     if source in self._newest and subscriber.get_num_connections())

    def unregister(self):
        """Unregister all topics (blocking: it asks the master)."""
        self.follow({})
