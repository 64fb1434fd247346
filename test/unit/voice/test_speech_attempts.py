# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Advice for an operator whose voice is not understood; none for talk."""
import pytest

from mhri.voice.attempts import ATTEMPTS, Attempts, MAX_COMMAND_S, RECENT_S
from mhri.voice.speech import NO_COMMAND, NOT_SURE, Utterance

UNSURE = Utterance('robot drive forward', 'forward', False, NOT_SURE, 0.2)
# (heard, length [s], time since the one before [s], push-to-talk held)
ATTEMPT = UNSURE, 1.5, 2.0, False
HELD = UNSURE, 1.5, 2.0, True
TALK = UNSURE, MAX_COMMAND_S + 0.1, 2.0, False


def reason_after(attempts, taught=False):
    counted, now, reason = Attempts(), 100.0, ''
    for heard, lasted_s, after_s, held in attempts:
        now += after_s
        judged = counted.judge(heard, lasted_s, now, held, taught)
        reason = judged.reason
        assert (judged.text, judged.accepted) == (heard.text, heard.accepted)
    return reason


@pytest.mark.parametrize('attempts', [
    [ATTEMPT] * ATTEMPTS, [ATTEMPT] * (ATTEMPTS + 2), [ATTEMPT, ATTEMPT, HELD],
    [ATTEMPT, ATTEMPT, (Utterance('', reason=NO_COMMAND), 1.0, 2.0, False)],
    [TALK[:3] + (True,)] * ATTEMPTS])
@pytest.mark.parametrize('taught', [False, True])
def test_the_third_in_a_row_gets_advice_that_can_be_followed(attempts, taught):
    reason = reason_after(attempts, taught)
    assert len(reason) > len(NOT_SURE)
    assert ('push-to-talk' in reason) == (not attempts[-1][3])
    assert ('teach' in reason) == (not taught)


@pytest.mark.parametrize('attempts', [
    [ATTEMPT] * (ATTEMPTS - 1), [TALK] * ATTEMPTS,
    [ATTEMPT, ATTEMPT, (Utterance('robot left', 'left', True), 1.0, 1.0, False), ATTEMPT],
    [ATTEMPT, ATTEMPT, (Utterance('left', 'left', False, 'no wake word'), 1.0, 1.0, False),
     ATTEMPT],
    [ATTEMPT, ATTEMPT, (UNSURE, 1.0, RECENT_S, False), ATTEMPT]])
def test_no_advice_after_too_few_or_talk_or_a_command_or_a_long_silence(attempts):
    assert reason_after(attempts) == NOT_SURE
