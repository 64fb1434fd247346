# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The small rules beside the arbiter: who owns a topic, a sleep, a stop that comes back, tasks."""
from dataclasses import replace

import pytest

from mhri.base.pulse import DEAF_S, NEW_S, Pulse, SLEPT_S
from mhri.driving.advice import advice, Heard
from mhri.driving.ownership import Ownership
from mhri.driving.sources import JOY, Source, TWIST
from mhri.driving.stop_echo import DOUBT_S, StopEcho
from mhri.driving.task_relay import MOST_ROBOTS, NOTHING, PASS, PASS_ZEROS, TaskRelay, team_problem

A, B = '/a', '/b'


def test_the_first_who_speaks_owns():
    ownership = Ownership()
    assert ownership.admits(A, {A, B})
    assert not ownership.admits(B, {A, B})
    assert ownership.admits(A, {A, B})


def test_the_owner_gone_frees_it():
    ownership = Ownership()
    ownership.admits(A, {A, B})
    assert ownership.admits(B, {B})
    assert not ownership.admits(A, {A, B}), 'back, it is the second one'


def test_whoever_takes_control_owns_it_as_soon_and_as_long_as_it_is_connected():
    ownership = Ownership()
    ownership.admits(A, {A})
    assert not ownership.take(B, {A}), 'it is not there yet'
    assert ownership.admits(A, {A})
    assert ownership.take(B, {A, B}) and not ownership.take(B, {A, B})
    assert not ownership.admits(A, {A, B}) and ownership.admits(B, {A, B})
    assert not ownership.admits(A, {A}), 'it has lost control'
    assert ownership.take(A, {A, B}) and ownership.admits(A, {A, B})


def test_whoever_was_refused_does_not_get_it_by_waiting():
    ownership = Ownership()
    ownership.admits(A, {A, B})
    assert not ownership.admits(B, {A, B})
    assert not ownership.admits(B, {B}), 'the first has gone'
    assert ownership.admits(A, {A, B}), 'and is back'
    ownership.admits(A, {A})
    assert ownership.admits(B, {B}), 'started anew'


def test_a_loop_that_comes_round_has_not_slept():
    pulse = Pulse(100.0)
    for count in range(100):
        now = 100.0 + 0.1 * count
        assert not pulse.slept(now) and pulse.is_new(now)
        pulse.beat(now)


def test_a_sleep_is_told_once_and_deafens():
    pulse = Pulse(100.0)
    woken = 100.0 + SLEPT_S
    assert pulse.slept(woken) and not pulse.slept(woken)
    assert pulse.deaf(woken + DEAF_S - 0.001) and not pulse.is_new(woken)
    pulse.beat(woken + DEAF_S)
    assert not pulse.deaf(woken + DEAF_S) and pulse.is_new(woken + DEAF_S)


def test_what_waited_longer_than_a_quarter_second_is_not_new():
    pulse = Pulse(100.0)
    assert pulse.is_new(100.0 + NEW_S - 0.001) and not pulse.is_new(100.0 + NEW_S)


def test_the_first_word_of_the_gates_brings_a_stop_back():
    assert StopEcho().must_stop(True, False, 100.0)
    assert not StopEcho().must_stop(True, True, 100.0), 'it is in force'
    assert not StopEcho().must_stop(False, False, 100.0)


def test_later_they_have_to_say_so_for_a_second():
    echo = StopEcho()
    echo.must_stop(False, False, 99.0)
    assert not echo.must_stop(True, False, 100.0)
    assert not echo.must_stop(True, False, 100.0 + DOUBT_S)
    assert echo.must_stop(True, False, 100.001 + DOUBT_S)
    assert not echo.must_stop(False, False, 102.0)
    assert not echo.must_stop(True, False, 102.1), 'counted anew'


@pytest.mark.parametrize('heard_before', [True, False])
def test_a_release_is_not_taken_back_within_a_second(heard_before):
    echo = StopEcho()
    if heard_before:
        echo.must_stop(True, True, 90.0)
    echo.on_release(100.0)
    assert not echo.must_stop(True, False, 100.0 + DOUBT_S)
    assert echo.must_stop(True, False, 102.1 + DOUBT_S)


GOOD = (['bot1', 'bot2'], [(0.1,) * 6, (0.0,) * 6])
BAD_TEAMS = {
    'lengths': (['bot1'], []), 'too_many': (['b{}'.format(n) for n in range(MOST_ROBOTS + 1)],
                                            [(0.0,) * 6] * (MOST_ROBOTS + 1)),
    'name': (['bot/1'], [(0.0,) * 6]), 'twice': (['a', 'a'], [(0.0,) * 6] * 2),
    'not_finite': (['a'], [(0.0, 0.0, float('nan'), 0.0, 0.0, 0.0)])}


@pytest.mark.parametrize('kind', sorted(BAD_TEAMS))
def test_a_team_that_cannot_be_is_refused_and_counted(kind):
    relay = TaskRelay()
    verdict, words = relay.judge(*BAD_TEAMS[kind], False, True, True)
    assert verdict == NOTHING and words and len(words) < 300
    assert relay.refused == {kind: 1}
    assert team_problem(*GOOD) is None


def test_a_name_of_a_megabyte_is_cut():
    assert len(team_problem(['x' * 1000000], [(0.0,) * 6])[1]) < 300


@pytest.mark.parametrize('stopped, enabled, is_new, verdict', [
    (False, True, True, PASS), (True, True, True, NOTHING), (False, True, False, NOTHING),
    (False, False, True, NOTHING), (True, False, False, NOTHING)])
def test_what_is_passed_on(stopped, enabled, is_new, verdict):
    assert TaskRelay().judge(*GOOD, stopped, enabled, is_new) == (verdict, '')


def test_a_released_pedal_stops_robots_on_a_task_once():
    relay = TaskRelay()
    assert relay.judge(*GOOD, False, True, True)[0] == PASS
    verdicts = [relay.judge(*GOOD, False, False, True)[0] for _ in range(3)]
    assert verdicts == [PASS_ZEROS, NOTHING, NOTHING]
    assert relay.held == {'enabling': 3}


PAD = Source('pad', 'Pad', '/joy', None)
CMD = replace(PAD, kind=TWIST)
NODE = frozenset(['/joy_node'])


@pytest.mark.parametrize('source, waits_for, heard, words', [
    (PAD, '', Heard(NODE, spoke=True), ''),
    (PAD, 'neutral', Heard(NODE, spoke=True), ''),
    (PAD, 'source', Heard(), 'nobody publishes /joy'),
    (PAD, 'source', Heard(NODE), '/joy_node has said nothing yet: move the stick once'),
    (PAD, 'source', Heard(NODE, spoke=True), 'holds: true'),
    (PAD, 'source', Heard(stranger=('/teleop', 'geometry_msgs/Twist')), 'write type: twist'),
    (CMD, 'source', Heard(stranger=('/joy_node', 'sensor_msgs/Joy')), 'write type: joy'),
    (CMD, 'source', Heard(stranger=('/talker', 'std_msgs/String')), 'needs geometry_msgs/Twist'),
    (PAD, '', Heard(NODE, rival=('/b', '/a')), '/b publishes /joy as well'),
    (PAD, 'source', Heard(NODE, refused='too few axes'), 'Pad: too few axes')])
def test_the_advice_names_reason_and_remedy(source, waits_for, heard, words):
    said = advice(source, waits_for, heard)
    assert words in said and bool(said) == bool(words)
    assert source.kind in (JOY, TWIST)


def test_who_was_displaced_has_its_source_back_once_another_one_takes_control():
    ownership, both = Ownership(), {'/pedal', '/attacker'}
    assert ownership.admits('/pedal', both) and not ownership.admits('/attacker', both)
    for changed in (True, False, False):
        assert ownership.take('/attacker', both) == changed
        assert ownership.admits('/attacker', both) and not ownership.admits('/pedal', both)
    assert ownership.take('/panel', both)
    assert ownership.admits('/pedal', both) and not ownership.admits('/attacker', both)
