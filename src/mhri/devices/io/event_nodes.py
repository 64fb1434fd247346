# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds the connected input devices without opening any of them.

Any user may read ``/sys/class/input``. So a message can name a device for which permission is
missing, and an operator's keyboard is not opened just to identify it.
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
# BTN_JOYSTICK to BTN_THUMBR (linux/input-event-codes.h): the buttons of pads. Rudder pedals have
# no buttons, but a joydev node.
_PAD_KEYS = 0x120, 0x13f
# A receiver for several pads has an interface of its port for each; most devices have only 0.
_USB_PORT = re.compile(r'usb-.*-([\d.]+)(?:/input(?:0|(\d+)))?$')


@dataclass(frozen=True)
class Switch:
    """A device with keys: one or several event nodes that are plugged in and out together.

    A foot switch appears as a keyboard, often as a mouse as well, since its pedals can be set to
    click; ``paths`` are all of its nodes with keys.
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
        """Return the key shared by all nodes of one device.

        ``phys`` is the port, with the interface after the slash; a node without one (a virtual or
        some Bluetooth device) is a separate device unless it has a serial number.
        """
        return self.usb, self.phys.split('/')[0] or self.uniq or self.path


def find_switches():
    """Return every device with keys, in the order of the kernel's numbers.

    :returns: list of :class:`Switch`; empty if the system has no input devices
    """
    devices = {}
    for node in _nodes():
        devices.setdefault(node.device(), []).append(node)
    # The shortest name is that of the whole device: the others end in "Mouse", "Keyboard" etc.
    return [Switch(members[0].usb, min((node.name for node in members), key=len),
                   tuple(node.path for node in members)) for members in devices.values()]


def find_pads():
    """Return a :class:`mhri.devices.pads.PadInfo` for each joystick, wheel or pad.

    Its GUID is the one that SDL derives from the kernel's data while SDL's own drivers are off.
    """
    folders = [folder for _, folder in _folders()
               if _has_keys(_line(folder, 'capabilities/key'), *_PAD_KEYS)
               or glob.glob(os.path.join(glob.escape(folder), 'js[0-9]*'))]
    return [_pad(index, folder) for index, folder in enumerate(folders)]


def pad_at(path):
    """Return the :class:`mhri.devices.pads.PadInfo` of a file like ``/dev/input/event7``.

    :returns: the same as in :func:`find_pads`, with index 0; None if there is no such device
    """
    folder = os.path.join(SYS_INPUT, os.path.basename(path), 'device')
    return _pad(0, folder) if os.path.isdir(folder) else None


def _pad(index, folder):
    return PadInfo(index, _line(folder, 'name'), _guid(folder), _where(folder))


def _where(folder):
    """Return the port of this computer, else the device's own address or number, else its file."""
    port = _USB_PORT.match(_line(folder, 'phys'))
    if port:
        return 'USB ' + '/'.join(filter(None, port.groups()))
    return _line(folder, 'uniq') or os.path.basename(os.path.dirname(folder))


def _has_keys(words, first, last):
    """Return whether a bit map of the kernel has a key from first to last."""
    size = 8 * struct.calcsize('l')
    bits = sum(int(word, 16) << size * place for place, word in enumerate(reversed(words.split())))
    return bool(bits >> first & (1 << last - first + 1) - 1)


def _guid(folder):
    """Return SDL's GUID: each number in little-endian order; '' for a device without numbers."""
    numbers = [_line(folder, 'id/' + word) for word in ('bustype', 'vendor', 'product', 'version')]
    if not all(re.match('[0-9a-fA-F]{4}$', number) for number in numbers) or numbers[1] == '0000':
        return ''
    return ''.join(number[2:] + number[:2] + '0000' for number in numbers).lower()


def _folders():
    """Return (number, properties) of each event node, in order."""
    try:
        names = os.listdir(SYS_INPUT)
    except OSError:
        # A system or container without any input device.
        return []
    numbers = sorted(int(name[5:]) for name in names if re.match(r'event\d+$', name))
    return [(number, os.path.join(SYS_INPUT, 'event{}'.format(number), 'device'))
            for number in numbers]


def _nodes():
    """Yield a node for each event node with keys."""
    for number, folder in _folders():
        name = 'event{}'.format(number)
        if set(_line(folder, 'capabilities/key')) - set(' 0'):
            yield _Node(os.path.join(DEV_INPUT, name), _usb(folder), _line(folder, 'name'),
                        _line(folder, 'phys'), _line(folder, 'uniq'))


def _usb(folder):
    """Return ``vendor:product``."""
    words = [_line(folder, 'id/' + word).lower() for word in ('vendor', 'product')]
    return ':'.join(words) if all(words) else ''


def _line(folder, name):
    """Return the single line of a kernel file, '' if it is gone or empty."""
    try:
        with open(os.path.join(folder, name), encoding='utf-8', errors='replace') as stream:
            return stream.readline().strip()
    except OSError:
        # Unplugged meanwhile: treat it as absent.
        return ''
