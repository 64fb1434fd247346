# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The dialogue that writes a profile, scripted."""
import pytest

from mhri.devices.calibration import Calibration, DONE, FORWARD, LEFT, profile_name, REST
from mhri.devices.profile import parse_profile

GUID = '030000004c0500006802000011810000'


class Hands:
    """Somebody with a pad of six axes and ten buttons."""

    def __init__(self, rest=(0.02, -0.03, -1.0, 0.0, 0.0, -1.0), stuck=()):
        self.rest = list(rest)
        self.stuck = set(stuck)
        self.calibration = Calibration('mine', 'My pad', GUID)

    def let_go(self):
        self.feed()
        self.calibration.confirm()
        return self

    def feed(self, pressed=(), **moved):
        axes = list(self.rest)
        for key, value in moved.items():
            axes[int(key[1:])] = value
        self.calibration.feed(axes, [int(index in set(pressed) | self.stuck)
                                     for index in range(10)])

    def push(self, **moved):
        for part in (0.3, 0.7, 1.0, 0.6):
            self.feed(**{key: (1.0 - part) * self.rest[int(key[1:])] + part * value
                         for key, value in moved.items()})
        self.feed()
        return self

    def press(self, *buttons):
        self.feed(pressed=buttons[:1])
        self.feed(pressed=buttons)
        self.feed()
        return self

    def skip(self, count=1):
        for _ in range(count):
            self.calibration.confirm()
        return self

    @property
    def step(self):
        return self.calibration.step

    def profile(self):
        return parse_profile(self.calibration.text(), 'mine.yaml')


def test_from_rest_to_a_profile():
    hands = Hands().let_go()
    assert hands.step == FORWARD
    hands.push(a1=-1.0)
    assert hands.step == LEFT
    hands.push(a0=-1.0)
    hands.press(0).press(5).press(1).skip(2).press(3)
    assert hands.step == DONE
    profile = hands.profile()
    assert (profile.forward.index, profile.turn.index) == (1, 0)
    assert (profile.dead_man, profile.turbo) == (0, 5)
    assert profile.actions == ((1, 'stop_all'), (3, 'select_all'))
    assert profile.match.guids == (GUID,)
    held = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0]
    stick = profile.read([-1.0, -1.0] + [0.0] * 4, held)
    assert (stick.forward, stick.turn) == (1.0, 1.0)
    assert profile.read([0.02, -0.03] + [0.0] * 4, held).neutral


def test_a_trigger_rests_at_its_end():
    hands = Hands().let_go().push(a5=1.0).push(a0=-1.0).skip(6)
    profile = hands.profile()
    assert profile.forward.rest == -1.0
    assert profile.read(hands.rest, []).neutral
    assert profile.read(hands.rest[:5] + [1.0], []).forward == 1.0
    assert profile.read(hands.rest[:5] + [0.0], []).forward == pytest.approx(0.457, abs=0.01)


def test_a_worn_stick_gets_a_wider_dead_zone():
    hands = Hands(rest=(0.11, 0.0, 0.0, 0.0, 0.0, 0.0)).let_go().push(a1=-1.0).push(a0=-1.0).skip(6)
    profile = hands.profile()
    assert profile.dead_zone == 0.22
    assert profile.read(hands.rest, []).is_zero()


def test_a_diagonal_push_is_asked_for_again():
    hands = Hands().let_go().push(a0=-0.95, a1=-1.0)
    assert hands.step == FORWARD and hands.calibration.problem
    hands.push(a0=-0.4, a1=-1.0)
    assert hands.step == LEFT
    assert hands.calibration.problem == ''


def test_the_axis_of_forward_cannot_turn():
    hands = Hands().let_go().push(a1=-1.0).push(a1=1.0)
    assert hands.step == LEFT and hands.calibration.problem
    assert hands.push(a3=-1.0).step == 'dead_man'


def test_half_a_push_and_a_held_one_are_not_taken():
    hands = Hands().let_go().push(a1=-0.4)
    assert hands.step == FORWARD
    hands.feed(a1=-1.0)
    assert hands.step == FORWARD
    hands.feed()
    assert hands.step == LEFT


def test_buttons_one_at_a_time_and_each_once():
    hands = Hands().let_go().push(a1=-1.0).push(a0=-1.0)
    hands.press(2, 3)
    assert hands.step == 'dead_man' and hands.calibration.problem
    hands.press(2)
    assert hands.step == 'turbo'
    hands.press(2)
    assert hands.step == 'turbo' and hands.calibration.problem


def test_a_button_that_hangs_is_not_taken():
    hands = Hands(stuck=[7]).let_go().push(a1=-1.0).push(a0=-1.0)
    hands.feed()
    assert hands.step == 'dead_man'
    hands.press(4).skip(5)
    assert hands.profile().dead_man == 4


def test_axes_that_are_unknown_are_left_alone():
    calibration = Calibration('mine', 'My pad')
    calibration.confirm()
    assert calibration.step == REST
    calibration.feed([None, 0.0, None], [])
    calibration.confirm()
    assert calibration.step == REST and calibration.problem
    calibration.feed([0.0, 0.0, None], [])
    calibration.confirm()
    for value in (-1.0, 0.0):
        calibration.feed([0.0, value, 1.0], [])
    assert calibration.step == LEFT


def test_every_step_against_every_event():
    """Enter moves REST and the buttons on, nothing else; the end stays the end."""
    hands = Hands().let_go()
    assert hands.skip().step == FORWARD
    hands.push(a1=-1.0)
    assert hands.skip().step == LEFT
    hands.push(a0=-1.0)
    with pytest.raises(ValueError, match='dead_man'):
        hands.calibration.text()
    hands.skip(20).push(a1=1.0).press(3)
    assert hands.step == DONE
    assert 'button' not in hands.calibration.text()


@pytest.mark.parametrize('device, name', [
    ('Sony PLAYSTATION(R)3 Controller', 'sony_playstation_r_3_controller'),
    ('8BitDo Pro 2', 'pad_8bitdo_pro_2'), ('---', 'my_pad'), ('', 'my_pad')])
def test_names(device, name):
    assert profile_name(device) == name
