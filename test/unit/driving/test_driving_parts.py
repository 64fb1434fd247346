# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The small rules beside the arbiter: who owns a topic, a sleep, tasks, advice."""
from dataclasses import replace

import pytest

from mhri.base.reasons import Reason
from mhri.base.sleep_detector import DEAF_S, NEW_S, SleepDetector, SLEPT_S
from mhri.driving.advice import advice, SourceStatus
from mhri.driving.sources import Source, TWIST
from mhri.driving.task_relay import MAX_ROBOTS, NOTHING, PASS, PASS_ZEROS, TaskRelay, team_problem
from mhri.driving.topic_owner import LiveMessages, TopicOwner

A, B = '/a', '/b'


def test_the_first_who_speaks_owns():
    ownership = TopicOwner()
    assert ownership.admits(A, lambda: {A, B})
    assert not ownership.admits(B, lambda: {A, B})
    assert ownership.admits(A, lambda: {A, B})


def test_the_owner_gone_frees_it():
    ownership = TopicOwner()
    ownership.admits(A, lambda: {A, B})
    assert ownership.admits(B, lambda: {B})
    assert not ownership.admits(A, lambda: {A, B}), 'back, it is the second one'


def test_whoever_takes_control_owns_it_as_soon_and_as_long_as_it_is_connected():
    ownership = TopicOwner()
    ownership.admits(A, lambda: {A})
    assert not ownership.take(B, {A}), 'it is not there yet'
    assert ownership.admits(A, lambda: {A})
    assert ownership.take(B, {A, B}) and not ownership.take(B, {A, B})
    assert not ownership.admits(A, lambda: {A, B}) and ownership.admits(B, lambda: {A, B})
    assert not ownership.admits(A, lambda: {A}), 'it has lost control'
    assert ownership.take(A, {A, B}) and ownership.admits(A, lambda: {A, B})


def test_whoever_has_taken_control_owns_it_from_its_first_message():
    ownership = TopicOwner()
    ownership.admits(A, lambda: {A})
    ownership.take(B, {A})
    assert ownership.admits(A, lambda: {A}) and ownership.admits(B, lambda: {A, B})
    assert not ownership.admits(A, lambda: {A, B})


def test_whoever_was_refused_does_not_get_it_by_waiting():
    ownership = TopicOwner()
    ownership.admits(A, lambda: {A, B})
    assert not ownership.admits(B, lambda: {A, B})
    assert not ownership.admits(B, lambda: {B}), 'the first has gone'
    assert ownership.admits(A, lambda: {A, B}), 'and is back'
    ownership.admits(A, lambda: {A})
    assert ownership.admits(B, lambda: {B}), 'started anew'


def test_a_latched_message_of_the_past_is_no_wish():
    live, link = LiveMessages(), object()
    assert not live.is_live('/panel', link, latches=True), 'the first on its connection'
    assert live.is_live('/panel', link, latches=True)
    assert not live.is_live('/panel', object(), latches=True), 'the first on another one'
    assert live.is_live('/script', object(), latches=False)
    live.forget('/panel')
    assert not live.is_live('/panel', link, latches=True)


def test_a_loop_that_comes_round_has_not_slept():
    pulse = SleepDetector(100.0)
    for count in range(100):
        now = 100.0 + 0.1 * count
        assert not pulse.slept(now) and pulse.is_new(now)
        pulse.beat(now)


def test_a_sleep_is_told_once_and_deafens():
    pulse = SleepDetector(100.0)
    woken = 100.0 + SLEPT_S
    assert pulse.slept(woken) and not pulse.slept(woken)
    assert pulse.discards_backlog(woken + DEAF_S - 0.001) and not pulse.is_new(woken)
    pulse.beat(woken + DEAF_S)
    assert not pulse.discards_backlog(woken + DEAF_S) and pulse.is_new(woken + DEAF_S)


def test_what_waited_longer_than_a_quarter_second_is_not_new():
    pulse = SleepDetector(100.0)
    assert pulse.is_new(100.0 + NEW_S - 0.001) and not pulse.is_new(100.0 + NEW_S)
    assert (SLEPT_S, DEAF_S, NEW_S) == (0.5, 0.3, 0.25)


GOOD = (['bot1', 'bot2'], [(0.1,) * 6, (0.0,) * 6])
BAD_TEAMS = {
    'lengths': (['bot1'], []), 'too_many': (['b{}'.format(n) for n in range(MAX_ROBOTS + 1)],
                                            [(0.0,) * 6] * (MAX_ROBOTS + 1)),
    'name': (['bot/1'], [(0.0,) * 6]), 'twice': (['a', 'a'], [(0.0,) * 6] * 2),
    'not_finite': (['a'], [(0.0, 0.0, float('nan'), 0.0, 0.0, 0.0)])}


@pytest.mark.parametrize('kind', sorted(BAD_TEAMS))
def test_a_team_that_cannot_be_is_refused_and_counted(kind):
    relay = TaskRelay()
    verdict, words = relay.judge(*BAD_TEAMS[kind], False, True, True)
    assert verdict == NOTHING and words and len(words) < 300
    assert relay.refused == {kind: 1}
    assert team_problem(*GOOD) is None and MAX_ROBOTS == 100


def test_a_name_of_a_megabyte_is_cut():
    assert len(team_problem(['x' * 1000000], [(0.0,) * 6])[1]) < 300


@pytest.mark.parametrize('stopped, enabled, is_new, verdict', [
    (False, True, True, PASS), (True, True, True, NOTHING), (False, True, False, NOTHING),
    (False, False, True, NOTHING), (True, False, False, NOTHING)])
def test_what_is_passed_on(stopped, enabled, is_new, verdict):
    relay = TaskRelay()
    assert relay.judge(*GOOD, stopped, enabled, is_new) == (verdict, '')
    assert sum(relay.held.values()) == (verdict != PASS)


def test_a_released_pedal_stops_robots_on_a_task_once():
    relay = TaskRelay()
    assert relay.judge(*GOOD, False, True, True)[0] == PASS
    verdicts = [relay.judge(*GOOD, False, False, True)[0] for _ in range(3)]
    assert verdicts == [PASS_ZEROS, NOTHING, NOTHING]
    assert relay.held == {'enabling': 3}


PAD = Source('pad', 'Pad', '/joy', None)
CMD = replace(PAD, kind=TWIST)
NODE = frozenset(['/joy_node'])


@pytest.mark.parametrize('source, waits_for, heard, said', [
    (PAD, '', SourceStatus(NODE, spoke=True), ('', '')),
    (PAD, 'neutral', SourceStatus(NODE, spoke=True), ('', '')),
    (PAD, 'source', SourceStatus(), ('no_publisher', '/joy')),
    (PAD, 'source', SourceStatus(NODE), ('nothing_sent', '/joy_node')),
    (PAD, 'source', SourceStatus(NODE, spoke=True), ('fell_silent', '/joy_node')),
    (replace(PAD, topic='/mux_in/joy'), 'source', SourceStatus(NODE, spoke=True),
     ('screen_unheard', '/joy_node')),
    (PAD, 'source', SourceStatus(stranger=('/teleop', 'geometry_msgs/Twist')),
     ('sends_twist', '/teleop')),
    (CMD, 'source', SourceStatus(stranger=('/joy_node', 'sensor_msgs/Joy')),
     ('sends_joy', '/joy_node')),
    (CMD, 'source', SourceStatus(stranger=('/talker', 'std_msgs/String')),
     ('sends_other', '/talker')),
    (PAD, '', SourceStatus(NODE, rival='/b'), ('rival', '/b')),
    (PAD, 'source', SourceStatus(NODE, refused='too few axes'), ('bad_input', 'too few axes'))])
def test_the_advice_is_a_code_with_words_and_what_it_is_about(source, waits_for, heard, said):
    assert advice(source, waits_for, heard) == said
    assert (Reason(said[0], said[1:]).what in said) == (not said[0]), 'a code has words'


def test_who_was_displaced_has_its_source_back_once_another_one_takes_control():
    ownership, both = TopicOwner(), {'/pedal', '/attacker'}

    def there():
        return both

    assert ownership.admits('/pedal', there) and not ownership.admits('/attacker', there)
    for changed in (True, False, False):
        assert ownership.take('/attacker', both) == changed
        assert ownership.admits('/attacker', there) and not ownership.admits('/pedal', there)
    assert ownership.take('/panel', both)
    assert ownership.admits('/pedal', there) and not ownership.admits('/attacker', there)
