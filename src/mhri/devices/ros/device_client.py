# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel's side of the input nodes: a shake of the pad, push-to-talk, and what was heard.

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
from mhri.devices.source_rows import called_by_device, source_rows, suspend_services
from mhri.msg import Heard

# Repeated while held, so that a panel that dies does not leave the ear open [s].
TALK_PERIOD_S = 0.2


def choose_device(source, name):
    """Have the node of a source open the device of this name (blocking: it asks the master).

    It does so within a second of being resumed, by its parameter ``~device``.
    """
    service = suspend_services(rospy.get_param('/mux/sources', []))[source]
    rospy.set_param(service.rpartition('/')[0] + '/device', name)


class DeviceClient:
    """The panel's words to the input nodes, and theirs to it; every method returns at once."""

    def __init__(self):
        self._rumble = rospy.Publisher('/mhri_joy/rumble', Empty, queue_size=1)
        self._talk = rospy.Publisher('/mhri_voice/push_to_talk', Bool, queue_size=1,
                                     tcp_nodelay=True)
        self._heard_topic = rospy.Subscriber('/mhri_voice/heard', Heard, self._hear, queue_size=10)
        self._heard = None
        self._sources = ()
        self._states = DeviceStates()
        self._changed = threading.Condition()
        self._talking = False
        self._closed = False
        threading.Thread(target=self._repeat, name='push_to_talk', daemon=True).start()

    def _hear(self, message):
        self._heard = HeardView(tidy_text(message.text), tidy_text(message.command),
                                message.accepted, tidy_text(message.reason))

    def follow(self, rows):
        """Listen to which devices the sources have (blocking: it asks the master).

        :param rows: the parameter ``/mux/sources``
        """
        self._sources = source_rows(rows)
        self._states.follow(suspend_services(rows))

    def view(self):
        """Return the part of a :class:`mhri.base.views.PanelView` on devices, as a dict."""
        devices = self._states.views()
        return {'sources': called_by_device(self._sources, devices), 'devices': devices,
                'heard': self._heard}

    def rumble(self):
        """Shake the pad: a robot was lost."""
        self._rumble.publish()

    def talk(self, pressed):
        """Open (True) or close the ear of the voice node."""
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
        """Close the ear."""
        self.talk(False)
        with self._changed:
            self._closed = True
            self._changed.notify()

    def unregister(self):
        """Unregister every topic (blocking: it asks the master)."""
        for topic in (self._rumble, self._talk, self._heard_topic):
            topic.unregister()
        self._states.unregister()
