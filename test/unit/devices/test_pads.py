# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which pad, which profile, and that the shipped profiles are what their comments say."""
from pathlib import Path
import re

import pytest

from mhri.devices.pads import (
    choose_pad, choose_profile, load_profiles, PadInfo, same_guid, with_labels)
from mhri.devices.profile import ANY, JoyRefused

PADS = Path(__file__).resolve().parents[3] / 'resource' / 'pads'
FILES = [(str(path), path.read_text(encoding='utf-8')) for path in sorted(PADS.glob('*.yaml'))]
PROFILES, ERRORS = load_profiles(FILES)
BY_NAME = {profile.name: profile for profile in PROFILES}
MINIMAL = 'name: {}\nforward: {{axis: 1}}\nturn: {{axis: 0}}\n'


def test_every_shipped_profile_is_good():
    assert ERRORS == []
    assert {'ps3', 'ps3_old', 'ps4', 'ps5', 'xbox', 'xbox_bluetooth', 'f710', 'f710_d', 'sony_hid',
            'generic'} <= set(BY_NAME)


def test_no_guid_and_no_name_stands_in_two_profiles():
    guids = [same_guid(guid) for profile in PROFILES for guid in profile.match.guids]
    names = [name.lower() for profile in PROFILES for name in profile.match.names]
    assert len(guids) == len(set(guids))
    assert len(names) == len(set(names))


# What the kernel's drivers call their pads, with the GUIDs of SDL (USB is bus 3, Bluetooth 5).
@pytest.mark.parametrize('name, guid, profile', [
    ('Sony PLAYSTATION(R)3 Controller', '030000004c0500006802000011810000', 'ps3'),
    ('Sony PLAYSTATION(R)3 Controller', '0300dead4c0500006802000011810000', 'ps3'),  # check sum
    ('Sony PLAYSTATION(R)3 Controller', '030000004C0500006802000011810000', 'ps3'),
    ('PLAYSTATION(R)3 Controller', '050000004c0500006802000000810000', 'ps3'),
    ('Sony PLAYSTATION(R)3 Controller', '030000004c0500006802000011010000', 'ps3_old'),
    ('PLAYSTATION(R)3 Controller (00:1B:FB)', '060000004c0500006802000000010000', 'ps3_old'),
    ('Sony PLAYSTATION(R)3 Controller', '', 'ps3'),  # pygame 1.9.6 has no GUIDs
    ('SHENGHIC 2009/0708ZXW-V1Inc. PLAYSTATION(R)3Conteroller', '', 'ps3'),
    ('Wireless Controller', '050000004c050000cc09000000810000', 'ps4'),
    ('Wireless Controller', '', 'ps4'),
    ('Sony Interactive Entertainment Wireless Controller',
     '030000004c050000cc09000011010000', 'sony_hid'),
    ('DualSense Wireless Controller', '', 'ps5'),
    ('Sony Interactive Entertainment DualSense Wireless Controller', '', 'ps5'),
    ('Wireless Controller', '050000004c050000e60c000000810000', 'ps5'),
    ('Microsoft X-Box 360 pad', '030000005e0400008e02000010010000', 'xbox'),
    ('Microsoft X-Box One S pad', '', 'xbox'),
    ('Xbox Wireless Controller', '', 'xbox_bluetooth'),
    ('Logitech Gamepad F710', '', 'f710'),
    ('Logitech Gamepad F710', '030000006d0400001fc2000005030000', 'f710'),
    ('Logitech Logitech Cordless RumblePad 2', '', 'f710_d'),
    ('Thrustmaster T.16000M', '03000000f51b00006412000000010000', 'generic'),
    ('', '', 'generic'),
    # Clones: an Xbox layout, unknown ones, and a name that says the wrong maker.
    ('8BitDo Ultimate 2C Wireless Controller', '03000000c82d00000a31000014010000', 'generic'),
    ('SHENGHIC 2009/0708ZXW-V1Inc. PLAYSTATION(R)3Conteroller',
     '03000000100800000100000010010000', 'generic'),
    ('Wireless Controller', '05000000c82d00000160000000010000', 'generic'),
    ('Xbox Wireless Controller', '050000005e040000200b000017050000', 'generic'),
    ('DualSense Wireless Controller', '030000004c0500000100000000010000', 'generic'),
    # A virtual pad has no product.
    ('DualSense Wireless Controller', 'ff00000009120000000000000000' + '7600', 'ps5'),
    # Of the maker, by another bus or in another version.
    ('Wireless Controller', '060000004c050000c405000007770000', 'ps4'),
    ('Microsoft X-Box One S pad', '030000005e040000ea02000008040000', 'xbox'),
])
def test_profile_of_a_pad(name, guid, profile):
    found, note = choose_profile(PROFILES, name, guid)
    assert found.name == profile
    assert bool(note) == (profile == 'generic')


@pytest.mark.parametrize('name', sorted(set(BY_NAME) - {'virtual'}))
def test_left_stick_drives_forward_and_left(name):
    profile = BY_NAME[name]
    axes = [0.0] * 6
    axes[profile.forward.index] = -1.0  # every kernel driver: forward is less
    assert profile.read(axes, [1] * 17).forward == 1.0
    axes = [0.0] * 6
    axes[profile.turn.index] = -1.0  # left is less
    assert profile.read(axes, [1] * 17).turn == 1.0


def test_buttons_are_those_that_the_comment_of_the_file_names():
    for path, text in FILES:
        name = Path(path).stem
        drawn = dict(re.findall(r'\b(\d+) ([A-Za-z]\w*)', text))
        for key, number, label in re.findall(
                r'^(\w+)_button: +(\d+) +# (\w+)(?:, held)?$', text, re.M):
            assert drawn.get(number) == label, '{}: {}'.format(path, key)
        actions = {action for _, action in BY_NAME[name].actions}
        assert actions == (set() if name in ('generic', 'virtual') else {
            'stop_all', 'next_robot', 'previous_robot', 'select_all', 'mark'}), name


@pytest.mark.parametrize('profile', PROFILES, ids=lambda profile: profile.name)
def test_a_pad_that_counts_as_let_go_moves_nothing(profile):
    """Wherever it rests, with its dead-man button held; full travel drives."""
    for travel in [number / 1000.0 for number in range(0, 400)] + [1.0]:
        axes, buttons = [0.0] * 8, [1] * 17
        axes[profile.forward.index] = travel
        stick = profile.read(axes, buttons)
        assert not stick.neutral or stick.is_zero(), travel
    assert not stick.is_zero()


PAD_PROFILES = [profile for profile in PROFILES if profile.name != 'virtual']


@pytest.mark.parametrize('profile', PAD_PROFILES, ids=lambda profile: profile.name)
def test_every_pad_has_a_dead_man_button_with_no_other_meaning(profile):
    assert profile.dead_man is not None
    assert profile.dead_man not in [button for button, _ in profile.actions]
    axes, buttons = [0.0] * 6, [0] * 17
    axes[profile.forward.index] = -1.0
    assert profile.read(axes, buttons).is_zero()
    buttons[9 if profile.dead_man == ANY else profile.dead_man] = 1
    assert profile.read(axes, buttons).forward == 1.0


def test_a_pad_that_nobody_knows_drives_with_any_button_and_never_without_one():
    generic = BY_NAME['generic']
    for number in range(3):
        buttons = [int(number == index) for index in range(3)]
        assert generic.read((0.0, -1.0), buttons).forward == 1.0
    assert generic.read((0.0, -1.0), (0, 0, 0)).is_zero()
    with pytest.raises(JoyRefused, match='dead-man'):
        generic.read((0.0, -1.0), ())
    assert generic.without_dead_man().read((0.0, -1.0), ()).forward == 1.0


def test_a_bad_file_does_not_hide_the_good_ones():
    profiles, errors = load_profiles([
        ('a.yaml', MINIMAL.format('a')), ('b.yaml', MINIMAL.format('c')),
        ('d.yaml', 'name: ['), ('e.yaml', MINIMAL.format('e') + 'wheel: 1\n')])
    assert [profile.name for profile in profiles] == ['a']
    assert [str(error).split(':')[0] for error in errors] == ['b.yaml', 'd.yaml', 'e.yaml']
    assert "expected 'b'" in str(errors[0])


def test_a_profile_that_names_no_device_counts_by_its_name():
    own, _ = load_profiles([('mine.yaml', MINIMAL.format('mine')
                             + 'match: {names: ["8BitDo Ultimate 2C"]}\n')])
    assert choose_profile(own + PROFILES, '8BitDo Ultimate 2C Wireless Controller',
                          '03000000c82d00000a31000014010000')[0].name == 'mine'


def test_own_profile_before_a_shipped_one_for_the_same_guid():
    guid = '030000004c0500006802000011810000'
    own, _ = load_profiles([('mine.yaml', MINIMAL.format('mine')
                             + 'match: {guids: ["' + guid + '"]}\n')])
    assert choose_profile(own + PROFILES, 'Sony PLAYSTATION(R)3 Controller', guid)[0].name == 'mine'


LIST = [PadInfo(0, 'ThinkPad tablet stick', '03000000aa'.ljust(32, '0')),
        PadInfo(1, 'Sony PLAYSTATION(R)3 Controller Motion Sensors'),
        PadInfo(2, 'Sony PLAYSTATION(R)3 Controller', '0300dead4c0500006802000011810000'),
        PadInfo(3, 'Logitech Gamepad F710')]


@pytest.mark.parametrize('wanted, index', [
    ('', 2), (' ', 2), ('playstation', 2), ('F710', 3), ('0', 0), (0, 0), ('3', 3), (3, 3),
    ('030000004c0500006802000011810000', 2), ('0300beef4C0500006802000011810000', 2),
    ('stick', 0)])
def test_the_pad_that_is_wanted(wanted, index):
    assert choose_pad(wanted, LIST, PROFILES).index == index


@pytest.mark.parametrize('wanted, pads, said', [
    ('', [], 'plug one in'), ('x', LIST[1:2], 'none is connected'),
    ('wii', LIST, "'wii' is not connected: plug it in, or choose another pad; connected: 0: "
     'ThinkPad tablet stick, 2: Sony'), ('7', LIST, "'7' is not connected"),
    ('1', LIST, "'1' is not connected"),
    ('030000004c0500006802000011810001', LIST, "01' is not connected")])
def test_a_pad_that_is_not_there(wanted, pads, said):
    with pytest.raises(LookupError, match=re.escape(said)):
        choose_pad(wanted, pads, PROFILES)


def test_a_name_that_is_part_of_another():
    pads = [PadInfo(0, 'PS3 Pad'), PadInfo(1, 'Pad')]
    assert choose_pad('Pad', pads, PROFILES).index == 1
    assert choose_pad('pad', pads, PROFILES).index == 0


TWINS = [PadInfo(0, 'Pad', where='USB 1.2'), PadInfo(1, 'Stick', where='USB 2'),
         PadInfo(2, 'Pad', where='USB 1.10'), PadInfo(3, 'Pad', where='USB 1.10')]


def test_pads_of_one_name_are_called_by_their_place():
    assert [pad.label for pad in with_labels(TWINS)] == [
        'Pad, USB 1.2', 'Stick', 'Pad, USB 1.10', 'Pad, USB 1.10 (2)']
    assert [pad.label for pad in with_labels([PadInfo(0, 'A'), PadInfo(1, 'A')])] == ['A', 'A (2)']


@pytest.mark.parametrize('wanted, index', [
    ('', 0), ('pad', 0), ('Pad, USB 1.2', 0), ('Pad, USB 1.10', 2), ('pad, usb 1.10', 2),
    ('Pad, USB 1.10 (2)', 3)])
def test_one_of_several_pads_of_one_name(wanted, index):
    assert choose_pad(wanted, TWINS, PROFILES).index == index


def test_the_pad_that_was_chosen_is_the_same_while_its_twin_comes_and_goes():
    assert choose_pad('Pad, USB 1.10', TWINS[2:3], PROFILES).label == 'Pad'
    with pytest.raises(LookupError, match="'Pad, USB 1.10' is not connected.*connected: 0: Pad$"):
        choose_pad('Pad, USB 1.10', TWINS[:1], PROFILES)
