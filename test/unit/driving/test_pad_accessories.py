# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a pad does with accessories: by its bindings, and under the drive."""
from functools import partial
import math

import pytest
from test_accessory_rules import Desk

from mhri.base.accessories import Act
from mhri.base.config import ConfigError
from mhri.devices.profile import parse_profile
from mhri.driving.pad_accessories import PadAccessories, Use

# Sticks 0, 1 and 2, 3; a trigger 4; a hat 5. Buttons: 0 dead man, 1 stop, 2 next robot, 6 shift.
DRIVING = '''
name: pad
forward: {axis: 1, scale: -1.0}
turn: {axis: 0, scale: -1.0}
dead_zone: 0.1
dead_man_button: 0
stop_all_button: 1
next_robot_button: 2
shift_button: 6
'''
PAD = parse_profile(DRIVING + '''
accessories:
  lamp: [{button: 3, choice: toggle}, {axis: 5, value: -1, choice: on, shift: true}]
  flipper: [{button: 4, value: 1.0}, {button: 5, value: -0.5}, {axis: 4, rest: -1.0}]
  head: {axes: [0, 1], value: [-1, 1], shift: true}
  arm: [{button: 2, choice: open, shift: true}, {button: 7}]
  eye: {axes: [2, 3]}
''', 'pad.yaml')
REST = (0.0, 0.0, 0.0, 0.0, -1.0, 0.0)
UP = Use('flipper', None, (1.0,))
DOWN = Use('flipper', None, (0.0,))


def pose(*buttons, **axes):
    """Return (axes, buttons) with some buttons down, and axes such as a0=1.0."""
    return (tuple(axes.get('a{}'.format(number), rest) for number, rest in enumerate(REST)),
            tuple(int(number in buttons) for number in range(8)))


class Hand:
    """A pad in the hand, 20 messages a second."""

    def __init__(self):
        self.pad, self.now = PadAccessories(), 0.0
        self.drives = self.actions = None
        self.do()

    def do(self, *buttons, after=0.05, device='d', may_move=True, group=('bot1',), **axes):
        self.now += after
        self.drives, self.actions = self.pad.read(PAD, device, *pose(*buttons, **axes), self.now)
        return self.pad.uses(may_move, group)


# {name: [(arguments of a message, what it asks for)]}
ASKED = {
    'a tap counts once for each press': [
        ((7,), {}, [Use('arm', '')]), ((7,), {}, []), ((), {}, []), ((7,), {}, [Use('arm', '')])],
    'a hold counts with each message, and is let go once': [
        ((4,), {}, [UP]), ((4,), {}, [UP]), ((), {}, [DOWN]), ((), {}, [])],
    'two buttons of one accessory add up, within its range': [
        ((4, 5), {}, [Use('flipper', None, (0.5,))]), ((4,), {'a4': 1.0}, [UP])],
    'a trigger is proportional from its rest': [
        ((), {'a4': 0.0}, [Use('flipper', None, (pytest.approx((0.5 - 0.1) / 0.9),))]),
        ((), {'a4': -0.9}, [DOWN])],
    'both axes of a stick, with its dead zone': [
        ((), {'a2': -1.0, 'a3': 0.1}, [Use('eye', None, (-1.0, 0.0))]),
        ((), {'a2': 0.0, 'a3': 0.1}, [Use('eye', None, (0.0, 0.0))])],
    'the hat as an axis is a button in one direction': [
        ((6,), {}, []), ((6,), {'a5': 1.0}, []), ((6,), {'a5': -1.0}, [Use('lamp', 'on')]),
        ((6,), {'a5': -1.0}, [])],
    'the second stick, while shifted': [
        ((6,), {}, []), ((6,), {'a0': -1.0, 'a1': -1.0}, [Use('head', None, (1.0, -1.0))]),
        ((), {'a0': -1.0, 'a1': -1.0}, [Use('head', None, (0.0, 0.0))])],
    'the other layer counts no longer': [
        ((4,), {}, [UP]), ((4, 6), {}, [DOWN]), ((4,), {}, []), ((), {}, []), ((4,), {}, [UP])],
    'what was off rest before the shift is let go first': [
        ((), {'a0': 1.0}, []), ((6,), {'a0': 1.0}, []), ((6,), {}, []),
        ((6,), {'a0': -1.0}, [Use('head', None, (1.0, 0.0))])],
    'what was down before another device is let go first': [
        ((4,), {}, [UP]), ((4, 7), {'device': 'e'}, [DOWN]), ((4, 7), {'device': 'e'}, []),
        ((), {'device': 'e'}, []), ((4,), {'device': 'e'}, [UP])],
    'silence': [((4,), {}, [UP]), ((4,), {'after': 0.3}, [DOWN]), ((4,), {}, []), ((), {}, []),
                ((4,), {}, [UP])],
    'the pad may not drive meanwhile': [
        ((4,), {}, [UP]), ((4,), {'may_move': False}, [DOWN]), ((4,), {}, []), ((), {}, []),
        ((4,), {}, [UP])],
    'another robot is driven': [
        ((4,), {}, [UP]), ((4,), {'group': ('bot2',)}, [DOWN]), ((4,), {'group': ('bot2',)}, [])],
    'an unusable message': [
        ((4,), {}, [UP]), ((4,), {'a2': math.nan}, [DOWN]), ((4, 7), {}, []), ((), {}, []),
        ((4,), {}, [UP])]}


@pytest.mark.parametrize('case', ASKED)
def test_what_a_message_asks_for(case):
    hand = Hand()
    for buttons, options, expected in ASKED[case]:
        assert hand.do(*buttons, **options) == expected, (buttons, options)


def test_sticks_and_buttons_of_the_shifted_layer_do_nothing_else_until_they_are_let_go():
    hand = Hand()
    hand.do(0, a0=1.0, a2=0.5)
    assert hand.drives == pose(a0=1.0, a2=0.5)[0]
    for _ in range(2):
        hand.do(0, 2, 6, a0=1.0, a1=-1.0)
        assert hand.drives[:2] == (0.0, 0.0) and not hand.actions
    for _ in range(2):
        hand.do(0, 2, a0=1.0, a1=-1.0)
        assert hand.drives[:2] == (0.0, 0.0) and not hand.actions
    hand.do(0, 2, a1=-1.0)
    hand.do(0, a0=1.0)
    hand.do(0, 2, a0=1.0)
    assert hand.drives[:2] == (1.0, 0.0) and hand.actions == {'next_robot'}
    hand.do(0, 1, 6)
    assert hand.actions == {'stop_all'}


WRONG = {
    '{}': ('button', 'name one of'), '{button: 3, axis: 2}': ('axis', 'name one of'),
    '{button: 0}': ('button', 'dead-man'), '{button: 1, shift: true}': ('button', 'stop_all'),
    '{button: 2}': ('button', 'next_robot'), '{button: 6}': ('button', 'shift'),
    '{axis: 1}': ('axis', 'drives'), '{axes: [2, 0]}': ('axis', 'drives'),
    '{axes: [2]}': ('axes', 'two axes'), '{axes: [2, 3], choice: on}': ('axes', 'held'),
    '{axes: [2, 3], value: 1}': ('value', 'two numbers'), '{axis: 2, value: 2}': ('value', 'to 1'),
    '{button: 3, value: 0}': ('value', 'not all 0'), '{button: 3, choice: 4}': ('choice', 'a word'),
    '{button: 3, hold: true}': ('hold', 'unknown'), '[[]]': ('', 'mapping'), '7': ('', 'mapping')}


@pytest.mark.parametrize('row', WRONG)
def test_a_wrong_binding_is_named(row):
    key, words = WRONG[row]
    with pytest.raises(ConfigError, match='(?s)pad.yaml.*accessories.lamp.*{}.*{}'.format(
            key, words)):
        parse_profile(DRIVING + 'accessories: {lamp: ' + row + '}', 'pad.yaml')


@pytest.mark.parametrize('old, new, key', [
    ('shift_button: 6\n', '', 'shift'), ('shift_button: 6', 'shift_button: 2', 'shift_button'),
    ('dead_man_button: 0', 'dead_man_button: any', 'dead_man_button')])
def test_a_profile_without_room_for_a_shifted_layer_is_named(old, new, key):
    with pytest.raises(ConfigError, match=key):
        parse_profile(DRIVING.replace(old, new)
                      + 'accessories: {lamp: {button: 3, shift: true}}', 'pad.yaml')


class PadDesk(Desk):
    """A desk whose stick is the pad: the drive, robots with accessories, and their operator."""

    def __init__(self, *robots, **options):
        self.pad, self.problem = PadAccessories(), ''
        super().__init__(*robots, **options)

    def press(self, *buttons, name='joy', **axes):
        """Send one message, with the dead-man button held unless it says "loose"."""
        self.now += 1e-3
        held = () if axes.pop('loose', False) else (0,)
        axes, buttons = pose(*buttons, *held, **axes)
        axes, pressed = self.pad.read(PAD, 'd', axes, buttons, self.now)
        self.note(self.drive.on_source(name, '/a', 'd', partial(PAD.read, axes, buttons),
                                       self.now, pressed))
        orders, self.problem = self.pad.act(
            self.drive, self.drive.mode == name and self.drive.owner(name) == '/a', self.now)
        self.note(orders)

    def keep(self, seconds, *buttons, robots=('bot1',), **axes):
        """Hold a pose for a while."""
        self.run(seconds, lambda: self.press(*buttons, **axes), lambda: self.wish(*robots))


@pytest.fixture(name='desk')
def fixture_desk():
    desk = PadDesk('bot1')
    desk.keep(0.2, loose=True)
    desk.keep(0.2)
    return desk


def test_what_is_held_acts_while_the_pad_may_drive(desk):
    desk.keep(0.1, 4)
    assert desk.last() == Act('flipper', value=(1.0,)) and not desk.problem
    desk.keep(0.1)
    assert desk.last() == Act('flipper', value=(0.0,), ends=True)


# What ends it at once though the button stays down; after that it has to be let go first.
ENDS = {
    'dead man': lambda desk: desk.press(4, loose=True),
    'another mode': lambda desk: desk.do('on_mode', '/a', 'pad'),
    'source lost': lambda desk: desk.do('on_lost', 'joy', 'lost'),
    'stop-all': lambda desk: desk.do('on_stop'),
    'stop button': lambda desk: desk.press(1, 4),
    'deselected': lambda desk: desk.wish(),
    'another robot': lambda desk: desk.wish('bot2'),
    'shifted': lambda desk: desk.press(4, 6),
    'let go': lambda desk: desk.press()}


@pytest.mark.parametrize('way', ENDS)
def test_a_hold_ends_at_once(desk, way):
    desk.keep(0.3, 4)
    at = desk.now
    ENDS[way](desk)
    assert desk.last() == Act('flipper', value=(0.0,), ends=True)
    if way != 'let go':
        desk.do('on_mode', '/a', 'joy')
        desk.do('on_release')
        desk.keep(1.0, 4)
    assert not any(act.value[0] for when, _, act in desk.acts if when >= at)
    desk.keep(0.1)
    desk.keep(0.1, 4)
    assert desk.last() == Act('flipper', value=(1.0,))


def test_a_silent_pad_holds_nothing(desk):
    desk.keep(0.3, 4)
    desk.run(0.3, lambda: desk.wish('bot1'))
    assert desk.last() == Act('flipper', value=(0.0,), ends=True)
    desk.keep(1.0, 4)
    assert desk.last() == Act('flipper', value=(0.0,), ends=True)


def test_the_shifted_stick_turns_the_head_and_not_the_robot(desk):
    desk.press(6)
    desk.keep(0.2, 6, a0=-1.0)
    assert desk.last('head') == Act('head', value=(1.0, 0.0)) and desk.sent['bot1'].is_zero()
    desk.keep(1.0, a0=-1.0)
    assert desk.sent['bot1'].is_zero()
    desk.keep(0.1)
    desk.keep(0.1, a0=-1.0)
    assert desk.sent['bot1'].angular_rad_s > 0.0


def test_a_toggle_goes_by_what_is_reported_else_by_what_was_asked(desk):
    for expected in ('on', 'off', 'on'):
        desk.press(3, loose=True)
        assert desk.last('lamp') == Act('lamp', expected)
        desk.press(loose=True)
    desk.drive.on_report('bot1', 'lamp', (0.0,), 'off')
    desk.press(3, loose=True)
    assert desk.last('lamp') == Act('lamp', 'on')


def test_a_moving_part_needs_what_driving_needs_and_a_pad_that_is_not_active_does_nothing(desk):
    before = len(desk.acts)
    desk.press(6, loose=True)
    desk.press(2, 6, loose=True)
    assert desk.problem and len(desk.acts) == before
    desk.press(3, name='pad')
    assert len(desk.acts) == before
    desk.keep(0.2)
    desk.press(6)
    desk.press(2, 6)
    assert desk.last('arm') == Act('arm', 'open')


def test_one_action_counts_for_several_robots_only_where_their_type_says_so(desk):
    desk.keep(0.3, robots=('bot1', 'bot2'))
    desk.keep(0.2, 4, robots=('bot1', 'bot2'))
    assert 'one robot at a time' in desk.problem and desk.last() is None
    desk.keep(0.2, robots=())
    desk.press(3)
    assert desk.problem and desk.last('lamp') is None
