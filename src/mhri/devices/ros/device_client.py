# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel's side of the input nodes: rumble, push-to-talk, recognised speech, devices.

Publishes ``/mhri_joy/rumble`` (``std_msgs/Empty``) and ``/mhri_voice/push_to_talk``
(``std_msgs/Bool``: on change, and at 5 Hz while it is held); subscribes ``/mhri_voice/heard``
(``mhri/Heard``) and ``device_state`` of each (:mod:`mhri.devices.ros.device_state`).
"""
import threading

import rospy
from std_msgs.msg import Bool, Empty

from mhri.base.text import tidy_text
from mhri.base.views import HeardView
from mhri.devices.ros.device_state import DeviceStates
from mhri.devices.source_rows import labelled_by_device, source_rows, suspend_services
from mhri.graph.ros.node_client import NodeClient
from mhri.msg import Heard

# Repeated while held, so that a panel that dies does not leave push-to-talk on [s].
TALK_PERIOD_S = 0.2


def choose_device(source, name):
    """Set the device that the node of a source opens, by its name (blocking: it asks the master).

    The node applies its parameter ``~device`` within a second of being resumed.
    """
    service = suspend_services(rospy.get_param('/mux/sources', []))[source]
    rospy.set_param(service.rpartition('/')[0] + '/device', name)


class DeviceClient:
    """The panel's connection to the input nodes; every method returns at once."""

    def __init__(self):
        self._client = NodeClient('push_to_talk')
        self._rumble = self._client.advertise('/mhri_joy/rumble', Empty, queue_size=1)
        self._talk = self._client.advertise('/mhri_voice/push_to_talk', Bool, queue_size=1)
        self._heard = None
        self._client.subscribe('/mhri_voice/heard', Heard, self._on_heard, queue_size=10)
        self._sources = ()
        self._states = DeviceStates()
        self._changed = threading.Condition()
        self._talking = False
        self._closed = False
        self._client.do(self._repeat)

    def _on_heard(self, message):
        self._heard = HeardView(tidy_text(message.text), tidy_text(message.command),
                                message.accepted, tidy_text(message.reason))

    def follow(self, rows):
        """Subscribe the device states of the sources (blocking: it asks the master).

        :param rows: the parameter ``/mux/sources``
        """
        self._sources = source_rows(rows)
        self._states.follow(suspend_services(rows))

    def view(self):
        """Return the part of a :class:`mhri.base.views.ScreenView` on devices, as a dict."""
        devices = self._states.views()
        return {'sources': labelled_by_device(self._sources, devices), 'devices': devices,
                'heard': self._heard}

    def rumble(self):
        """Rumble the pad, since a robot was lost."""
        self._rumble.publish()

    def talk(self, pressed):
        """Switch push-to-talk of the voice node on (True) or off."""
        with self._changed:
            if pressed != self._talking:
                self._talking = pressed
                self._talk.publish(data=pressed)
                self._changed.notify()

    def _repeat(self):
        with self._changed:
            while not self._closed:
                self._changed.wait(TALK_PERIOD_S if self._talking else None)
                if self._talking and not self._closed:
                    self._talk.publish(data=True)

    def close(self):
        """Switch push-to-talk off."""
        self.talk(False)
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._client.close()

    def unregister(self):
        """Unregister every topic (blocking: it asks the master)."""
        self._client.unregister()
        self._states.unregister()
