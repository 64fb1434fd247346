# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which input devices are there, without opening any of them.

What the kernel says in ``/sys/class/input`` everybody may read. So a device that may not be opened
is still named in the message that says so, and an operator's keyboard is not opened just to look.
"""
from dataclasses import dataclass
import os
import re
from typing import Tuple

SYS_INPUT = '/sys/class/input'
DEV_INPUT = '/dev/input'


@dataclass(frozen=True)
class Switch:
    """A device with keys: one or several event nodes that are plugged in and out together.

    A foot switch shows a keyboard, often a mouse as well, since its pedals can be set to click;
    ``paths`` are all of its nodes that have keys.
    """

    usb: str
    name: str
    paths: Tuple[str, ...]


@dataclass(frozen=True)
class _Node:
    """One event node as the kernel describes it."""

    path: str
    usb: str
    name: str
    phys: str
    uniq: str

    def device(self):
        """Return what all nodes of one device have in common.

        ``phys`` is the port, with the interface behind the slash; what has none (a virtual or some
        Bluetooth device) is a device of its own unless it has a serial number.
        """
        return self.usb, self.phys.split('/')[0] or self.uniq or self.path


def find_switches(sys_input=None, dev_input=None):
    """Return every device with keys, in the order in which the kernel numbered them.

    :returns: list of :class:`Switch`; empty where the system shows no input devices
    """
    nodes = [node for node in _nodes(sys_input or SYS_INPUT, dev_input or DEV_INPUT) if node]
    devices = {}
    for node in nodes:
        devices.setdefault(node.device(), []).append(node)
    # The shortest name is that of the whole device: the others say "... Mouse", "... Keyboard".
    return [Switch(members[0].usb, min((node.name for node in members), key=len),
                   tuple(node.path for node in members)) for members in devices.values()]


def _nodes(sys_input, dev_input):
    """Yield a node for each event node with keys."""
    try:
        names = os.listdir(sys_input)
    except OSError:
        # No such folder: a system or container without any input device.
        return
    numbers = sorted(int(name[5:]) for name in names if re.match(r'event\d+$', name))
    for number in numbers:
        name = 'event{}'.format(number)
        folder = os.path.join(sys_input, name, 'device')
        if set(_line(folder, 'capabilities/key')) - set(' 0'):
            yield _Node(os.path.join(dev_input, name), _usb(folder), _line(folder, 'name'),
                        _line(folder, 'phys'), _line(folder, 'uniq'))


def _usb(folder):
    """Return ``vendor:product``."""
    words = [_line(folder, 'id/' + word).lower() for word in ('vendor', 'product')]
    return ':'.join(words) if all(words) else ''


def _line(folder, name):
    """Return the one line of a file of the kernel, '' where it has gone or says nothing."""
    try:
        with open(os.path.join(folder, name), encoding='utf-8', errors='replace') as stream:
            return stream.readline().strip()
    except OSError:
        # Unplugged while it was looked at: it is not there, which is what the others say of it.
        return ''
