# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A process that reads a pad for a program that must not block on its driver, e.g. the screen.

A :class:`mhri.devices.io.child.Child` that sends, on change::

    {"kind": "absent", "reason": "..."}
    {"kind": "pad", "name": "...", "guid": "..."}
    {"kind": "state", "axes": [0.1, null], "buttons": [0, 1]}

An axis is null until its value is known. The process ends when the receiver is gone.
"""
from mhri.devices.io.child import parent
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.devices.io.sdl import Joysticks
from mhri.devices.pads import choose_pad

LOOK_S = 0.5
# Minimum period of states [s]: screens draw less often, and buttons are held longer.
STATE_S = 0.02


def _follow(joysticks, send, wait):
    """Read the first pad until it is lost.

    :param wait: function that waits for a time [s]
    :raises DeviceLost: the pad is gone
    :raises DeviceAbsent: the pad cannot be opened
    :raises LookupError: no pad is connected
    """
    info = choose_pad('', joysticks.look(), [])
    pad = joysticks.open(info)
    try:
        send(kind='pad', name=info.name, guid=info.guid)
        while True:
            axes, buttons = pad.state()
            send(kind='state', axes=axes, buttons=buttons)
            wait(STATE_S)
    finally:
        pad.close()


def main():
    """Read pads, one after the other, until the receiver is gone."""
    joysticks, screen = Joysticks(), parent()
    sent = {}

    def send(**line):
        if sent.get(line['kind']) != line:
            if line['kind'] != 'state':
                sent.clear()
            sent[line['kind']] = line
            screen.send(line, wait=True)

    try:
        while True:
            try:
                _follow(joysticks, send, screen.packet)
            except (DeviceLost, DeviceAbsent, LookupError) as reason:
                send(kind='absent', reason=str(reason))
            screen.packet(LOOK_S)
    except (EOFError, OSError):
        pass
