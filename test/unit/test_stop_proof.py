# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The proof of a stop: every transition, and no proof that is none."""
import pytest

from mhri.core.robots.link import Motion
from mhri.core.robots.stop_proof import HEARING_S, PATIENCE_S, StopProof
from mhri.core.screen.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED, PROOF_WAITING

REST, MOVES, NAN = Motion(0.0, 0.0), Motion(0.3, 0.0), Motion(float('nan'), 0.0)


def follow(*readings, began=0.0):
    """Return a proof that has taken in (time, motion) readings."""
    proof = StopProof(began)
    for now, motion in readings:
        proof.on_motion(motion, now)
        proof.view(now)
    return proof


def every(seconds, until, motion, begin=0.0):
    """Return readings at a steady rate."""
    count = int(round((until - begin) / seconds))
    return [(begin + seconds * number, motion) for number in range(1, count + 1)]


STOPS = every(0.02, 0.2, MOVES) + every(0.02, 0.3, REST, 0.2)
CASES = {
    'nothing_yet': ([], 0.5, PROOF_WAITING, 'stopping'),
    'still_moving': (every(0.02, 1.0, MOVES), 1.0, PROOF_WAITING, 'stopping'),
    'stopped': (STOPS, 0.3, PROOF_STOPPED, 'stopped in 220 ms'),
    'two_readings_are_no_proof': ([(0.1, REST), (0.12, REST)], 0.13, PROOF_WAITING, 'stopping'),
    'a_move_between_begins_anew': (
        [(0.1, REST), (0.12, REST), (0.14, MOVES), (0.16, REST), (0.18, REST)], 0.19,
        PROOF_WAITING, 'stopping'),
    'nan_is_not_rest': (every(0.02, 0.5, NAN), 0.5, PROOF_WAITING, 'stopping'),
    'never_heard': ([], HEARING_S + 0.001, PROOF_NOT_CONFIRMED,
                    'NOT CONFIRMED: it cannot be heard'),
    'moves_on': (every(0.02, PATIENCE_S + 0.04, MOVES), PATIENCE_S + 0.04, PROOF_NOT_CONFIRMED,
                 'NOT CONFIRMED: moves at 0.30 m/s, 0.00 rad/s'),
    'moves_again': (STOPS + [(0.4, MOVES)], 0.4, PROOF_NOT_CONFIRMED,
                    'NOT CONFIRMED: moves at 0.30 m/s, 0.00 rad/s'),
    'falls_silent': (STOPS, 0.3 + HEARING_S + 0.001, PROOF_NOT_CONFIRMED,
                     'NOT CONFIRMED: it cannot be heard'),
    'late_but_in_the_end': (
        every(0.02, 2.1, MOVES) + every(0.02, 2.2, REST, 2.1), 2.2, PROOF_STOPPED,
        'stopped in 2120 ms'),
}


HALT = 4.0  # when a robot that was held up on the way is heard again
UNSEEN = {
    'at_rest_when_heard_again': (
        every(0.02, 0.1, MOVES) + every(0.02, HALT + 0.1, REST, HALT),
        'standstill seen after 4.0 s'),
    'moved_when_heard_again': (
        every(0.02, 0.1, MOVES) + every(0.02, HALT + 0.1, MOVES, HALT)
        + every(0.02, HALT + 0.2, REST, HALT + 0.1), 'standstill seen after 4.1 s'),
    'proved_before_it_fell_silent': (STOPS + every(0.02, HALT + 0.1, REST, HALT),
                                     'stopped in 220 ms'),
}


@pytest.mark.parametrize('case', sorted(UNSEEN))
def test_the_time_to_the_proof_is_not_called_that_to_the_stop(case):
    """A robot that was not heard in between may have stood still for long."""
    readings, text = UNSEEN[case]
    view = follow(*readings).view(readings[-1][0])
    assert (view.state, view.text) == (PROOF_STOPPED, text)


@pytest.mark.parametrize('case', sorted(CASES))
def test_transition(case):
    """State and words after a row of readings."""
    readings, now, state, text = CASES[case]
    view = follow(*readings).view(now)
    assert (view.state, view.text) == (state, text)


def test_stopped_ms_is_none_before_the_proof():
    """And never negative, were the first reading older than the stop."""
    assert follow((0.1, REST)).stopped_ms is None
    assert follow((4.9, REST), (4.95, REST), (5.1, REST), began=5.0).stopped_ms == 0.0


def test_silence_begins_the_row_anew():
    """Two readings before a silence and one after it are no proof."""
    proof = follow((0.1, REST), (0.12, REST))
    proof.view(5.0)
    proof.on_motion(REST, 5.1)
    assert proof.view(5.1).state == PROOF_NOT_CONFIRMED
    proof.on_motion(REST, 5.12)
    proof.on_motion(REST, 5.14)
    assert proof.view(5.14).state == PROOF_STOPPED


def test_silence_begins_the_row_anew_even_when_nobody_looked():
    """The proof must not depend on how often the panel draws."""
    proof = StopProof(0.0)
    for now in (0.1, 0.12, 30.0):
        proof.on_motion(REST, now)
    assert proof.view(30.0).state != PROOF_STOPPED


def test_a_robot_that_moved_again_is_not_called_stopped_in_the_time_of_the_first_row():
    """\"Stopped in 220 ms\" was refuted at 5 s."""
    proof = follow(*(STOPS + every(0.5, 5.0, MOVES, 0.3) + every(0.02, 5.2, REST, 5.0)))
    assert proof.state == PROOF_STOPPED and proof.stopped_ms > 5000.0


def test_words_do_not_claim_that_a_resting_robot_moves():
    """Heard again, but not yet three times."""
    proof = StopProof(0.0)
    proof.view(1.5)
    proof.on_motion(REST, 1.6)
    assert 'moves at 0.00' not in proof.view(1.6).text
