# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The controls of accessories: which there are, what they ask for, and why they do not."""
from dataclasses import replace

import pytest

from mhri.accessories.controls import (
    ARROWS, controls_of, drag_share, found, head_of, HELD_DOWN, key_page, looks_words, meant,
    MENU, next_choice, PAD, page_rows, PRESS, readout_text, refusal, reported, shares, SWITCH,
    UNKNOWN, warns, why_not, widest_readout)
from mhri.base.accessories import LOOKED_AT
from mhri.base.views import ControlView, ROS_NO_MASTER
from support.tools import robot, screen_of, specs

SPECS = specs()


@pytest.mark.parametrize('key, expected', [
    ('lamp', [(SWITCH, '', ())]),
    # Nobody knows whether it is on.
    ('siren', [(PRESS, 'on', ()), (PRESS, 'off', ())]),
    ('horn', [(PRESS, '', ())]),
    ('gripper', [(PRESS, 'open', ()), (PRESS, 'close', ())]),
    ('arm', [(MENU, '', ())]),
    ('flipper', [(HELD_DOWN, '', (-1.0,)), (HELD_DOWN, '', (1.0,))]),
    # Its neutral value is the end of its range.
    ('winch', [(HELD_DOWN, '', (1.0,))]),
    ('head', [(PAD, '', ())]),
    ('lift', [(PAD, '', ())]),
    ('gas', []),
])
def test_controls(key, expected):
    made = controls_of(SPECS[key])
    assert [control[:1] + control[3:] for control in made] == expected
    assert len({control.label for control in made}) == len(made), 'each is told from the others'


@pytest.mark.parametrize('key, state, after', [
    ('lamp', None, None), ('lamp', 'on', 'off'), ('lamp', 'off', 'on'), ('lamp', '', None),
    ('arm', None, None), ('arm', 'rest', 'carry_high'), ('arm', 'carry_high', 'rest')])
def test_nothing_follows_what_was_not_reported(key, state, after):
    view = found(robot(SPECS, **{key: state}), key)
    assert next_choice(view) == after
    assert (reported(view) == UNKNOWN) == (after is None)


def test_a_sensor_shows_its_value_with_its_unit_and_warns_beyond_its_limit():
    texts = []
    for value in (None, (12.0,), (63.0,)):
        view = found(robot(SPECS, gas=value), 'gas')
        texts.append(readout_text(view))
        assert warns(view) == (value == (63.0,))
    assert len(set(texts)) == 3 and all('gas' in text for text in texts)
    assert max(map(len, texts)) <= len(widest_readout(SPECS['gas']))
    bumper = replace(SPECS['gas'], bits=('right', 'left'))
    assert all(name in widest_readout(bumper) for name in bumper.bits)


def test_reasons_of_the_screen_come_before_those_of_the_drive():
    bot = robot(SPECS, stands='stopped')
    said = [why_not(screen_of(), bot, bot.accessories[0])]
    for more in ({'control': ControlView(False, 'somebody')}, {'answers': False},
                 {'ros': ROS_NO_MASTER}):
        said.append(why_not(screen_of(**more), bot, bot.accessories[0]))
    lone = replace(bot, sent=None)
    said.append(why_not(screen_of(), lone, lone.accessories[0]))
    assert all(said) and len(set(said)) == 5
    free = robot(SPECS)
    assert why_not(screen_of(), free, free.accessories[0]) == ''


def test_every_code_is_said_in_words():
    for code in ('neutral', 'not_selected', 'closed', 'stopped', 'no_lease', 'undertaker'):
        bot = robot(SPECS, stands=code)
        text = why_not(screen_of(), bot, bot.accessories[0])
        assert text and code not in text.split() and '{' not in text or code == 'stopped'
    bot = robot(SPECS, stands='no node of the robot listens')
    assert why_not(screen_of(), bot, bot.accessories[0]) == 'no node of the robot listens'


@pytest.mark.parametrize('names, key, choice, done', [
    (['bot1'], 'lamp', 'on', True), (['bot1'], 'horn', '', True),
    ([], 'arm', 'rest', True), (['bot1', 'bot2'], 'arm', 'rest', True),
    (['bot1'], 'lamp', 'blue', False), (['bot1'], 'tail', '', False),
    (['bot1'], 'flipper', '', False), (['bot1'], 'gas', '', False),
    # One robot at a time.
    ([], 'lamp', 'on', False), (['bot1', 'bot2'], 'lamp', 'on', False),
    # It stands.
    (['bot3'], 'lamp', 'on', False), (['bot3'], 'arm', 'rest', False),
])
def test_requests(names, key, choice, done):
    robots = {name: robot(SPECS, name, 'stopped' if name == 'bot3' else '')
              for name in ('bot1', 'bot2', 'bot3')}
    robots['bot3'] = replace(robots['bot3'], selected=False)
    text = refusal([robots[name] for name in names], key, choice, screen_of(*robots.values()))
    assert (text == '') == done
    if not done:
        assert key in text


def test_a_request_names_a_robot_if_none_is_selected():
    bot = replace(robot(SPECS), selected=False)
    assert refusal([], 'arm', 'rest', screen_of(bot))


@pytest.mark.parametrize('selected, key, expected', [
    (['bot1'], 'lamp', ['bot1']), ([], 'lamp', []), (['bot1', 'bot2'], 'lamp', []),
    (['bot1'], 'arm', []), (['bot1'], 'tail', []), (['bot1', 'bot2'], 'beam', ['bot2']),
    # The robot in the large tile, bot2, whichever are selected.
    (['bot1'], 'eye', ['bot2'])])
def test_a_request_without_a_name_means_the_one_robot_that_has_it(selected, key, expected):
    eye = replace(SPECS['lamp'], key='eye', of=LOOKED_AT)
    has = {'bot1': {**SPECS, 'eye': eye},
           'bot2': {**SPECS, 'eye': eye, 'beam': replace(SPECS['lamp'], key='beam')}}
    robots = [replace(robot(own, name), selected=name in selected) for name, own in has.items()]
    assert meant(screen_of(*robots), key, 'bot2') == expected


@pytest.mark.parametrize('value, expected', [
    ((0.0, 0.0), (0.0, 0.0)), ((1.5, 0.8), (1.0, 1.0)), ((-0.75, -0.5), (-0.5, -1.0)),
    ((9.0, 0.4), (1.0, 0.5))])
def test_shares_are_the_inverse_of_values(value, expected):
    assert shares(SPECS['head'], value) == pytest.approx(expected)
    if max(map(abs, value)) < 9.0:
        assert SPECS['head'].scaled(expected) == pytest.approx(value)


def test_the_head_says_where_it_looks_once_it_has_reported_it():
    assert looks_words(robot(SPECS).accessories) == ''
    words = [looks_words(robot(SPECS, head=value).accessories) for value in (
        (0.0, 0.0), (0.75, 0.0), (-0.75, 0.0), (0.0, 0.4), (0.0, -0.25))]
    assert all('head' in text for text in words) and len(set(words)) == 5


def test_a_drag_of_a_position_goes_on_from_it_and_of_a_rate_from_rest():
    place = found(robot(SPECS, head=(0.75, 0.0)), 'head')
    rate = replace(place, spec=replace(place.spec, mode='rate'))
    assert drag_share(place, 0.25, -0.5) == pytest.approx((0.75, -0.5))
    assert drag_share(place, 3.0, 0.0) == (1.0, 0.0)
    assert drag_share(rate, 0.25, -0.5) == pytest.approx((0.5, -1.0))
    for view, left in ((place, -0.5), (rate, 0.0)):
        value = drag_share(view, left, 0.0)
        assert any(value) and max(map(abs, value)) < 0.01, 'zeros would release it'


def test_the_head_is_the_one_of_that_name_else_the_first_pair_of_axes():
    arm = replace(SPECS['head'], key='arm')
    for heads, key in ((('arm', 'head'), 'head'), (('arm',), 'arm'), ((), None)):
        views = robot({key: arm if key == 'arm' else SPECS['head'] for key in heads}).accessories
        view = head_of(views)
        assert (view.spec.key if view else None) == key


def test_every_control_has_a_key_as_long_as_there_are_any():
    page = key_page(robot(SPECS).accessories)
    keys = [(key, control.spec.key, control.choice or control.value)
            for key, control in page.items()]
    assert keys == [
        ('1', 'lamp', ()), ('2', 'siren', 'on'), ('3', 'siren', 'off'), ('4', 'horn', ()),
        ('5', 'gripper', 'open'), ('6', 'gripper', 'close'), ('7', 'arm', ()),
        ('8', 'flipper', (-1.0,)), ('9', 'flipper', (1.0,)), ('0', 'winch', (1.0,)),
        *((key, 'head', value) for key, value in ARROWS.items())]
    rows = page_rows('bot1', page)
    assert len(rows) == 11 and len(dict(rows)) == 11, 'the arrows are one row'


def test_the_arrows_are_of_the_first_axis_without_a_head():
    lift, tilt = SPECS['lift'], replace(SPECS['lift'], key='tilt')
    page = key_page(robot({'lift': lift, 'tilt': tilt}).accessories)
    assert {key: (control.spec.key, control.value) for key, control in page.items()} == {
        'Up': ('lift', (1.0,)), 'Down': ('lift', (-1.0,)),
        '1': ('tilt', (-1.0,)), '2': ('tilt', (1.0,))}
    assert key_page(robot({}).accessories) == {} and page_rows('bot1', {}) == []
