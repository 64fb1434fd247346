# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A voice that is not understood is told so, and what to do; talk is told nothing."""
import pytest

from mhri.voice.attempts import ATTEMPTS, Attempts, LONGEST_S, RECENT_S
from mhri.voice.speech import Heard, NO_COMMAND, NOT_SURE

TOLD = 'not understood 3 times: speak slower and close to the microphone, '
UNSURE = Heard('robot drive forward', 'forward', False, NOT_SURE, 0.2)
ATTEMPT = UNSURE, 1.5, 2.0, False


def say(*attempts):
    """Return the last reason; an attempt: (heard, length, seconds since the one before, held)."""
    counted, now, reason = Attempts(), 100.0, ''
    for heard, lasted_s, after_s, held in attempts:
        now += after_s
        judged = counted.judge(heard, lasted_s, now, held)
        reason = judged.reason
        assert (judged.text, judged.accepted) == (heard.text, heard.accepted)
    return reason


def test_the_third_in_a_row_says_what_to_do():
    assert say(*[ATTEMPT] * (ATTEMPTS - 1)) == NOT_SURE
    for more in (0, 2):
        assert say(*[ATTEMPT] * (ATTEMPTS + more)) == (
            TOLD + 'hold push-to-talk, or teach it your voice')


def test_who_holds_push_to_talk_is_not_told_to():
    held = UNSURE, 1.5, 2.0, True
    assert say(ATTEMPT, ATTEMPT, held) == TOLD + 'drive another way, or teach it your voice'


def test_what_fits_no_command_counts_as_well():
    assert say(ATTEMPT, ATTEMPT, (Heard('', reason=NO_COMMAND), 1.0, 2.0, False)).startswith(TOLD)


BETWEEN = {'a command': (Heard('robot left', 'left', True), 1.0, 1.0, False),
           'one without its wake word': (Heard('left', 'left', False, 'no wake word'), 1.0, 1.0,
                                         False),
           'a long silence': (UNSURE, 1.0, RECENT_S, False)}


@pytest.mark.parametrize('name', sorted(BETWEEN))
def test_what_is_understood_or_long_ago_begins_anew(name):
    assert not say(ATTEMPT, ATTEMPT, BETWEEN[name], ATTEMPT).startswith(TOLD)


def test_long_talk_is_no_attempt_unless_push_to_talk_is_held():
    talk = UNSURE, LONGEST_S + 0.1, 2.0, False
    assert say(*[talk] * ATTEMPTS) == NOT_SURE
    assert say(*[talk[:3] + (True,)] * ATTEMPTS).startswith(TOLD)


def test_clear_forgets():
    attempts = Attempts()
    for _ in range(ATTEMPTS - 1):
        attempts.judge(UNSURE, 1.0, 5.0, False)
    attempts.clear()
    assert attempts.judge(UNSURE, 1.0, 5.0, False).reason == NOT_SURE


def test_whose_voice_was_taught_is_not_told_to_teach_it():
    attempts = Attempts()
    for _ in range(ATTEMPTS):
        heard = attempts.judge(UNSURE, 1.5, 5.0, False, taught=True)
    assert heard.reason == TOLD + 'or hold push-to-talk'
