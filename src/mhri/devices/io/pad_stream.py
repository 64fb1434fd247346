# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A process that reads a pad for a program that must not wait for its driver, e.g. the screen.

It writes a JSON object per line to standard output, on change::

    {"kind": "absent", "reason": "..."}
    {"kind": "pad", "name": "...", "guid": "..."}
    {"kind": "state", "axes": [0.1, null], "buttons": [0, 1]}

An axis is null until its value is known. The process ends when its standard input closes.
"""
import json
import os
import select
import sys

from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.devices.io.sdl import Joysticks
from mhri.devices.pads import choose_pad

LOOK_S = 0.5
# A screen draws no more often than this [s], and a button is held longer.
STATE_S = 0.02


class Ended(Exception):
    """Nobody listens any more."""


def _wait(stdin, seconds):
    """Let time pass.

    :raises Ended: standard input was closed
    """
    if select.select([stdin], [], [], seconds)[0] and not os.read(stdin.fileno(), 4096):
        raise Ended()


def _follow(joysticks, say, wait):
    """Read the first pad until it is lost.

    :raises DeviceLost: it is gone
    :raises DeviceAbsent: it cannot be opened
    :raises LookupError: there is none
    """
    info = choose_pad('', joysticks.look(), [])
    pad = joysticks.open(info)
    try:
        say(kind='pad', name=info.name, guid=info.guid)
        while True:
            axes, buttons = pad.state()
            say(kind='state', axes=axes, buttons=buttons)
            wait(STATE_S)
    finally:
        pad.close()


def main(joysticks=None, stdin=None, stdout=None):
    """Read pads, one after the other, until standard input is closed."""
    joysticks, stdin = joysticks or Joysticks(), stdin or sys.stdin
    said = {}

    def say(**line):
        if said.get(line['kind']) != line:
            if line['kind'] != 'state':
                said.clear()
            said[line['kind']] = line
            print(json.dumps(line), file=stdout or sys.stdout, flush=True)

    try:
        while True:
            try:
                _follow(joysticks, say, lambda seconds: _wait(stdin, seconds))
            except (DeviceLost, DeviceAbsent, LookupError) as reason:
                say(kind='absent', reason=str(reason))
            _wait(stdin, LOOK_S)
    except (Ended, BrokenPipeError):
        pass
