# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which device is there is known without opening any."""
from pathlib import Path
import shutil

import pytest

from mhri.devices.io import event_nodes
from mhri.devices.io.pad import PadReader
from mhri.devices.io.pedal import PedalReader
from mhri.devices.io.reader import DeviceAbsent
from mhri.devices.pads import load_profiles, PadInfo
from mhri.devices.pedals import load_pedal_profiles

from support.kernel_pads import F710, KEYBOARD, MOTION, MOUSE, NAMELESS, plug, PS3
from support.paths import REPO

RUDDER = ('Saitek Pro Flight Rudder Pedals', '0003', '06a3', '0763', '0100', '0')


def profiles():
    """Return the shipped profiles of pads."""
    files = sorted((REPO / 'resource' / 'pads').glob('*.yaml'))
    return load_profiles([(str(path), path.read_text()) for path in files])[0]


@pytest.fixture
def system(tmp_path, monkeypatch):
    """A folder that takes the place of /sys/class/input."""
    monkeypatch.setattr(event_nodes, 'SYS_INPUT', str(tmp_path))
    return tmp_path


def test_pads_and_nothing_else(system):
    for number, device in enumerate((KEYBOARD, MOUSE, F710, MOTION, NAMELESS, PS3), 3):
        plug(system, number, device)
    assert event_nodes.find_pads() == [
        PadInfo(0, 'Logitech Gamepad F710', '030000006d0400001fc2000005030000', 'event5'),
        PadInfo(1, 'Home-made stick', '', 'event7'),
        PadInfo(2, 'Sony PLAYSTATION(R)3 Controller', '050000004c0500006802000000800000',
                'event8')]


@pytest.mark.parametrize('phys, uniq, where', [
    ('usb-0000:00:14.0-1.2/input0', 'A1B2', 'USB 1.2'),
    ('usb-0000:00:14.0-3/input4', '', 'USB 3/4'),
    ('usb-3f980000.usb-1.10/input0', '', 'USB 1.10'),
    # By Bluetooth: the port is this computer's own radio.
    ('5c:f3:70:8b:11:02', '00:1b:fb:63:a2:81', '00:1b:fb:63:a2:81'), ('', '', 'event4')])
def test_where_a_pad_is(system, phys, uniq, where):
    plug(system, 4, PS3, phys, uniq)
    assert [pad.where for pad in event_nodes.find_pads()] == [where]
    assert event_nodes.pad_at('/dev/input/event4').where == where
    assert event_nodes.pad_at('/dev/input/event5') is event_nodes.pad_at('') is None


def test_a_pad_reader_names_the_pad_it_would_open(system):
    reader = PadReader(profiles, joysticks=())
    with pytest.raises(DeviceAbsent):
        reader.find()
    plug(system, 4, NAMELESS)
    assert reader.find() == 'Home-made stick'
    plug(system, 5, F710)
    assert reader.find() == 'Logitech Gamepad F710', 'the one that a profile knows'
    reader.choose('home')
    assert reader.find() == 'Home-made stick'
    reader.choose('PS5')
    with pytest.raises(DeviceAbsent, match='PS5'):
        reader.find()


def test_profiles_are_read_anew_only_when_a_pad_came_or_went(system):
    asked = []
    reader = PadReader(lambda: asked.append(1) or profiles(), joysticks=())
    made = plug(system, 4, F710)
    assert {reader.find() for _ in range(5)} == {'Logitech Gamepad F710'} and len(asked) == 1
    shutil.rmtree(made)
    for _ in range(3):
        with pytest.raises(DeviceAbsent):
            reader.find()
    assert len(asked) == 2


def test_a_pedal_reader_names_switches_and_rudder_pedals(system):
    folder = REPO / 'resource' / 'pedals'
    files = sorted(folder.glob('*.yaml'))
    known = load_pedal_profiles([(str(path), path.read_text()) for path in files])[0]
    reader = PedalReader(lambda: known)
    plug(system, 2, KEYBOARD)
    with pytest.raises(DeviceAbsent):
        reader.find()
    made = plug(system, 3, ('PCsensor FootSwitch', '0003', '3553', 'b001', '0110', '7fff 0'))
    assert reader.find() == 'PCsensor FootSwitch'
    shutil.rmtree(made)
    (Path(plug(system, 4, RUDDER)) / 'device' / 'js0').mkdir()
    assert reader.find() == RUDDER[0]
