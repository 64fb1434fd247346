# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Foot switches: found, opened, grabbed, given back, lost."""
import os

from evdev import ecodes
import pytest

from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.devices.pedals import load_pedal_profiles

from support.pedal_desk import (
    desk_of, FORWARD, next_of, PORT, PROFILES, REPO, REST, SOON_S)


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """A system with pseudo terminals for event nodes."""
    yield from desk_of(tmp_path, monkeypatch.setattr)


def test_grabbed_while_open(desk):
    """It does not type; closed, it is a keyboard again."""
    node = desk.plug()
    reader = desk.opened()
    assert node.grabbed()
    reader.close()
    assert not node.grabbed()
    reader.close()
    reader.open()
    assert node.grabbed()


def test_all_nodes_of_one_switch(desk):
    """Keyboard and mouse of one device are both grabbed and read; what has no keys is not."""
    desk.plug('PCsensor FootSwitch', phys=PORT.format(1), keys=())
    keyboard = desk.plug()
    mouse = desk.plug('PCsensor FootSwitch Mouse', keys=('BTN_LEFT', 'BTN_RIGHT'))
    reader = desk.reader()
    text = reader.open()
    assert '3553:b001' in text and 'pcsensor' in text
    assert keyboard.grabbed() and mouse.grabbed()
    assert next_of(reader) == REST
    mouse.press('BTN_LEFT')
    keyboard.press('KEY_B')
    assert next_of(reader) == FORWARD


def test_unplugged(desk):
    """Lost at once, also while pressed, and found again."""
    node = desk.plug()
    reader = desk.opened()
    node.press('KEY_B')
    node.pull()
    with pytest.raises(DeviceLost, match='has been unplugged'):
        while True:
            next_of(reader)
    with pytest.raises(DeviceLost):
        reader.read(0.0)
    with pytest.raises(DeviceAbsent, match='no foot pedal'):
        reader.open()
    again = desk.plug()
    reader.open()
    assert next_of(reader) == REST
    again.press('KEY_B')
    assert next_of(reader) == FORWARD


def test_one_of_two_nodes_unplugged(desk):
    """Half a switch is none."""
    desk.plug()
    mouse = desk.plug('PCsensor FootSwitch Mouse', keys=('BTN_LEFT',))
    reader = desk.opened()
    mouse.pull()
    with pytest.raises(DeviceLost):
        reader.read(SOON_S)
    assert not desk.nodes[0].grabbed()


def test_permission_denied(desk):
    """The device is named, and what to do about it."""
    desk.plug().forbid()
    with pytest.raises(DeviceAbsent) as absent:
        desk.reader().open()
    text = str(absent.value)
    assert '3553:b001' in text and '/dev/event5' in text and '70-mhri-pedals.rules' in text
    assert (REPO / 'resource' / 'pedals' / '70-mhri-pedals.rules').is_file()


def test_grabbed_by_another_program(desk):
    """A second reader is turned away, and the first goes on."""
    node = desk.plug()
    first = desk.opened()
    with pytest.raises(DeviceAbsent, match='another program has grabbed it'):
        desk.reader().open()
    node.press('KEY_B')
    assert next_of(first) == FORWARD


CHOICES = {
    'usb': '1234:ABCD', 'usb_lower': '1234:abcd', 'name': 'my pedal', 'path': '{dev}/event6',
    'link': '{dev}/by-id'}


@pytest.mark.parametrize('case', sorted(CHOICES))
def test_chosen_by_the_operator(desk, case):
    """By vendor and product, name, path or a link to it; read as three keys."""
    other = desk.plug()
    mine = desk.plug('Acme My Pedal', '1234:abcd', 'usb-0000:00:14.0-3/input0')
    dev = os.path.join(desk.folder, 'dev')
    os.symlink('event6', os.path.join(dev, 'by-id'))
    assert 'profile three_keys' in desk.reader(CHOICES[case].format(dev=dev)).open()
    assert mine.grabbed() and not other.grabbed()


def test_another_pedal_is_asked_for(desk):
    """The one that is open is given up, and with it whatever it drove."""
    first = desk.plug()
    second = desk.plug('Acme My Pedal', '1234:abcd', 'usb-0000:00:14.0-3/input0')
    reader = desk.opened()
    reader.choose_device('1234:abcd')
    with pytest.raises(DeviceLost, match='another pedal'):
        reader.read(0.0)
    reader.close()
    reader.open()
    assert second.grabbed() and not first.grabbed()
    reader.choose_profile('one_pedal')
    with pytest.raises(DeviceLost):
        reader.read(0.0)


def test_key_that_does_not_exist(desk):
    """A slip in a file is named."""
    text = 'name: mine\nkind: keys\nmatch: {usb: "3553:b001"}\npedals:\n' \
           '  - {name: a, keys: [KEY_NOSUCH], forward: 1.0}\n'
    desk.plug()
    profiles, errors = load_pedal_profiles([('mine.yaml', text)])
    assert not errors
    with pytest.raises(DeviceAbsent, match="no key 'KEY_NOSUCH'"):
        desk.reader(profiles=profiles).open()


def test_every_shipped_key_exists():
    """The kernel's names are known to evdev alone."""
    for profile in PROFILES.values():
        for pedal in profile.pedals:
            assert all(key in ecodes.ecodes for key in pedal.keys), profile.name


def test_nothing_stays_open_after_a_failure(desk):
    """The first node of a switch is given back where the second cannot be opened."""
    first = desk.plug()
    desk.plug('PCsensor FootSwitch Mouse', keys=('BTN_LEFT',)).forbid()
    before = len(os.listdir('/proc/self/fd'))
    reader = desk.reader()
    for _ in range(5):
        with pytest.raises(DeviceAbsent):
            reader.open()
    assert not first.grabbed() and len(os.listdir('/proc/self/fd')) == before
