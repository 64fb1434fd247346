# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds the connected input devices without opening any of them.

Everybody may read ``/sys/class/input``. So a message can name a device that may not be opened, and
nobody opens an operator's keyboard just to look.
"""
from dataclasses import dataclass
import glob
import os
import re
import struct
from typing import Tuple

from mhri.devices.pads import PadInfo

SYS_INPUT = '/sys/class/input'
DEV_INPUT = '/dev/input'
# BTN_JOYSTICK to BTN_THUMBR (linux/input-event-codes.h): what pads have. Rudder pedals have none,
# but a node of joydev.
_PAD_KEYS = 0x120, 0x13f
# The receiver of several pads shows each as another interface of its port; most have just 0.
_USB_PORT = re.compile(r'usb-.*-([\d.]+)(?:/input(?:0|(\d+)))?$')


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
    """One event node, as described by the kernel."""

    path: str
    usb: str
    name: str
    phys: str
    uniq: str

    def device(self):
        """Return what all nodes of one device have in common.

        ``phys`` is the port, with the interface behind the slash; a node without one (a virtual or
        some Bluetooth device) is a device of its own unless it has a serial number.
        """
        return self.usb, self.phys.split('/')[0] or self.uniq or self.path


def find_switches(sys_input=None, dev_input=None):
    """Return every device with keys, in the order in which the kernel numbered them.

    :returns: list of :class:`Switch`; empty if the system shows no input devices
    """
    nodes = [node for node in _nodes(sys_input or SYS_INPUT, dev_input or DEV_INPUT) if node]
    devices = {}
    for node in nodes:
        devices.setdefault(node.device(), []).append(node)
    # The shortest name is that of the whole device: the others say "... Mouse", "... Keyboard".
    return [Switch(members[0].usb, min((node.name for node in members), key=len),
                   tuple(node.path for node in members)) for members in devices.values()]


def find_pads(sys_input=None):
    """Return a :class:`mhri.devices.pads.PadInfo` for each joystick, wheel or pad.

    Its GUID is the one SDL derives from the kernel's data when SDL's own drivers are off.
    """
    folders = [folder for _, folder in _folders(sys_input or SYS_INPUT)
               if _has_keys(_line(folder, 'capabilities/key'), *_PAD_KEYS)
               or glob.glob(os.path.join(glob.escape(folder), 'js[0-9]*'))]
    return [PadInfo(index, _line(folder, 'name'), _guid(folder), _where(folder))
            for index, folder in enumerate(folders)]


def where_is(path, sys_input=None):
    """Return where the device with a file like ``/dev/input/event7`` is plugged in.

    :returns: the same as ``where`` of :func:`find_pads`; '' if the system shows no such device
    """
    folder = os.path.join(sys_input or SYS_INPUT, os.path.basename(path), 'device')
    return _where(folder) if os.path.isdir(folder) else ''


def _where(folder):
    """Return the port at this computer, else the device's own address or number, else its file."""
    port = _USB_PORT.match(_line(folder, 'phys'))
    if port:
        return 'USB ' + '/'.join(filter(None, port.groups()))
    return _line(folder, 'uniq') or os.path.basename(os.path.dirname(folder))


def _has_keys(words, first, last):
    """Tell whether a bit map of the kernel has a key from first to last."""
    size = 8 * struct.calcsize('l')
    bits = sum(int(word, 16) << size * place for place, word in enumerate(reversed(words.split())))
    return bool(bits >> first & (1 << last - first + 1) - 1)


def _guid(folder):
    """Return SDL's GUID: each number with its lower byte first; '' for a device without numbers."""
    numbers = [_line(folder, 'id/' + word) for word in ('bustype', 'vendor', 'product', 'version')]
    if not all(re.match('[0-9a-fA-F]{4}$', number) for number in numbers) or numbers[1] == '0000':
        return ''
    return ''.join(number[2:] + number[:2] + '0000' for number in numbers).lower()


def _folders(sys_input):
    """Return (number, what the kernel says) of each event node, in order."""
    try:
        names = os.listdir(sys_input)
    except OSError:
        # No such folder: a system or container without any input device.
        return []
    numbers = sorted(int(name[5:]) for name in names if re.match(r'event\d+$', name))
    return [(number, os.path.join(sys_input, 'event{}'.format(number), 'device'))
            for number in numbers]


def _nodes(sys_input, dev_input):
    """Yield a node for each event node with keys."""
    for number, folder in _folders(sys_input):
        name = 'event{}'.format(number)
        if set(_line(folder, 'capabilities/key')) - set(' 0'):
            yield _Node(os.path.join(dev_input, name), _usb(folder), _line(folder, 'name'),
                        _line(folder, 'phys'), _line(folder, 'uniq'))


def _usb(folder):
    """Return ``vendor:product``."""
    words = [_line(folder, 'id/' + word).lower() for word in ('vendor', 'product')]
    return ':'.join(words) if all(words) else ''


def _line(folder, name):
    """Return the one line of a file of the kernel, '' if it has gone or says nothing."""
    try:
        with open(os.path.join(folder, name), encoding='utf-8', errors='replace') as stream:
            return stream.readline().strip()
    except OSError:
        # Unplugged while it was looked at: it is not there, which is what the others say of it.
        return ''
