# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The dialogue that writes a profile: scripted, and in a process with a virtual pad."""
import os
import subprocess
import sys

import pytest

from mhri.core.devices.calibration import Calibration, DONE, FORWARD, LEFT, REST
from mhri.core.driving.profile import parse_profile
from mhri.inputs.pad_calibration import name_for

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import wait_for  # noqa: E402
from support.virtual_pad import missing, PadProcess  # noqa: E402

GUID = '030000004c0500006802000011810000'
NO_PADS = missing()


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
    hands.press(4).press(5).press(1).skip(2).press(3)
    assert hands.step == DONE
    profile = hands.profile()
    assert (profile.forward.index, profile.turn.index) == (1, 0)
    assert (profile.dead_man, profile.turbo) == (4, 5)
    assert profile.actions == ((1, 'stop_all'), (3, 'select_all'))
    assert profile.match.guids == (GUID,)
    held = [0, 0, 0, 0, 1, 1, 0, 0, 0, 0]
    stick = profile.read([-1.0, -1.0] + [0.0] * 4, held)
    assert (stick.forward, stick.turn) == (1.0, 1.0)
    assert profile.read([0.02, -0.03] + [0.0] * 4, held).neutral


def test_a_stick_that_is_the_other_way_round_and_does_not_go_far():
    hands = Hands(rest=(0.0,) * 6).let_go().push(a4=0.8).push(a3=1.0).skip(6)
    profile = hands.profile()
    axes = [0.0, 0.0, 0.0, 1.0, 0.8, 0.0]
    stick = profile.read(axes, [])
    assert stick.forward == pytest.approx(1.0, abs=0.01)
    assert stick.turn == 1.0


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
    assert hands.step == FORWARD
    assert 'Axes 0 and 1' in hands.calibration.problem
    hands.push(a0=-0.4, a1=-1.0)
    assert hands.step == LEFT
    assert hands.calibration.problem == ''


def test_the_axis_of_forward_cannot_turn():
    hands = Hands().let_go().push(a1=-1.0).push(a1=1.0)
    assert hands.step == LEFT
    assert 'drives forward' in hands.calibration.problem
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
    assert hands.step == 'dead_man'
    assert '2 and 3' in hands.calibration.problem
    hands.press(2)
    assert hands.step == 'turbo'
    hands.press(2)
    assert hands.step == 'turbo'
    assert 'Button 2 has a meaning already' in hands.calibration.problem


def test_a_button_number_is_no_axis_entry():
    hands = Hands().let_go().push(a1=-1.0).push(a0=-1.0).press(0).press(1).skip(4)
    assert (hands.profile().dead_man, hands.profile().turbo) == (0, 1)


def test_a_button_that_hangs_is_not_taken():
    hands = Hands(stuck=[7]).let_go().push(a1=-1.0).push(a0=-1.0)
    hands.feed()
    assert hands.step == 'dead_man'
    hands.press(4).skip(5)
    assert hands.profile().dead_man == 4


def test_enter_while_a_button_is_held_is_no_answer():
    hands = Hands().let_go().push(a1=-1.0).push(a0=-1.0)
    hands.feed(pressed=[4])
    hands.skip()
    assert hands.step == 'dead_man'
    hands.feed()
    assert hands.step == 'turbo'


def test_axes_that_are_unknown_are_left_alone():
    calibration = Calibration('mine', 'My pad')
    calibration.confirm()
    assert calibration.step == REST
    calibration.feed([None, 0.0, None], [])
    calibration.confirm()
    assert calibration.step == REST
    assert 'Fewer than two' in calibration.problem
    calibration.feed([0.0, 0.0, None], [])
    calibration.confirm()
    for value in (-1.0, 0.0):
        calibration.feed([0.0, value, 1.0], [])
    assert calibration.step == LEFT


def test_without_a_guid_the_name_is_the_key():
    hands = Hands()
    hands.calibration = Calibration('mine', 'A "quoted" pad: é')
    hands.let_go().push(a1=-1.0).push(a0=-1.0).skip(6)
    assert hands.profile().match.names == ('A "quoted" pad: é',)


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
    assert name_for(device) == name


@pytest.fixture(name='terminal')
def fixture_terminal(tmp_path):
    """Return a function that starts ``mhri_joy --calibrate`` in a process with a virtual pad."""
    begun = []

    def start(*arguments, pad='Lab rat pad'):
        process = PadProcess('--calibrate', *arguments, stdin=subprocess.PIPE, paused=True,
                             env={'ROS_HOME': str(tmp_path), 'PYTHONUNBUFFERED': '1'})
        begun.append(process)
        process.pad = process.do('attach', name=pad, vendor=0x1209) if pad else None
        process.do('go_on')
        return process
    yield start
    for process in begun:
        process.end()


def ended(process):
    return process.popen.wait(20)


def asks(process, words, count=1):
    wait_for(lambda: process.said().count(words) >= count, 20.0, '{!r} in {!r}'.format(
        words, process.said()))


def enter(process):
    process.popen.stdin.write(b'\n')
    process.popen.stdin.flush()


@pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))
def test_end_to_end(terminal, tmp_path):
    process = terminal('rat')
    asks(process, 'let go of everything')
    enter(process)
    asks(process, 'FORWARD')
    process.do('swing', number=process.pad, axis=3, value=1.0)
    asks(process, 'LEFT')
    process.do('swing', number=process.pad, axis=2, value=-1.0)
    for words, button in (('dead-man', 6), ('full speed', None), ('stops all', 1),
                          ('next robot', None), ('previous robot', None), ('selects all', None)):
        asks(process, words)
        if button is None:
            enter(process)
        else:
            process.do('click', number=process.pad, button=button)
    assert ended(process) == 0, process.said()
    path = tmp_path / 'mhri' / 'pads' / 'rat.yaml'
    assert str(path) in process.said()
    profile = parse_profile(path.read_text(encoding='utf-8'), str(path))
    assert (profile.name, profile.forward.index, profile.turn.index) == ('rat', 3, 2)
    assert profile.read([0.0, 0.0, 0.0, 1.0], [0] * 6 + [1]).forward == 1.0
    assert (profile.dead_man, profile.actions) == (6, ((1, 'stop_all'),))
    assert len(profile.match.guids) == 1
    before = path.read_text(encoding='utf-8')
    again = terminal('rat')
    assert ended(again) == 1
    assert 'exists; choose another name, or add --force' in again.said()
    assert path.read_text(encoding='utf-8') == before
    forced = terminal('rat', '--force')
    asks(forced, 'let go of everything')


@pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))
@pytest.mark.parametrize('arguments, said', [
    (['ps3'], 'shipped profile'), (['my pad'], 'is no name for a profile'),
    (['--device', 'wii'], "no 'wii' among 0: Lab rat pad")])
def test_what_is_refused_at_once(terminal, tmp_path, arguments, said):
    process = terminal(*arguments)
    assert ended(process) == 1
    assert said in process.said()
    assert 'Traceback' not in process.said()
    assert list(tmp_path.rglob('*.yaml*')) == []


@pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))
def test_ended_in_the_middle_nothing_is_written(terminal, tmp_path):
    process = terminal()
    asks(process, 'let go of everything')
    process.popen.stdin.close()
    assert ended(process) == 1
    assert 'nothing was written' in process.said()
    pulled = terminal()
    asks(pulled, 'let go of everything')
    pulled.do('detach', number=pulled.pad)
    assert ended(pulled) == 1
    assert 'the pad is lost' in pulled.said()
    assert list(tmp_path.rglob('*.yaml*')) == []


@pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))
def test_without_a_pad(terminal):
    process = terminal(pad=None)
    assert ended(process) == 1
    assert 'none is connected; plug one in' in process.said()
