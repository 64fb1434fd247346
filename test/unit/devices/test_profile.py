# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Profiles: axes and buttons into fractions, and files into profiles."""
from dataclasses import replace
import math

import pytest

from mhri.base.config import ConfigError
from mhri.devices.profile import ACTIONS, Axis, JoyRefused, Match, parse_profile, Profile, Stick

PAD = Profile('pad', Axis(1, -1.0), Axis(0, -1.0), dead_zone=0.1, neutral=0.15, dead_man=2)
HELD = (0, 0, 1)

READ = {
    'rest': ((0.0, 0.0), HELD, Stick(0.0, 0.0, True)),
    'full_forward': ((0.0, -1.0), HELD, Stick(1.0, 0.0, False)),
    'full_back': ((0.0, 1.0), HELD, Stick(-1.0, 0.0, False)),
    'full_left': ((-1.0, 0.0), HELD, Stick(0.0, 1.0, False)),
    'dead_zone': ((0.1, -0.1), HELD, Stick(0.0, 0.0, True)),
    'half_stretched': ((0.0, -0.55), HELD, Stick(0.5, 0.0, False)),
    'overshoot_cut': ((-1.7, -32767.0), HELD, Stick(1.0, 1.0, False)),
    'released': ((0.0, -1.0), (1, 1, 0), Stick(0.0, 0.0, False, False)),
    'released_at_rest': ((0.0, 0.0), (0, 0, 0), Stick(0.0, 0.0, True, False)),
    'more_than_needed': ((0.0, -1.0, 0.3), HELD + (1,), Stick(1.0, 0.0, False)),
}


@pytest.mark.parametrize('case', sorted(READ))
def test_read(case):
    """Each way to hold a pad."""
    axes, buttons, expected = READ[case]
    stick = PAD.read(axes, buttons)
    assert (stick.forward, stick.turn) == pytest.approx((expected.forward, expected.turn))
    assert (stick.neutral, stick.held) == (expected.neutral, expected.held)
    assert stick.is_zero() == (expected.forward == expected.turn == 0.0)


SECOND = replace(PAD, sideways=Axis(3, -1.0))
SHIFT = replace(PAD, sideways_button=1)
ASIDE = {
    'second_stick': (SECOND, (0.0, -1.0, 0.0, -1.0), HELD, Stick(1.0, 0.0, False, sideways=1.0)),
    'only_the_second': (SECOND, (0.0, 0.0, 0.0, 0.55), HELD,
                        Stick(0.0, 0.0, False, sideways=-0.5)),
    'at_rest': (SECOND, (0.0, 0.0, 0.0, 0.1), HELD, Stick(0.0, 0.0, True)),
    'it_lacks_the_axis': (SECOND, (-1.0, 0.0, 1.0), HELD, Stick(0.0, 1.0, False)),
    'dead_man_released': (SECOND, (0.0, 0.0, 0.0, 1.0), (0, 0, 0), Stick(0.0, 0.0, False, False)),
    'button': (SHIFT, (-1.0, -1.0), (0, 1, 1), Stick(1.0, 0.0, False, sideways=1.0)),
    'button_up': (SHIFT, (-1.0, -1.0), HELD, Stick(1.0, 1.0, False)),
    'none': (PAD, (-1.0, 0.0, 1.0, 1.0), HELD, Stick(0.0, 1.0, False))}


@pytest.mark.parametrize('case', sorted(ASIDE))
def test_read_sideways(case):
    """By a second stick or a button held; what counts for nobody is not asked for neutral."""
    pad, axes, buttons, expected = ASIDE[case]
    stick = pad.read(axes, buttons, True)
    assert stick[:4] == expected[:4] and stick.sideways == pytest.approx(expected.sideways)
    assert pad.read(axes, buttons) == replace(
        pad, sideways=None, sideways_button=None).read(axes, buttons, True)


def test_no_stick_asks_for_more_than_the_limit():
    velocity = Stick(1.0, 0.5, False, sideways=-1.0).velocity((0.5, 1.0))
    assert velocity == pytest.approx((0.5 / 2 ** 0.5, 0.5 / 2 ** 0.5, -0.5 / 2 ** 0.5))


REFUSED = {
    'no_axes': ((), HELD), 'too_few_axes': ((0.0,), HELD), 'too_few_buttons': ((0.0, 0.0), (1, 1)),
    'not_finite': ((float('nan'), 0.0), HELD),
    # A driver that sends it anywhere is not believed anywhere.
    'not_finite in an axis nobody reads': ((0.0, 0.0, float('-inf')), HELD)}


@pytest.mark.parametrize('kind', sorted(REFUSED))
def test_refused(kind):
    """The kind is the word it is counted under; the text says what is missing."""
    with pytest.raises(JoyRefused) as refusal:
        PAD.read(*REFUSED[kind])
    assert refusal.value.kind == kind.split()[0] and str(refusal.value)


def test_stretch_is_monotonic_odd_and_bounded():
    """No jump at the edge of the dead zone, full travel stays full speed."""
    values = [PAD.read((0.0, count / 100.0), HELD).forward for count in range(-100, 101)]
    assert values == sorted(values, reverse=True)
    assert values[0] == 1.0 and values[-1] == -1.0
    assert values == pytest.approx([-value for value in reversed(values)])
    assert max(abs(a - b) for a, b in zip(values, values[1:])) < 0.012


GOOD = """
name: pad
forward: {axis: 1, scale: -1}
turn: {axis: 0}
"""


def test_parse_defaults():
    """Scale 1, no dead zone, no dead-man button, neutral within 2 %."""
    profile = parse_profile(GOOD, 'pad.yaml')
    assert profile == Profile('pad', Axis(1, -1.0), Axis(0, 1.0), 0.0, 0.02, None)


def test_parse_everything():
    """Neutral is never narrower than the dead zone unless the file says so."""
    profile = parse_profile(GOOD + 'dead_zone: 0.2\ndead_man_button: 0\n', 'pad.yaml')
    assert (profile.dead_zone, profile.neutral, profile.dead_man) == (0.2, 0.2, 0)
    assert parse_profile(GOOD + 'neutral: 0.3\n', 'pad.yaml').neutral == 0.3
    profile = parse_profile(GOOD + 'sideways: {axis: 2}\nsideways_button: 5\n', 'pad.yaml')
    assert (profile.sideways, profile.sideways_button) == (Axis(2, 1.0), 5)


BAD = {
    'dead_zone': GOOD + 'dead_zone: 1.0\n',
    'neutral': GOOD + 'neutral: -0.1\n',
    'dead_man_button': GOOD + 'dead_man_button: -1\n',
    'dead_man_button: expected': GOOD + 'dead_man_button: every\n',
    'dead_man_button: button 4': GOOD + 'dead_man_button: 4\nnext_robot_button: 4\n',
    'dead_man_button: button 5': GOOD + 'dead_man_button: 5\nturbo_button: 5\n',
    'dead_man_button: button 6': GOOD + 'dead_man_button: 6\nsideways_button: 6\n',
    'sideways.scale': GOOD + 'sideways: {axis: 2, scale: 0}\n',
    'dead_mann': GOOD + 'dead_mann: 4\n',
    'forward': 'name: pad\nturn: {axis: 0}\n',
    'forward.axis': 'name: pad\nforward: {axis: 1.5}\nturn: {axis: 0}\n',
    'forward.scale': 'name: pad\nforward: {axis: 1, scale: 0}\nturn: {axis: 0}\n',
    'turn.sign': 'name: pad\nforward: {axis: 1}\nturn: {axis: 0, sign: 1}\n',
    'turn.scale': 'name: pad\nforward: {axis: 1}\nturn: {axis: 0, scale: .nan}\n',
    'name': 'forward: {axis: 1}\nturn: {axis: 0}\n',
    'curve': GOOD + 'curve: 1.1\n',
    'without_turbo': GOOD + 'turbo_button: 5\nwithout_turbo: 0\n',
    'stop_all_button': GOOD + 'stop_all_button: L1\n',
    'forward.rest': 'name: pad\nforward: {axis: 5, rest: -2}\nturn: {axis: 0}\n',
    'match.guids': GOOD + 'match: {guids: [xyz]}\n',
    'match.nmes': GOOD + 'match: {nmes: [Sony]}\n',
}


@pytest.mark.parametrize('key', sorted(BAD))
def test_parse_names_file_and_key(key):
    """What is wrong and where, in the error."""
    with pytest.raises(ConfigError) as error:
        parse_profile(BAD[key], 'pad.yaml')
    assert str(error.value).startswith('pad.yaml: {}'.format(
        key if ':' in key else key + ':'))


def test_axis_never_leaves_its_range():
    """Whatever the scale."""
    for scale in (-10.0, -1.0, 0.001, 10.0):
        for value in (-1e300, -1.0, 0.0, 0.5, 1e300):
            assert -1.0 <= Axis(0, scale).read((value,)) <= 1.0
            assert not math.isnan(Axis(0, scale).read((value,)))


@pytest.mark.parametrize('rest, value, expected', [
    (-1.0, -1.0, 0.0), (-1.0, 0.0, 0.5), (-1.0, 1.0, 1.0),
    (1.0, 1.0, 0.0), (1.0, -1.0, -1.0), (0.0, 0.5, 0.5)])
def test_a_trigger_counts_from_its_rest(rest, value, expected):
    """Most triggers say -1 while nobody touches them, some pedals +1."""
    assert Axis(0, 1.0, rest).read((value,)) == pytest.approx(expected)


@pytest.mark.parametrize('curve, travel, expected', [
    (0.0, 0.5, 0.5), (1.0, 0.5, 0.125), (0.5, 0.5, 0.3125), (1.0, 1.0, 1.0), (1.0, -0.5, -0.125)])
def test_the_curve_bends_the_middle_and_keeps_the_ends(curve, travel, expected):
    profile = Profile('pad', Axis(1, 1.0), Axis(0, 1.0), curve=curve)
    assert profile.read((0.0, travel), ()).forward == pytest.approx(expected)


@pytest.mark.parametrize('buttons, expected', [((0, 1), 1.0), ((0, 0), 0.4), ((), 0.4)])
def test_without_its_turbo_button_a_pad_is_slow(buttons, expected):
    """A pad that lacks the button is slow, never fast."""
    profile = Profile('pad', Axis(1, 1.0), Axis(0, 1.0), turbo=1, without_turbo=0.4)
    assert profile.read((0.0, 1.0), buttons).forward == pytest.approx(expected)


def test_actions_of_buttons():
    text = GOOD + ''.join('{}_button: {}\n'.format(action, number)
                          for number, action in enumerate(ACTIONS))
    profile = parse_profile(text, 'pad.yaml')
    assert profile.pressed((1, 0, 0, 1)) == {ACTIONS[0], ACTIONS[3]}
    assert profile.pressed(()) == frozenset()


def test_what_a_profile_is_for():
    guid = '030000004C0500006802000011010000'
    profile = parse_profile(GOOD + 'match: {{guids: [{}], names: [Sony]}}\n'.format(
        "'" + guid + "'"), 'pad.yaml')
    assert profile.match == Match((guid.lower(),), ('Sony',))
