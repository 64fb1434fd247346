# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A system of a test's own with foot switches plugged in, and readers opened on it."""
import glob
from pathlib import Path
import time

from mhri.devices.io.pedal import PedalReader
from mhri.devices.io.pedal_keys import PedalKeys
from mhri.devices.io.reader import Reading
from mhri.devices.pedals import DRIVE, KEYS, load_pedal_profiles
from support.evdev_stream import install, make_folders, StreamNode

REPO = Path(__file__).resolve().parents[2]
FILES = sorted(glob.glob(str(REPO / 'resource' / 'pedals' / '*.yaml')))
PROFILES = load_pedal_profiles([(path, Path(path).read_text()) for path in FILES])[0]
LETTERS = ('KEY_A', 'KEY_B', 'KEY_C')
PORT = 'usb-0000:00:14.0-2/input{}'
# Generous: nothing here waits so long unless something is wrong.
SOON_S = 5.0

REST = Reading((0.0, 0.0), (0, 0, 0, 0))
FORWARD = Reading((0.0, 1.0), (1, 0, 1, 0))
LEFT = Reading((1.0, 0.0), (0, 1, 0, 0))
RIGHT = Reading((-1.0, 0.0), (0, 0, 0, 1))


class Desk:
    """Devices plugged into a system of the test's own, and the readers opened on it."""

    def __init__(self, folder):
        self.folder = make_folders(str(folder))
        self.nodes = []
        self.readers = []

    def plug(self, name='PCsensor FootSwitch Keyboard', usb='3553:b001', phys=PORT.format(0),
             keys=LETTERS):
        """Plug in one event node."""
        self.nodes.append(StreamNode(self.folder, len(self.nodes) + 5, name, usb, phys, keys))
        return self.nodes[-1]

    def reader(self, device='', profile='', role=DRIVE, profiles=PROFILES):
        """Return a reader, not opened yet."""
        reader = PedalReader(lambda: profiles, role, {KEYS: PedalKeys(role)})
        reader.choose_device(device)
        reader.choose_profile(profile)
        self.readers.append(reader)
        return reader

    def opened(self, *args, **options):
        """Return an open reader that has said its first word."""
        reader = self.reader(*args, **options)
        reader.open()
        assert next_of(reader) == REST
        return reader

    def close(self):
        """Unplug everything."""
        for reader in self.readers:
            reader.close()
        for node in self.nodes:
            node.pull()


def desk_of(folder, put):
    """Yield a :class:`Desk` in a folder, for a fixture.

    :param put: function like ``setattr`` that is undone after the test
    """
    install(str(folder), put)
    found = Desk(folder)
    yield found
    found.close()


def next_of(reader, patience_s=SOON_S):
    """Return the next reading."""
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline:
        reading = reader.read(0.05)
        if reading is not None:
            return reading
    raise AssertionError('nothing was read in {} s'.format(patience_s))


def all_until(reader, last, patience_s=SOON_S):
    """Return the readings up to one that is waited for."""
    found = []
    while not found or found[-1] != last:
        found.append(next_of(reader, patience_s))
    return found
