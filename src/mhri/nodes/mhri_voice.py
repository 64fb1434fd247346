# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_voice``: spoken commands, through :class:`InputNode`.

Publishes ``/mux_in/voice`` (``sensor_msgs/Joy``: axes[0] left, axes[1] forward, fractions of the
speed limit), serves ``/mhri_voice/set_suspended`` (``mhri/SetSuspended``); for the other interfaces
see :mod:`mhri.voice.ros.voice`. Parameters:

- ``~source``: source of sound: '' (default) the default microphone, ``microphone:<part of its
  name>``, ``<path>.wav``, the path of a FIFO with raw sound (16 kHz, mono, 16 bit little endian),
  or ``-``, the same from the standard input; takes effect within two seconds
- ``~voice``: the operator, by the name given to ``mhri_voice_teach``; '' (default) for any voice;
  takes effect within two seconds
- ``~language``: a file below ``resource/voice`` without its ending, or a path (default: english)
"""
from mhri.devices.ros.device import run


def main():
    """Run until shut down; exit with 1 if the language's file cannot be used."""
    run('voice')
