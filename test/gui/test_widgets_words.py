# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What numbers and waiting look like: words, and the values that bridge a request's time."""
import math

import pytest
from python_qt_binding.QtGui import QFont, QFontDatabase, QFontMetrics

from mhri.base import views
from mhri.base.gui import theme, words
from mhri.base.gui.pending import Pace, Pending

NAN = float('nan')


@pytest.mark.parametrize('function, value, text', [
    (words.age_text, 0.0, '0 ms'),
    (words.age_text, -1.0, '0 ms'),
    (words.age_text, 0.0124, '12 ms'),
    (words.age_text, 0.0994, '99 ms'),
    (words.age_text, 0.0996, '100 ms'),
    (words.age_text, 0.123, '120 ms'),
    (words.age_text, 0.9951, '1.0 s'),
    (words.age_text, 3.2, '3.2 s'),
    (words.age_text, 59.96, '1 min'),
    (words.age_text, 240.0, '4 min'),
    (words.age_text, 7200.0, '2 h'),
    (words.age_text, None, ''),
    (words.age_text, NAN, ''),
    (words.linear_text, 0.314, '0.31 m/s'),
    (words.linear_text, -0.314, 'back 0.31 m/s'),
    (words.linear_text, -0.004, '0.00 m/s'),
    (words.linear_text, None, '–'),
    (words.linear_text, math.inf, '–'),
    (words.turn_text, 0.2, 'left 0.20 rad/s'),
    (words.turn_text, -1.234, 'right 1.23 rad/s'),
    (words.turn_text, 0.0, '0.00 rad/s'),
    (words.rate_text, 3.14, '3.14 rad/s'),
    (words.heading_text, math.radians(47), '47 deg'),
    (words.heading_text, -math.pi, '180 deg'),
    (words.heading_text, math.radians(270), '-90 deg'),
    (words.heading_text, None, '–'),
    (words.metres_text, -1.254, '-1.25 m'),
    (words.metres_text, -0.001, '0.00 m'),
    (words.metres_text, NAN, '–'),
    (words.battery_text, 0.824, '82 %'),
    (words.battery_text, 1.7, '100 %'),
    (words.battery_text, None, ''),
])
def test_words(function, value, text):
    assert function(value) == text


@pytest.mark.parametrize('text, shorter', [
    ('centre the stick: it was out of reach', ('centre the stick',)),
    ('NOT CONFIRMED: moves at 0.30 m/s, 0.00 rad/s', ('NOT CONFIRMED',)),
    ('slow link: 120 ms round trip; 8 % of its messages lost',
     ('slow link: 120 ms round trip', 'slow link')),
    ('standstill seen after 4.1 s', ('standstill seen',)),
    ('nothing for 2.5 s', ()), ('', ())])
def test_beginnings(text, shorter):
    assert words.beginnings(text) == shorter


@pytest.mark.parametrize('heard, shorter', [
    (views.HeardView('robot forward', 'forward 0.5', True), 'forward 0.5'),
    (views.HeardView('robot fly'), 'not a command'),
    (views.HeardView('x', reason='no wake word'), 'no wake word')])
def test_of_what_was_heard_the_outcome_is_what_matters(heard, shorter):
    assert words.heard_shorter(heard)[-1] == shorter
    assert shorter in words.heard_text(heard)


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


@pytest.mark.parametrize('link, age_s, text', [
    (views.LIVE, 0.012, 'live 12 ms'),
    (views.SILENT, 3.2, 'silent 3.2 s'),
    (views.GONE, 3.2, 'gone'),
    (views.WAITING, None, 'waiting'),
])
def test_link_text(link, age_s, text):
    assert words.link_text(views.RobotView('bot1', link=link, age_s=age_s)) == text


@pytest.mark.parametrize('proof, age', [
    (None, ''), (views.ProofView(views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED'), '3.2 s')])
def test_an_age_that_a_sentence_says_is_not_said_twice(proof, age):
    view = views.RobotView('bot1', link=views.SILENT, age_s=3.2, note='nothing for 3.2 s',
                           proof=proof)
    assert words.link_age(view) == age


@pytest.mark.parametrize('stick, text', [
    ((1.0, 1.0), ('forward 0.50 m/s', 'left 1.50 rad/s')),
    ((-0.5, -0.5), ('back 0.25 m/s', 'right 0.75 rad/s')),
    ((0.0, 0.0), ('0.00 m/s', '0.00 rad/s')),
])
def test_command_texts(stick, text):
    assert words.command_texts(*stick, limits=(0.5, 1.5)) == text


class Clock:
    """A clock that is set by hand."""

    now = 100.0

    def __call__(self):
        return self.now


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
    pending = Pending(2.0, clock)
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


def test_digits_are_all_as_wide_in_every_font_there_is(application):
    for family in QFontDatabase().families():
        metrics = QFontMetrics(theme.number_font(QFont(family, 11)))
        assert len({metrics.horizontalAdvance(digit) for digit in '0123456789'}) == 1, family


def test_a_voice_that_is_not_understood_reads_what_to_do():
    """Where there is room for it; else that it is not understood."""
    advice = 'not understood 3 times: speak slower and close to the microphone'
    heard = views.HeardView('', '', False, advice)
    assert words.heard_text(heard) == advice
    assert words.heard_shorter(heard) == (advice, 'not understood 3 times')
