# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pad's row of ``resource/inputs.yaml``; the pad rumbles at STOP ALL and at a lost robot."""
import rospy
from std_msgs.msg import Bool, Empty

from mhri.devices.io.pad import PadReader
from mhri.devices.ros.device import Device
from mhri.devices.ros.pad_profiles import pad_profiles
from mhri.graph.ros.service_owner import ServiceOwner, STOP_SERVICE


def pad():
    """Return the :class:`Device`; see :mod:`mhri.nodes.mhri_joy`."""
    reader = PadReader(pad_profiles)
    Rumble(reader.rumble, '~rumble')
    return Device(reader, {'~device': reader.choose})


class Rumble:
    """Calls ``shake`` when stop-all is engaged, and at every message of a topic.

    Subscribes ``/robot_controller/stop_all`` (``std_msgs/Bool``) and ``topic``
    (``std_msgs/Empty``: a robot was lost). A stop engaged before this node started is ignored.
    """

    def __init__(self, shake, topic):
        self._shake = shake
        self._stopped = True
        ServiceOwner(STOP_SERVICE).start().subscribe('/robot_controller/stop_all', Bool,
                                                     self._on_stop_all, queue_size=10)
        rospy.Subscriber(topic, Empty, self._on_lost, queue_size=1)

    def _on_stop_all(self, message):
        engaged = message.data and not self._stopped
        self._stopped = message.data
        if engaged:
            self._shake()

    def _on_lost(self, _):
        self._shake()
