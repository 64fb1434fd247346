# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_joy``: the pad, through :class:`mhri.devices.ros.input_node.InputNode`.

Publishes ``/mux_in/ps3joy`` (``sensor_msgs/Joy``), serves ``/mhri_joy/set_suspended``
(``mhri/SetSuspended``), shakes the pad at a rising ``/robot_controller/stop_all``
(``std_msgs/Bool``) and at ``/mhri_joy/rumble`` (``std_msgs/Empty``). Parameter ``~device`` (a part
of the pad's name, its GUID or its index; '' is any pad) takes effect within a second while the node
is resumed.

``mhri_joy --calibrate`` writes a profile for the connected pad instead: see
:mod:`mhri.devices.io.pad_calibration`.
"""
import sys

import rospy

from mhri.devices.io.pad import PadReader
from mhri.devices.ros.input_node import InputNode
from mhri.devices.ros.pad_profiles import own_folder, pad_profiles, shipped_names
from mhri.devices.ros.rumble import Rumble
from mhri.graph.ros import log
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.live_parameter import LiveParameter
from mhri.graph.ros.peers import limit_peers


def main():
    """Run until shut down, or calibrate and exit."""
    argv = rospy.myargv(sys.argv)[1:]
    if '--calibrate' in argv:
        from mhri.devices.io.pad_calibration import calibrate
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
