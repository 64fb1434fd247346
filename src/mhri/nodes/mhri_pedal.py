# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_pedal``: the foot pedal, through :class:`InputNode`.

Publishes ``/mux_in/pedal`` (``sensor_msgs/Joy``; see :mod:`mhri.devices.pedals`), serves
``/mhri_pedal/set_suspended`` (``mhri/SetSuspended``). Parameters:

- ``~device``: ``vendor:product``, path or part of the name of the pedal; '' (default) is the one
  with a profile
- ``~profile``: name of a file in ``$ROS_HOME/mhri/pedals`` or ``resource/pedals``, without its
  ending; '' (default) is the one for the device
- ``~role``: ``drive`` (default), or ``enable``: the pedal only allows the active source to drive,
  see :mod:`mhri.devices.ros.enabling_node`

The first two take effect within two seconds while the node is resumed.
"""
import sys

import rospy

from mhri.base.config import shown
from mhri.devices.io.pedal import PedalReader
from mhri.devices.pedals import DRIVE, ENABLE, ROLES
from mhri.devices.ros.enabling_node import EnablingNode
from mhri.devices.ros.input_node import InputNode
from mhri.devices.ros.pedal_profiles import PedalProfiles
from mhri.graph.ros import log
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.live_parameter import LiveParameter
from mhri.graph.ros.peers import limit_peers


def main():
    """Run until shut down; exit with 1 if the role is invalid."""
    limit_peers()
    init_node('mhri_pedal')
    log.install()
    role = rospy.get_param('~role', DRIVE)
    if role not in ROLES:
        # A guess could make a pedal drive that was meant to stop.
        sys.exit('mhri_pedal cannot start: ~role is {}, expected {}'.format(
            shown(role), ' or '.join(ROLES)))
    reader = PedalReader(PedalProfiles(), role)
    node_class = EnablingNode if role == ENABLE else InputNode
    node = node_class(reader, '/mux_in/pedal', '~set_suspended')
    LiveParameter('~device', '', reader.want_device, node.resumed).start()
    LiveParameter('~profile', '', reader.want_profile, node.resumed).start()
    node.start()
    rospy.spin()
