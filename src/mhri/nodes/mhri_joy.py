# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_joy``: the pad, through :class:`mhri.devices.ros.input_node.InputNode`.

Publishes ``/mux_in/ps3joy`` (``sensor_msgs/Joy``), serves ``/mhri_joy/set_suspended``
(``mhri/SetSuspended``), shakes the pad at a rising ``/robot_controller/stop_all``
(``std_msgs/Bool``) and at ``/mhri_joy/rumble`` (``std_msgs/Empty``). Parameter ``~device`` (a part
of the pad's name, its GUID or its index; '' is any pad) takes effect within a second while the node
is resumed.
"""
from mhri.devices.ros.device import run


def main():
    """Run until shut down."""
    run('joy')
