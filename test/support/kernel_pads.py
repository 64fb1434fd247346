# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pads as the kernel describes them in ``/sys/class/input``, for a node that does not open any."""
import os

# (name, bus, vendor, product, version, keys): what /proc/bus/input/devices says of real ones.
F710 = ('Logitech Gamepad F710', '0003', '046d', 'c21f', '0305', '7cdb000000000000 0 0 0 0')
PS3 = ('Sony PLAYSTATION(R)3 Controller', '0005', '054c', '0268', '8000',
       'f00000000 0 0 0 7fdb000000000000 0 0 0 0')
MOTION = ('Sony PLAYSTATION(R)3 Controller Motion Sensors', '0005', '054c', '0268', '8000', '0')
KEYBOARD = ('AT Translated Set 2 keyboard', '0011', '0001', '0001', 'ab41',
            '402000000 3803078f800d001 feffffdfffefffff fffffffffffffffe')
MOUSE = ('USB Optical Mouse', '0003', '046d', 'c077', '0111', '70000 0 0 0 0')
NAMELESS = ('Home-made stick', '0000', '0000', '0000', '0000', 'ff00000000 0 0 0 0')


def plug(folder, number, device, phys='', uniq=''):
    """Describe a device as ``event<number>``; the folder appears whole.

    :param phys: its port, e.g. 'usb-0000:00:14.0-1.2/input0'
    :param uniq: its own number or address
    """
    name, bus, vendor, product, version, keys = device
    made = os.path.join(str(folder), 'event{}'.format(number))
    for place, text in (('name', name), ('id/bustype', bus), ('id/vendor', vendor),
                        ('id/product', product), ('id/version', version), ('phys', phys),
                        ('uniq', uniq), ('capabilities/key', keys)):
        path = os.path.join(made + '.new', 'device', place)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w', encoding='utf-8') as stream:
            stream.write(text + '\n')
    os.rename(made + '.new', made)
    return made
