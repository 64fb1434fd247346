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

from mhri.devices.ros.device import run
from mhri.devices.ros.pad_profiles import own_folder, shipped_names


def main():
    """Run until shut down, or calibrate and exit."""
    argv = rospy.myargv(sys.argv)[1:]
    if '--calibrate' in argv:
        from mhri.devices.io.pad_calibration import calibrate
        sys.exit(calibrate(argv, own_folder(), shipped_names()))
    run('joy')
