# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What numbers and waiting look like: words, and the values that bridge a request's time."""
import math

import pytest

from mhri.base import views
from mhri.base.gui import words
from mhri.base.gui.pending import Pace, Pending
from support.clock import Clock

NAN = float('nan')


@pytest.mark.parametrize('function, value, text', [
    (words.age_text, 0.0, '0 ms'),
    (words.age_text, -1.0, '0 ms'),
    (words.age_text, 0.0124, '12 ms'),
    (words.age_text, 0.0996, '100 ms'),
    (words.age_text, 0.9951, '1.0 s'),
    (words.age_text, 3.2, '3.2 s'),
    (words.age_text, 59.96, '1 min'),
    (words.age_text, 7200.0, '2 h'),
    (words.age_text, None, ''),
    (words.age_text, NAN, ''),
    (words.linear_text, 0.314, '0.31 m/s'),
    (words.linear_text, -0.314, 'back 0.31 m/s'),
    (words.linear_text, -0.004, '0.00 m/s'),
    (words.linear_text, None, '–'),
    (words.turn_text, 0.2, 'left 0.20 rad/s'),
    (words.turn_text, -1.234, 'right 1.23 rad/s'),
    (words.turn_text, 0.0, '0.00 rad/s'),
    (words.rate_text, 3.14, '3.14 rad/s'),
    (words.heading_text, math.radians(47), '47 deg'),
    (words.heading_text, -math.pi, '180 deg'),
    (words.heading_text, math.radians(270), '-90 deg'),
    (words.metres_text, -1.254, '-1.25 m'),
    (words.metres_text, -0.001, '0.00 m'),
    (words.battery_text, 0.824, '82 %'),
    (words.battery_text, 1.7, '100 %'),
    (words.battery_text, None, ''),
])
def test_words(function, value, text):
    assert function(value) == text


@pytest.mark.parametrize('speeds, moving, text', [
    ((0.31, 0.2, 0.0), True, '0.31 m/s, left 0.20 rad/s, left 0.20'),
    ((0.0, 0.2, 0.0), True, 'turning left, 0.20 rad/s'),
    ((-0.004, -0.2, 0.0), True, 'turning right, 0.20 rad/s'),
    ((0.0, 0.2, 0.0), False, '0.00 m/s, left 0.20 rad/s, left 0.20'),
    ((0.0, 0.0, 0.0), False, '0.00 m/s, 0.00 rad/s'),
    ((0.0, 0.001, 0.0), True, '0.00 m/s, 0.00 rad/s'), ((0.0, NAN, 0.0), True, '0.00 m/s, –'),
    ((None, 0.2, None), True, '–, left 0.20 rad/s, left 0.20'),
    ((0.0, 0.2, 0.3), True, 'left 0.30 m/s, left 0.20 rad/s, left 0.20')])
def test_a_robot_that_turns_on_the_spot_says_so_and_no_number_is_bare(speeds, moving, text):
    linear, turn, aside = speeds
    view = views.RobotView('bot1', linear_mps=linear, angular_rad_s=turn, lateral_mps=aside,
                           moving=moving, holonomic=bool(aside))
    found = words.motion_texts(view)
    assert ', '.join(filter(None, (*found, *words.turn_shorter(found[1])))) == text
    assert words.motion_texts(view, both=True)[0] == (
        '0.00 m/s   left 0.30 m/s' if aside else found[0])


@pytest.mark.parametrize('speed, shorter', [
    ('0.38 m/s', ('0.38',)), ('back 0.38 m/s', ('back 0.38',)),
    ('turning left', ('turning', 'turns')), (words.UNKNOWN, ())])
def test_a_small_picture_says_how_its_robot_moves_in_the_shortest_words(speed, shorter):
    assert words.motion_shorter(speed) == shorter


@pytest.mark.parametrize('text, shorter', [
    ('centre the stick: it was out of reach', ('centre the stick',)),
    ('NOT CONFIRMED: moves at 0.30 m/s, 0.00 rad/s', ('NOT CONFIRMED',)),
    ('slow link: 120 ms round trip; 8 % of its messages lost',
     ('slow link: 120 ms round trip', 'slow link')),
    ('nothing for 2.5 s', ()), ('', ())])
def test_beginnings(text, shorter):
    assert words.beginnings(text) == shorter


MICROPHONE = views.DeviceView('voice', 'the microphone "USB"', kind='microphone')


@pytest.mark.parametrize('device, promised', [
    (MICROPHONE, True), (None, False), (views.DeviceView('voice'), False),
    (views.DeviceView('voice', note='no microphone: plug one in'), False)])
@pytest.mark.parametrize('heard', [None, views.HeardView('robot forward', 'forward 0.5', True)])
def test_that_stop_is_heard_is_said_only_while_a_microphone_is_open(device, promised, heard):
    text, shorter = words.voice_texts(heard, device)
    assert [part for part in (text, *shorter) if '"stop" is' in part and not promised] == []
    assert '"stop" is' in text or heard is not None or not promised
    if device is not None and device.absent:
        assert text == device.note


@pytest.mark.parametrize('stick, text', [
    ((0.5, 0.0, -0.4), ('forward 0.25 m/s', 'right 0.20 m/s')),
    ((0.0, 1.0, 0.4), ('0.00 m/s', 'left 0.20 m/s, left 1.50 rad/s')),
    ((1.0, 1.0, 0.0), ('forward 0.50 m/s', 'left 1.50 rad/s')),
    ((-0.5, -0.5, 0.0), ('back 0.25 m/s', 'right 0.75 rad/s')),
    ((0.0, 0.0, 0.0), ('0.00 m/s', '0.00 rad/s')),
])
def test_command_texts(stick, text):
    assert words.command_texts(*stick, limits=(0.5, 1.5)) == text


@pytest.mark.parametrize('asked, actual, after_s, shown, left', [
    (None, 'a', 0.0, 'a', None),
    ('b', 'a', 0.0, 'b', 'b'),
    ('b', 'a', 1.99, 'b', 'b'),
    ('b', 'a', 2.0, 'a', None),
    ('b', 'b', 0.5, 'b', None),
    ('b', 'c', 0.5, 'b', 'b'),
])
def test_pending(asked, actual, after_s, shown, left):
    clock = Clock()
    pending = Pending(2.0, clock=clock)
    if asked:
        pending.ask(asked)
    clock.now += after_s
    assert pending.settle(actual) == shown
    assert pending.value == left


def test_pace_lets_four_through_in_a_second():
    clock = Clock()
    pace = Pace(0.25, clock)
    passed = 0
    for _ in range(20):
        passed += pace.due()
        clock.now += 0.05
    assert passed == 4
