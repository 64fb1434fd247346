# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pedals: files into profiles, and every state of the feet into axes and buttons."""
import glob
import itertools
from pathlib import Path
import re

import pytest

from mhri.base.config import ConfigError
from mhri.devices.pads import usb_of_guid
from mhri.devices.pedal_choice import Candidate, choose, NoPedal, PedalRequest
from mhri.devices.pedals import (
    AXES, DRIVE, ENABLE, KEYS, load_pedal_profiles, parse_pedal_profile, PedalState)
from mhri.driving.pad_accessories import PadAccessories, Use

FOLDER = Path(__file__).resolve().parents[3] / 'resource' / 'pedals'
FILES = [(path, Path(path).read_text()) for path in sorted(glob.glob(str(FOLDER / '*.yaml')))]
PROFILES, ERRORS = load_pedal_profiles(FILES)
FORWARD = 1
THREE = ('pcsensor', 'usbsw', 'vec', 'three_keys')


def armed(profile, role=DRIVE):
    """Return a state whose pedals have all been seen released."""
    state = PedalState(profile, role)
    axes, buttons = state.read((0.0,) * len(profile.pedals))
    assert axes == (0.0, 0.0) and not any(buttons)
    return state


def test_every_shipped_file_is_a_profile():
    """Named like its file, each device known to one automatic profile alone."""
    assert ERRORS == []
    assert sorted(PROFILES) == [Path(path).stem for path, _ in FILES]
    ids = [usb for profile in PROFILES.values() if profile.automatic for usb in profile.usb]
    assert len(ids) == len(set(ids))
    wanted = {'3553:b001', '0c45:7403', '0c45:7404', '5131:2019', '06a3:0763', '068e:00f2'}
    assert wanted <= set(ids)


def test_the_udev_rules_are_for_the_switches_of_the_profiles():
    """A device that is added to a profile gets its rule as well."""
    rules = (FOLDER / '70-mhri-pedals.rules').read_text()
    found = {':'.join(pair) for pair in re.findall(
        r'idVendor}=="(\w{4})", ATTRS{idProduct}=="(\w{4})", TAG\+="uaccess"', rules)}
    assert found == {usb for profile in PROFILES.values() if profile.kind == KEYS
                     for usb in profile.usb}


# What each combination of left, forward, right does: (left, forward) of the Joy.
THREE_PEDALS = {
    (0, 0, 0): (0.0, 0.0), (1, 0, 0): (1.0, 0.0), (0, 1, 0): (0.0, 1.0), (0, 0, 1): (-1.0, 0.0),
    (1, 1, 0): (1.0, 1.0), (0, 1, 1): (-1.0, 1.0), (1, 0, 1): (0.0, 0.0), (1, 1, 1): (0.0, 1.0)}


@pytest.mark.parametrize('name', THREE)
@pytest.mark.parametrize('feet', sorted(THREE_PEDALS))
def test_three_pedals(name, feet):
    """Every state, by the first key of each pedal, reached from rest; enabling, none drives."""
    profile = PROFILES[name]
    held = {pedal.keys[0] for pedal, down in zip(profile.pedals, feet) if down}
    axes, buttons = armed(profile).read(profile.from_keys(held))
    assert axes == THREE_PEDALS[feet]
    assert buttons == (feet[FORWARD],) + feet
    assert armed(profile, ENABLE).read(profile.from_keys(held)) == ((0.0, 0.0), buttons)


@pytest.mark.parametrize('name', sorted(name for name in PROFILES if PROFILES[name].kind == KEYS))
def test_every_key_presses_its_own_pedal(name):
    """And a key that is not of the profile none."""
    profile = PROFILES[name]
    assert profile.from_keys({'KEY_Z'}) == (0.0,) * len(profile.pedals)
    for number, pedal in enumerate(profile.pedals):
        for key in pedal.keys:
            values = profile.from_keys({key, 'KEY_Z'})
            assert [place for place, value in enumerate(values) if value] == [number]


@pytest.mark.parametrize('name', sorted(PROFILES))
@pytest.mark.parametrize('role', [DRIVE, ENABLE])
def test_axes_stay_in_range_whatever_happens(name, role):
    """Every order of every state of up to three pedals: bounded, and rest is always rest."""
    profile = PROFILES[name]
    states = list(itertools.product((0.0, 0.5, 1.0), repeat=len(profile.pedals)))
    state = armed(profile, role)
    for before, after in itertools.product(states, repeat=2):
        for values in (before, after):
            axes, buttons = state.read(values)
            assert all(-1.0 <= value <= 1.0 for value in axes)
            assert len(buttons) == len(values) + 1 and set(buttons) <= {0, 1}
            assert role == DRIVE or axes == (0.0, 0.0)
        axes, buttons = state.read((0.0,) * len(values))
        assert axes == (0.0, 0.0) and not any(buttons)


# Steps of (direction pedal, driving pedal), and forward after each of them.
ONE_PEDAL = {
    'reversed_while_driving': [((0, 1), 1.0), ((1, 1), 0.0), ((1, 1), 0.0), ((1, 0), 0.0),
                               ((1, 1), -1.0)],
    'let_go_while_backing': [((1, 1), -1.0), ((0, 1), 0.0), ((0, 1), 0.0), ((0, 0), 0.0),
                             ((0, 1), 1.0)],
    'there_and_back_is_held': [((0, 1), 1.0), ((1, 1), 0.0), ((0, 1), 0.0), ((0, 0), 0.0)]}


@pytest.mark.parametrize('case', sorted(ONE_PEDAL))
def test_one_pedal_with_direction(case):
    """The direction is taken as the driving pedal goes down; changed under it, nothing moves."""
    state = armed(PROFILES['one_pedal'])
    for feet, forward in ONE_PEDAL[case]:
        axes, buttons = state.read(tuple(map(float, feet)))
        assert axes == (0.0, forward), feet
        assert buttons == (feet[1],) + feet


@pytest.mark.parametrize('before', ['rest', 'ahead', 'back', 'hold'])
@pytest.mark.parametrize('driving', [False, True])
@pytest.mark.parametrize('reverse', [False, True])
def test_every_state_and_event_of_the_direction(before, driving, reverse):
    """The table of the state machine, each state reached by its own steps."""
    state = armed(PROFILES['one_pedal'])
    steps = {'rest': [], 'ahead': [(0, 1)], 'back': [(1, 1)], 'hold': [(0, 1), (1, 1)]}
    for feet in steps[before]:
        state.read(tuple(map(float, feet)))
    wanted = -1.0 if reverse else 1.0
    expected = {'rest': wanted, 'ahead': 0.0 if reverse else 1.0, 'back': -1.0 if reverse else 0.0,
                'hold': 0.0}[before] if driving else 0.0
    assert state.read((float(reverse), float(driving)))[0] == (0.0, expected)


# Raw axes left toe, right toe, bar; then (left, forward); then buttons enabling, right, left, bar.
RUDDER = {
    'rest': ((-1.0, -1.0, 0.0), (0.0, 0.0), (0, 0, 0, 0)),
    'full_forward': ((-1.0, 1.0, 0.0), (0.0, 1.0), (1, 1, 0, 0)),
    'full_back': ((1.0, -1.0, 0.0), (0.0, -1.0), (0, 0, 1, 0)),
    'both_toes': ((1.0, 1.0, 0.0), (0.0, 0.0), (1, 1, 1, 0)),
    'bar_left': ((-1.0, -1.0, -1.0), (1.0, 0.0), (0, 0, 0, 1)),
    'bar_right': ((-1.0, -1.0, 1.0), (-1.0, 0.0), (0, 0, 0, 1)),
    'half_toe': ((-1.0, 0.0, 0.0), (0.0, 0.42 / 0.92), (1, 1, 0, 0)),
    'half_bar': ((-1.0, -1.0, 0.5), (-0.42 / 0.92, 0.0), (0, 0, 0, 1)),
    'in_the_dead_zone': ((-0.85, -0.85, 0.08), (0.0, 0.0), (0, 0, 0, 0)),
    'overshoot': ((-1.2, 1.2, -1.2), (1.0, 1.0), (1, 1, 0, 1)),
    'forward_and_left': ((-1.0, 1.0, -1.0), (1.0, 1.0), (1, 1, 0, 1))}


@pytest.mark.parametrize('case', sorted(RUDDER))
def test_rudder_pedals(case):
    """Toes rest at -1, the bar in the middle."""
    raw, axes, buttons = RUDDER[case]
    profile = PROFILES['rudder_pedals']
    found = armed(profile).read(profile.from_axes(raw))
    assert found[0] == pytest.approx(axes) and found[1] == buttons


def test_rudder_pedals_enabling():
    """A toe past a fifth of its way allows others to drive."""
    profile = PROFILES['rudder_pedals']
    state = armed(profile, ENABLE)
    assert state.read(profile.from_axes((1.0, -1.0, 1.0))) == ((0.0, 0.0), (0, 0, 1, 1))
    assert state.read(profile.from_axes((-1.0, -0.4, 0.0))) == ((0.0, 0.0), (1, 1, 0, 0))


UNKNOWN = [(None, -1.0, 0.0), (-1.0, None, 0.0), (-1.0, -1.0, None), (-1.0, float('nan'), 0.0),
           (-1.0, -1.0, float('inf')), (-1.0, -1.0), ()]


@pytest.mark.parametrize('raw', UNKNOWN)
def test_unknown_axes(raw):
    """Nothing is said before all are known; later nothing moves until rest has been seen again."""
    profile = PROFILES['rudder_pedals']
    state = PedalState(profile)
    assert state.read(profile.from_axes(raw)) is None
    assert state.note()
    assert state.read(profile.from_axes((-1.0, -1.0, 0.0)))[0] == (0.0, 0.0)
    assert state.note() == ''
    assert state.read(profile.from_axes((-1.0, 1.0, 0.0)))[0] == (0.0, 1.0)
    assert state.read(profile.from_axes(raw)) == ((0.0, 0.0), (0, 0, 0, 0))
    assert state.read(profile.from_axes((-1.0, 1.0, 0.0))) == ((0.0, 0.0), (0, 0, 0, 0))
    assert 'right toe' in state.note()
    state.read(profile.from_axes((-1.0, -1.0, 0.0)))
    assert state.read(profile.from_axes((-1.0, 1.0, 0.0)))[0] == (0.0, 1.0)


@pytest.mark.parametrize('role', [DRIVE, ENABLE])
def test_pressed_from_the_start_counts_once_released(role):
    """A book on the pedal neither drives nor enables; the other pedals count."""
    state = PedalState(PROFILES['pcsensor'], role)
    assert state.read((0.0, 1.0, 0.0)) == ((0.0, 0.0), (0, 0, 0, 0))
    assert 'forward' in state.note()
    axes, buttons = state.read((1.0, 1.0, 0.0))
    assert buttons == (0, 1, 0, 0) and axes == ((1.0, 0.0) if role == DRIVE else (0.0, 0.0))
    state.read((0.0, 0.0, 0.0))
    assert state.read((0.0, 1.0, 0.0))[1] == (1, 0, 1, 0) and state.note() == ''


def test_without_a_mark_every_pedal_enables_but_the_direction():
    """So that a lab's file of one line works in either role."""
    text = 'name: x\nkind: keys\npedals:\n  - {name: a, keys: KEY_A, forward: 1}\n' \
           '  - {name: b, keys: KEY_B, turn: 1}\n  - {name: c, keys: KEY_C, direction: true}\n'
    state = armed(parse_pedal_profile(text, 'x.yaml'), ENABLE)
    assert [state.read(values)[1][0] for values in (
        (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))] == [1, 1, 0]


HEAD = 'name: x\nkind: keys\n'
PEDAL = 'pedals:\n  - {name: a, keys: [KEY_A], forward: 1.0}\n'
AXIS = 'name: x\nkind: axes\npedals:\n  - {name: a, forward: 1.0, axis: 0'
BAD = {
    'name': 'kind: keys\n' + PEDAL,
    'kind': 'name: x\nkind: pedal\n' + PEDAL,
    'pedals': HEAD,
    'pedals[0].keys': HEAD + 'pedals: [{name: a, forward: 1.0}]\n',
    'pedals[0].forward': HEAD + 'pedals: [{name: a, keys: [KEY_A], forward: 1.5}]\n',
    'pedals[0].turn': HEAD + 'pedals: [{name: a, keys: [KEY_A], turn: left}]\n',
    'pedals[0].direction': HEAD + 'pedals: [{name: a, keys: [KEY_A], direction: 1}]\n',
    'pedals[0].colour': HEAD + 'pedals: [{name: a, keys: [KEY_A], forward: 1, colour: red}]\n',
    'pedals[0].axis': HEAD + 'pedals: [{name: a, keys: [KEY_A], forward: 1, axis: 0}]\n',
    'pedals[1]': HEAD + PEDAL + '  - {name: b, keys: [KEY_A], turn: 1.0}\n',
    'match.usb': HEAD + 'match: {usb: [3553b001]}\n' + PEDAL,
    'match.names': HEAD + 'match: {names: [""]}\n' + PEDAL,
    'match.guid': HEAD + 'match: {guid: x}\n' + PEDAL,
    'dead_zone': HEAD + 'dead_zone: 1.0\n' + PEDAL,
    'pressed_at': HEAD + 'pressed_at: 0.0\n' + PEDAL,
    'automatic': HEAD + 'automatic: 1\n' + PEDAL,
    'deadzone': HEAD + 'deadzone: 0.1\n' + PEDAL,
    'pedals[0].full': AXIS + ', rest: -1.0, full: -0.95}\n',
    'pedals[0].rest': AXIS + ', rest: -2.0}\n',
}
# What each key allows, but the whole does not.
BAD_TOGETHER = [
    ('pedals', HEAD + 'pedals: []\n'), ('pedals', HEAD + 'pedals: [{name: a, keys: [KEY_A]}]\n'),
    ('pedals[0].keys', HEAD + 'pedals: [{name: a, keys: [], forward: 1}]\n'),
    ('pedals[0].keys', HEAD + 'pedals: [{name: a, keys: [key_a], forward: 1}]\n'),
    ('pedals[1]', HEAD + PEDAL + '  - {name: a, keys: [KEY_B], turn: 1.0}\n'),
    ('pedals[0].keys', AXIS + ', keys: [KEY_A]}\n'), ('pedals[0].rest', AXIS + ', rest: .nan}\n'),
    ('pedals[0].direction',
     HEAD + 'pedals: [{name: a, keys: [KEY_A], forward: 1, direction: true}]\n')]


@pytest.mark.parametrize('key, text', [*BAD.items(), *BAD_TOGETHER])
def test_parse_names_file_and_key(key, text):
    """What is wrong and where, in the error."""
    with pytest.raises(ConfigError) as error:
        parse_pedal_profile(text, 'x.yaml')
    assert (error.value.origin, error.value.key) == ('x.yaml', key), error.value


def test_good_file_beside_bad_ones():
    """The first of two with one name stays: the operator's own."""
    own = HEAD + 'label: mine\n' + PEDAL
    profiles, errors = load_pedal_profiles([
        ('own.yaml', own), ('bad.yaml', ':'), ('shipped.yaml', HEAD + PEDAL)])
    assert profiles['x'].label == 'mine' and len(errors) == 1


FEET = parse_pedal_profile("""
name: feet
kind: keys
pedals:
  - {name: lamp, keys: [KEY_A]}
  - {name: go, keys: [KEY_B], forward: 1.0}
  - {name: flip, keys: [KEY_C]}
accessories:
  lamp: {button: 1, choice: toggle}
  flipper: {button: 3, value: -0.5}
""", 'feet.yaml')


def test_a_pedal_acts_on_an_accessory_as_the_button_of_a_pad_does():
    """It drives nothing and enables nothing; what is held is let go with the foot."""
    state, pad, at = armed(FEET), PadAccessories(), 0.0
    asked = []
    for held in ((), ('KEY_A',), ('KEY_A', 'KEY_B'), (), ('KEY_C',), ('KEY_C',), ()):
        axes, buttons = state.read(FEET.from_keys(set(held)))
        assert axes == (0.0, float('KEY_B' in held)) and buttons[0] == ('KEY_B' in held)
        at += 0.05
        profile = FEET.as_profile()
        driving, _ = pad.read(profile, 'd', axes, buttons, at)
        assert profile.read(driving, buttons).forward == axes[1]
        asked.append(pad.uses(True, ('bot1',)))
    turns, rests = Use('flipper', None, (-0.5,)), Use('flipper', None, (0.0,))
    assert asked == [[], [Use('lamp', 'toggle')], [], [], [turns], [turns], [rests]]


@pytest.mark.parametrize('profile, role, named', [
    (FEET, DRIVE, 'pedal:feet'), (FEET, ENABLE, ''), (PROFILES['pcsensor'], DRIVE, '')])
def test_the_profile_is_named_where_its_pedals_act_on_accessories(profile, role, named):
    assert PedalState(profile, role).named == named


@pytest.mark.parametrize('row, key', [
    ('{button: 2}', 'accessories.lamp.button'), ('{button: 0}', 'accessories.lamp.button'),
    ('{button: 4}', 'accessories'), ('{axis: 2}', 'accessories'),
    ('{button: 1, shift: true}', 'accessories.lamp.shift'),
    ('{pedal: 1}', 'accessories.lamp.button')])
def test_a_wrong_binding_is_refused_by_file_and_key(row, key):
    with pytest.raises(ConfigError) as refused:
        parse_pedal_profile('name: feet\nkind: keys\npedals:\n  - {name: a, keys: [KEY_A]}\n'
                            '  - {name: b, keys: [KEY_B], turn: 1}\n  - {name: c, keys: [KEY_C]}'
                            '\naccessories:\n  lamp: ' + row, 'feet.yaml')
    assert (refused.value.origin, refused.value.key) == ('feet.yaml', key)


SWITCH = Candidate(KEYS, '3553:b001', 'PCsensor FootSwitch Keyboard', ('/dev/input/event5',))
KEYBOARD = Candidate(KEYS, '046d:c31c', 'Logitech USB Keyboard', ('/dev/input/event3',))
RUDDERS = Candidate(AXES, '06a3:0763', 'Saitek Pro Flight Rudder Pedals', ('guid', 'joystick 0'))
PAD = Candidate(AXES, '054c:0268', 'Sony PLAYSTATION(R)3 Controller', ('other', 'joystick 1'))
ALL = [KEYBOARD, SWITCH, PAD]
CHOSEN = {
    'by_profile': (ALL, PedalRequest(), (SWITCH, 'pcsensor')),
    'by_name_of_axes': ([PAD, RUDDERS], PedalRequest(), (RUDDERS, 'rudder_pedals')),
    'usb': (ALL, PedalRequest('3553:B001'), (SWITCH, 'pcsensor')),
    'path': (ALL, PedalRequest('/dev/input/event5'), (SWITCH, 'pcsensor')),
    'name': (ALL, PedalRequest('footswitch'), (SWITCH, 'pcsensor')),
    'guid': ([RUDDERS, PAD], PedalRequest('guid'), (RUDDERS, 'rudder_pedals')),
    'profile_asked_for': (ALL, PedalRequest('', 'one_pedal'), (SWITCH, 'one_pedal')),
    'unknown_switch': (ALL, PedalRequest('046d:c31c'), (KEYBOARD, 'three_keys')),
    'unknown_joystick': (ALL, PedalRequest('playstation'), (PAD, 'rudder_pedals')),
    'both': (ALL, PedalRequest('046d:c31c', 'vec'), (KEYBOARD, 'vec')),
}


@pytest.mark.parametrize('case', sorted(CHOSEN))
def test_choice(case):
    """The one device that fits, with its profile, the one asked for, or the generic one."""
    candidates, request, (candidate, name) = CHOSEN[case]
    found, profile = choose(candidates, request, PROFILES)
    assert (found, profile.name) == (candidate, name)


TWO = [SWITCH, Candidate(KEYS, '3553:b001', 'PCsensor FootSwitch', ('/dev/input/event9',))]
REFUSED = {
    'nothing': ([], PedalRequest(), '~device'),
    'only_a_keyboard': ([KEYBOARD, PAD], PedalRequest(), '~device'),
    'other_usb': (ALL, PedalRequest('1111:2222'), '1111:2222'),
    'part_of_a_path': (ALL, PedalRequest('/dev/input/event'), '/dev/input/event'),
    'two_alike': (TWO, PedalRequest(), 'event5.*event9.*~device'),
    'two_by_name': (ALL, PedalRequest('keyboard'), '3553:b001'),
    'no_such_profile': (ALL, PedalRequest('', 'nosuch'), "'nosuch'.*one_pedal"),
    'profile_for_nothing': (ALL, PedalRequest('', 'three_keys'), '~device'),
    'profile_of_another_kind': ([SWITCH], PedalRequest('3553:b001', 'rudder_pedals'), '3553:b001'),
}


@pytest.mark.parametrize('case', sorted(REFUSED))
def test_choice_is_refused(case):
    """No guess: a keyboard must not be grabbed, nor one of two pedals be taken."""
    candidates, request, said = REFUSED[case]
    with pytest.raises(NoPedal, match=said):
        choose(candidates, request, PROFILES)


@pytest.mark.parametrize('guid, usb', [
    ('03000000a30600006307000011010000', '06a3:0763'),
    ('0300fd1aa30600006307000011010000', '06a3:0763'),
    ('03000000A30600006307000011010000', '06a3:0763'),
    ('05000000506c61797374617469000000', ''),
    ('03000000000000006307000011010000', ''),
    ('', ''), ('03000000a306', '')])
def test_usb_of_guid(guid, usb):
    """With and without the check sum; a name in its place is none."""
    assert usb_of_guid(guid) == usb
