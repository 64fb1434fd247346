# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The foot pedal's row of ``resource/inputs.yaml``: it drives, or only enables other devices."""
import rospy

from mhri.base.config import ConfigError, shown
from mhri.devices.io.pedal import PedalReader
from mhri.devices.pedals import DRIVE, ENABLE, ROLES
from mhri.devices.ros.device import Device
from mhri.devices.ros.input_node import InputNode
from mhri.devices.ros.pedal_profiles import PedalProfiles
from mhri.srv import SetSuspendedRequest, SetSuspendedResponse


def pedal():
    """Return the :class:`Device`; see :mod:`mhri.nodes.mhri_pedal`.

    :raises ConfigError: ``~role`` is invalid; with a default, a pedal meant to enable could drive
    """
    role = rospy.get_param('~role', DRIVE)
    if role not in ROLES:
        raise ConfigError('~role', '', 'expected {}, got {}'.format(
            ' or '.join(ROLES), shown(role)))
    reader = PedalReader(PedalProfiles(), role)
    return Device(reader, {'~device': reader.choose_device, '~profile': reader.choose_profile},
                  EnablingNode if role == ENABLE else InputNode)


class EnablingNode(InputNode):
    """An :class:`InputNode` that resumes by itself and cannot be suspended.

    The mux suspends every input node except that of the present mode. An enabling pedal must be
    read in all modes: its silence, if suspended, would hold the robots. The node therefore answers
    the request with success, since the mux repeats a refused one, and a message that reading
    continues. To do without the pedal, end the node or change the mux's configuration; no single
    call can do it in a running session.
    """

    def start(self):
        """Start serving, resumed; call it after ``rospy.init_node``."""
        super().start()
        self._on_set_suspended(SetSuspendedRequest(suspended=False))

    def _on_set_suspended(self, request):
        if request.suspended:
            return SetSuspendedResponse(
                True, 'an enabling pedal is read in every mode: ' + self.describe())
        return super()._on_set_suspended(request)
