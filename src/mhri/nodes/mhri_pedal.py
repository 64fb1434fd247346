# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_pedal``: the foot pedal, through :class:`InputNode`.

Publishes ``/mux_in/pedal`` (``sensor_msgs/Joy``; see :mod:`mhri.devices.pedals`), serves
``/mhri_pedal/set_suspended`` (``mhri/SetSuspended``). Parameters:

- ``~device``: ``vendor:product``, path or part of the name of the pedal; '' (default) is the one
  with a profile
- ``~profile``: name of a file in ``$ROS_HOME/mhri/pedals`` or ``resource/pedals``, without its
  ending; '' (default) is the one for the device
- ``~role``: ``drive`` (default), or ``enable``: the pedal only enables the active source,
  see :class:`mhri.devices.ros.pedal.EnablingNode`

The first two take effect within two seconds while the node is resumed.
"""
from mhri.devices.ros.device import run


def main():
    """Run until shut down; exit with 1 if the role is invalid."""
    run('pedal')
