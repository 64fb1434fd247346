# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is said of a stop: never more than the proofs of the robots bear out."""
import pytest

from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED, PROOF_WAITING, ProofView, RobotView
from mhri.driving.stop_words import NOT_TAKEN, requested_proof, stop_words, UNANSWERED_STOP


def robot(name, state=None, age_s=0.01):
    """Return a robot with a proof in a state."""
    return RobotView(name, age_s=age_s, proof=state and ProofView(state, state))


ONE, TWO = robot('bot1', PROOF_STOPPED), robot('bot2', PROOF_STOPPED)
SLOW, DEAF = robot('bot3', PROOF_WAITING), robot('bot4', PROOF_NOT_CONFIRMED)
CASES = {
    'all': ([ONE, TWO], 'STOPPED - all robots', 'everything is stopped'),
    'one_pending': ([ONE, SLOW], 'STOP ALL in force \u2013 stopping bot3', 'still stopping bot3'),
    'before_the_first_proof': ([robot('bot1')], 'STOP ALL in force \u2013 stopping bot1',
                               'still stopping bot1'),
    'one_in_doubt': ([ONE, SLOW, DEAF], 'STOP ALL in force \u2013 bot4 NOT CONFIRMED',
                     'bot4 NOT CONFIRMED'),
    'never_heard_and_in_doubt': ([ONE, robot('x', PROOF_NOT_CONFIRMED, None)],
                                 'STOP ALL in force \u2013 x NOT CONFIRMED', 'x NOT CONFIRMED'),
    'never_heard': ([ONE, robot('x', None, None)], 'STOPPED - all robots',
                    'everything is stopped'),
    'three_in_doubt': ([robot(name, PROOF_NOT_CONFIRMED) for name in 'abc'],
                       'STOP ALL in force \u2013 a, b, c NOT CONFIRMED', 'a, b, c NOT CONFIRMED'),
    'many_in_doubt': ([robot('b{}'.format(n), PROOF_NOT_CONFIRMED) for n in range(4)],
                      'STOP ALL in force \u2013 4 robots NOT CONFIRMED', '4 robots NOT CONFIRMED'),
    'nobody': ([], 'STOP ALL in force', 'stop all is in force; release it'),
    'nobody_heard': ([robot('x', None, None)], 'STOP ALL in force', 'stop all is in force'),
}


@pytest.mark.parametrize('case', sorted(CASES))
def test_words(case):
    robots, headline, sentence = CASES[case]
    words = stop_words(robots)
    assert words.headlines[0] == headline and sentence in words.sentence and words.note
    proved = case in ('all', 'never_heard')
    assert proved == any('STOPPED' in text for text in words.headlines)


def test_a_stop_that_the_drive_has_not_confirmed():
    assert [stop_words([ONE], False, answers) for answers in (True, False)] == [
        NOT_TAKEN, UNANSWERED_STOP]
    assert [requested_proof(answers).state for answers in (True, False)] == [
        PROOF_WAITING, PROOF_NOT_CONFIRMED]


@pytest.mark.parametrize('proof', [PROOF_WAITING, PROOF_NOT_CONFIRMED])
def test_the_note_counts_them(proof):
    one, two = (stop_words([robot(name, proof) for name in names]).note
                for names in (('a',), ('a', 'b')))
    assert one.replace('it is', 'they are').replace('it may', 'they may') == two != one


@pytest.mark.parametrize('case', sorted(CASES))
def test_fewer_words_are_fewer(case):
    found = stop_words(CASES[case][0])
    for texts in (found.headlines, (found.note, *found.shorter)):
        assert list(texts) == sorted(texts, key=len, reverse=True) and len(texts[-1]) <= 21


@pytest.mark.parametrize('name', ['bot4', 'the_long_name_of_a_robot'])
def test_what_is_in_doubt_stays_in_the_shortest(name):
    words = stop_words([ONE, robot(name, PROOF_NOT_CONFIRMED)])
    assert all('NOT CONFIRMED' in text for text in words.headlines)
    assert words.headlines[-2].split(' NOT')[0] == min(name, '1 robot', key=len)
    assert len(words.headlines[-1]) <= len('NOT CONFIRMED')
