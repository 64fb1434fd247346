# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_joy``: the pad, through :class:`mhri.ros.devices.input_node.InputNode`.

Publishes ``/mux_in/ps3joy`` (``sensor_msgs/Joy``), serves ``/mhri_joy/set_suspended``
(``mhri/SetSuspended``), shakes the pad at a rising ``/robot_controller/stop_all``
(``std_msgs/Bool``) and at ``/mhri_joy/rumble`` (``std_msgs/Empty``). Parameter ``~device`` (a part
of the pad's name, its GUID or its index; '' is any pad) takes effect within a second while the node
is resumed.

``mhri_joy --calibrate`` writes a profile for the connected pad instead: see
:mod:`mhri.inputs.pad_calibration`.
"""
import sys

import rospy

from mhri.inputs.pad import PadReader
from mhri.ros.devices.input_node import InputNode
from mhri.ros.graph import log
from mhri.ros.graph.peers import limit_peers
from mhri.ros.graph.live_parameter import LiveParameter
from mhri.ros.devices.pad_profiles import own_folder, pad_profiles, shipped_names
from mhri.ros.devices.rumble import Rumble
from mhri.ros.ending import init_node


def main():
    """Run until shut down, or calibrate and exit."""
    argv = rospy.myargv(sys.argv)[1:]
    if '--calibrate' in argv:
        from mhri.inputs.pad_calibration import calibrate
        sys.exit(calibrate(argv, own_folder(), shipped_names()))
    limit_peers()
    init_node('mhri_joy')
    log.install()
    reader = PadReader(pad_profiles)
    node = InputNode(reader, '/mux_in/ps3joy', '~set_suspended')
    Rumble(reader.rumble, '~rumble')
    LiveParameter('~device', '', reader.want, node.resumed).start()
    node.start()
    rospy.spin()
