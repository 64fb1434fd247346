# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a spoken command may do: how long it moves, what wakes it, and that a stop always works."""
import math
from pathlib import Path

import pytest

from mhri.voice.grammar import Grammar, STOP
from mhri.voice.language import parse_language
from mhri.voice.speech import (
    MAX_AGE_S, MAX_COMPUTED_S, NO_COMMAND, NOT_SURE, REST, STOP_RECORDING_S, SURE, SURE_OF_STOP,
    SURE_WHEN_HELD, VoiceRules)

PATH = Path(__file__).resolve().parents[3] / 'resource' / 'voice' / 'english.yaml'
LANGUAGE = parse_language(PATH.read_text(), str(PATH))
GRAMMAR = Grammar(LANGUAGE, ['bot1', 'bot2'], {'bot', 'lamp', 'on'}.__contains__,
                  [('light', 'lamp', None, ['on'])])
FORWARD = (0.0, 0.5)


class Talker:
    """Somebody who talks: an utterance takes a second, and is heard at ``now``."""

    def __init__(self):
        self.rules = VoiceRules(LANGUAGE)
        self.now = 100.0

    def say(self, text, confidence=0.9, lasts_s=1.0, **late):
        began, self.now = self.now, self.now + lasts_s
        return self.rules.judge(text, GRAMMAR.parse(text), confidence, began, self.now, **late)

    def stick(self, later_s=0.0):
        return self.rules.stick(self.now + later_s)


@pytest.fixture
def talk():
    return Talker()


STICKS = {'robot drive forward': (0.0, 0.5), 'robot go back': (0.0, -0.5),
          'robot turn left': (0.5, 0.0), 'robot right': (-0.5, 0.0),
          'robot drive forward faster': (0.0, 0.75), 'robot turn right slower': (-0.25, 0.0)}


@pytest.mark.parametrize('text', sorted(STICKS))
def test_a_drive_moves_for_two_seconds_and_no_longer(talk, text):
    heard = talk.say(text)
    assert heard.accepted and heard.act is None and heard.reason == ''
    assert talk.stick() == talk.stick(1.999) == STICKS[text]
    assert talk.stick(2.0) == REST
    assert talk.rules.next_change(talk.now) == math.inf  # It has been at rest since.


def test_a_little_moves_for_a_shorter_time(talk):
    talk.say('robot drive forward a little')
    assert talk.rules.next_change(talk.now) == pytest.approx(0.7)
    assert talk.stick(0.69) == FORWARD
    assert talk.stick(0.7) == REST


def test_said_again_it_goes_on(talk):
    talk.say('robot drive forward')
    talk.say('robot drive forward')
    assert talk.stick(1.9) == FORWARD
    assert talk.stick(2.1) == REST
    talk.say('robot turn left')
    assert talk.stick() == (0.5, 0.0), 'another direction replaces it'


def test_the_pace_stays_within_its_limits(talk):
    for fraction in (0.75, 1.0, 1.0):
        assert talk.say('robot faster').command == 'faster {:.2f}'.format(fraction)
    assert talk.stick() == REST, 'a pace alone moves nothing'
    for fraction in (0.75, 0.5, 0.25, 0.25):
        talk.say('robot slower')
        assert talk.rules.fraction == fraction
    talk.say('robot drive forward')
    talk.say('robot faster')
    assert talk.stick(1.9) == FORWARD, 'while it moves, a pace goes on with it'
    talk.say('robot faster')
    talk.rules.reset()
    assert talk.rules.fraction == 0.5


REFUSED = [('', 0.0, NO_COMMAND), ('robot drive forward', SURE - 0.01, NOT_SURE),
           ('robot drive forward', math.nan, NOT_SURE), ('stop', SURE_OF_STOP - 0.01, NOT_SURE),
           ('stop recording', SURE_OF_STOP - 0.01, NOT_SURE), ('drive forward', 0.9, 'wake word'),
           ('select bot one', 0.9, 'wake word'), ('use joystick', 0.9, 'wake word')]


@pytest.mark.parametrize('text, confidence, reason', REFUSED)
def test_refused(talk, text, confidence, reason):
    """Each with a reason; a motion that was going on goes on."""
    talk.say('robot drive forward')
    heard = talk.say(text, confidence)
    assert not heard.accepted and reason in heard.reason and heard.act is None
    assert heard.text == text
    assert talk.stick() == FORWARD


def test_the_wake_word_alone_opens_the_ear_for_one_command(talk):
    assert talk.say('robot').command == 'wake'
    talk.now += LANGUAGE.wake_window_s - 0.1
    assert talk.say('drive forward').accepted
    assert not talk.say('drive forward').accepted, 'one command, not two'
    talk.say('robot')
    talk.now += LANGUAGE.wake_window_s + 0.1
    assert not talk.say('drive forward').accepted, 'it is forgotten'
    talk.say('robot')
    talk.say('')
    assert not talk.say('drive forward').accepted, 'talk came after it'


def test_push_to_talk_replaces_the_wake_word(talk):
    talk.rules.push_to_talk(True, talk.now)
    assert talk.say('drive forward').accepted
    talk.rules.push_to_talk(False, talk.now)
    talk.now += 0.1
    assert not talk.say('turn left').accepted


def test_with_push_to_talk_less_certain_words_are_believed(talk):
    """Who holds it does not talk to somebody else."""
    unsure = (SURE + SURE_WHEN_HELD) / 2.0
    assert not talk.say('robot drive forward', unsure).accepted
    talk.rules.push_to_talk(True, talk.now)
    assert not talk.say('drive forward', SURE_WHEN_HELD - 0.01).accepted
    assert not talk.say('drive forward', math.nan).accepted
    assert talk.say('drive forward', unsure).accepted


def test_push_to_talk_let_go_during_the_command_still_counts(talk):
    talk.rules.push_to_talk(True, talk.now - 0.5)
    talk.rules.push_to_talk(False, talk.now + 0.5)
    assert talk.say('drive forward').accepted


def test_push_to_talk_pressed_after_the_command_does_not_count(talk):
    """But a moment late it does."""
    talk.rules.push_to_talk(True, talk.now + 0.5)
    assert not talk.say('drive forward').accepted
    talk.rules.push_to_talk(False, talk.now)
    talk.now += 1.0
    talk.rules.push_to_talk(True, talk.now + 0.2)
    assert talk.say('drive forward').accepted


def test_push_to_talk_that_is_not_repeated_ends(talk):
    """Whoever holds it may have been killed."""
    talk.rules.push_to_talk(True, talk.now)
    talk.now += LANGUAGE.push_to_talk_s + 0.1
    assert not talk.say('drive forward').accepted
    talk.rules.push_to_talk(True, talk.now)
    assert talk.say('drive forward').accepted


# A stop, spotted while it is spoken, and in a whole utterance.

def test_a_spotted_stop_rests_at_once(talk):
    talk.say('robot drive forward')
    assert talk.rules.spotted_stop(talk.now, False)
    assert talk.stick() == REST


@pytest.mark.parametrize('text', ('stop', 'robot stop', 'please stop', 'stop the robots'))
def test_a_recognised_stop_needs_no_wake_word_and_little_confidence(talk, text):
    talk.say('robot drive forward')
    heard = talk.say(text, SURE_OF_STOP)
    assert heard.accepted and heard.act.kind == STOP and heard.command == 'stop'
    assert talk.stick() == REST


def test_a_stop_in_a_sentence_that_is_refused_is_a_stop(talk):
    """"stop recording" without the wake word might have been a stop."""
    talk.say('robot drive forward')
    heard = talk.say('stop recording')
    assert heard.act.kind == STOP and talk.stick() == REST


def test_no_motion_from_an_utterance_with_a_stop_in_it(talk):
    talk.rules.spotted_stop(talk.now + 0.5, False)
    heard = talk.say('robot drive forward')
    assert not heard.accepted and 'stop' in heard.reason
    assert talk.stick() == REST
    assert talk.say('robot drive forward').accepted, 'the next one counts again'


def test_stop_recording_stands_still_but_does_not_stop_all(talk):
    talk.say('robot drive forward')
    assert not talk.rules.spotted_stop(talk.now + 0.4, True)
    assert talk.stick(0.4) == REST
    assert talk.rules.next_change(talk.now + 0.4) == pytest.approx(STOP_RECORDING_S)
    heard = talk.say('robot stop recording')
    assert heard.accepted and heard.act.action == 'stop_recording'
    assert not talk.rules.take_due_stop(talk.now + 10.0)


@pytest.mark.parametrize('text, confidence', (
    ('robot stop recording', 0.2), ('', 0.0), ('robot select all', 0.9), ('robot stop', 0.9)))
def test_a_stop_that_waited_is_due_with_anything_else(talk, text, confidence):
    talk.rules.spotted_stop(talk.now + 0.4, True)
    assert talk.say(text, confidence).act.kind == STOP


def test_a_stop_that_waited_is_due_after_a_while_or_when_said_twice(talk):
    talk.rules.spotted_stop(talk.now, True)
    assert not talk.rules.take_due_stop(talk.now + STOP_RECORDING_S - 0.01)
    assert talk.rules.take_due_stop(talk.now + STOP_RECORDING_S)
    assert not talk.rules.take_due_stop(talk.now + STOP_RECORDING_S), 'once'
    talk.rules.spotted_stop(talk.now, True)
    assert talk.rules.spotted_stop(talk.now, True)


WISHES = {'robot select bot two': ('panel', 'select', ('bot2',)),
          'robot select only one and two': ('panel', 'only', ('bot1', 'bot2')),
          'robot select none': ('panel', 'select_none', ()),
          'robot lamp on': ('panel', 'accessory', ()),
          'robot record': ('panel', 'record', ()), 'robot use pedal': ('mode', 'pedal', ())}


@pytest.mark.parametrize('text', sorted(WISHES))
def test_wishes_go_to_others(talk, text):
    heard = talk.say(text)
    assert heard.accepted
    assert (heard.act.kind, heard.act.action, heard.act.robots) == WISHES[text]
    assert talk.stick() == REST


@pytest.mark.parametrize('text', (
    'robot drive forward', 'robot faster', 'robot turn left', 'robot lamp on'))
def test_what_was_said_too_long_ago_moves_nothing(talk, text):
    talk.say('robot drive forward')
    talk.now += 10.0
    heard = talk.say(text, age_s=MAX_AGE_S + 0.1)
    assert not heard.accepted and heard.reason and talk.stick() == REST
    assert talk.say(text, age_s=MAX_AGE_S - 0.1).accepted


@pytest.mark.parametrize('late, accepted', [
    ({'age_s': 2.0, 'computed_s': 1.2}, True), ({'age_s': 2.0, 'computed_s': 0.8}, False),
    ({'age_s': 2.0, 'computed_s': 1.2, 'spoken_on': True}, False),
    # What is as new as on any computer needs no more.
    ({'age_s': MAX_AGE_S, 'computed_s': 1.2, 'spoken_on': True}, True),
    ({'age_s': 60.0, 'computed_s': 60.0}, False),
    ({'age_s': MAX_AGE_S + MAX_COMPUTED_S - 0.1, 'computed_s': 60.0}, True),
    ({'age_s': MAX_AGE_S + MAX_COMPUTED_S + 0.1, 'computed_s': 60.0}, False)])
def test_a_slow_computer_hears_late_but_nothing_waits(talk, late, accepted):
    heard = talk.say('robot drive forward', **late)
    assert heard.accepted == accepted and (talk.stick() != REST) == accepted
    assert accepted or heard.reason


@pytest.mark.parametrize('text', ('stop', 'robot stop', 'robot drive stop'))
def test_a_stop_is_never_too_old(talk, text):
    talk.say('robot drive forward')
    assert talk.say(text, age_s=60.0, spoken_on=True).act.kind == STOP and talk.stick() == REST


def test_a_wake_word_that_waited_wakes_for_no_longer(talk):
    talk.say('robot', age_s=60.0)
    assert not talk.say('drive forward').accepted
