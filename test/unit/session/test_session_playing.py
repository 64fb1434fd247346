# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Playing a session: the state machine, the clock of a screen, and the time line."""
import pytest

from mhri.recording.folder import SessionEvent
from mhri.session.playing import age_groups, other_speed, Playing, ReplayClock, SPEEDS
from mhri.session.timeline import EVENT, MARK, read_time_line, Span, STOP
from support.clock import Clock

START = 1.7e9


def made(state):
    """Return a Playing in a state, at 4 s of 10 s (at the end: 10 s), at time 100."""
    playing = Playing(10.0)
    playing.seek(10.0 if state == 'at the end' else 4.0, 100.0)
    if state == 'playing':
        playing.play(100.0)
    return playing


# (state, what is done at time 100, whether it plays then, position 2 s later)
@pytest.mark.parametrize('state, act, plays, position_s', [
    ('paused', lambda one: one.play(100.0), True, 6.0),
    ('paused', lambda one: one.pause(100.0), False, 4.0),
    ('paused', lambda one: one.seek(7.0, 100.0), False, 7.0),
    ('playing', lambda one: one.play(100.0), True, 6.0),
    ('playing', lambda one: one.pause(100.0), False, 4.0),
    ('playing', lambda one: one.seek(7.0, 100.0), True, 9.0),
    ('playing', lambda one: one.seek(-5.0, 100.0), True, 2.0),
    ('playing', lambda one: one.seek(99.0, 100.0), False, 10.0),
    ('playing', lambda one: one.set_speed(2.0, 100.0), True, 8.0),
    ('playing', lambda one: one.set_speed(8.0, 100.0), False, 10.0),
    ('at the end', lambda one: one.play(100.0), True, 2.0),
    ('at the end', lambda one: one.pause(100.0), False, 10.0),
    ('at the end', lambda one: one.seek(1.0, 100.0), False, 1.0),
])
def test_every_act_in_every_state(state, act, plays, position_s):
    playing = made(state)
    act(playing)
    assert playing.position_s(102.0) == pytest.approx(position_s)
    assert playing.playing is plays


def test_what_was_played_before_a_new_speed_counts_at_the_old_one():
    playing = made('playing')
    playing.set_speed(4.0, 101.0)
    assert playing.position_s(102.0) == pytest.approx(9.0)


def test_an_empty_session_never_plays():
    playing = Playing(0.0)
    playing.play(1.0)
    assert not playing.playing


def test_speeds_go_by_steps_and_end():
    assert [other_speed(1.0, steps) for steps in (-9, -1, 1, 9)] == [
        SPEEDS[0], 0.5, 2.0, SPEEDS[-1]]


def test_the_clock_goes_as_the_session_does_and_never_back():
    real = Clock()
    clock = ReplayClock(real)
    clock.update(START, 10.0, 20.0, 1.0, 1)
    first = clock()
    real.now += 0.2
    assert clock() - first == pytest.approx(0.2)
    assert clock.wall() == pytest.approx(START + 10.2)
    clock.update(START, 10.1, 20.0, 0.0, 1)  # it paused a little earlier: the clock waits
    assert clock() - first == pytest.approx(0.2)
    clock.update(START, 14.0, 20.0, 8.0, 2)  # ahead: as much older is what was heard before
    assert clock() - first == pytest.approx(4.0)
    before = clock()
    clock.update(START, 3.0, 20.0, 0.0, 3)   # back: what was heard before is old, too
    assert clock() - before >= 30.0
    assert clock.wall() == pytest.approx(START + 3.0)


def test_on_its_way_it_goes_no_further_than_its_aim():
    real = Clock()
    clock = ReplayClock(real)
    clock.update(START, 10.0, 11.5, 16.0, 1)
    real.now += 0.4
    assert clock.wall() == pytest.approx(START + 11.5)


def test_without_a_player_its_time_stands_still():
    real = Clock()
    clock = ReplayClock(real)
    clock.update(START, 10.0, 20.0, 1.0, 1)
    real.now += 60.0
    assert clock.wall() - START < 11.0


def line(time_s, kind, text, severity='info', robot='', **data):
    return SessionEvent(START + time_s, START + time_s, kind, text, severity, robot, data)


EVENTS = (
    line(-1.0, 'start', 'begins', selected=['bot2'], stop_all=True),
    line(2.0, 'selection', '', selected=['bot1', 'bot2']),
    line(3.0, 'stop', '', stop_all=False),
    line(5.0, 'mark', 'mark', id='m1'),
    line(6.0, 'stop', 'STOP ALL', 'warning', stop_all=True),
    line(6.5, 'stop', 'bot1 stands still', robot='bot1'),
    line(7.0, 'selection', '', selected=[]),
    line(8.0, 'lost', 'silent', 'warning', 'bot1'),
    line(9.0, 'note', 'a door', mark='m1'),
    line(30.0, 'end', 'ends'))
TIME_LINE = read_time_line(EVENTS, START, 20.0)


def test_the_time_line_tells_who_was_driven_and_when_all_was_stopped():
    assert TIME_LINE.driven == (Span(0.0, 7.0, 'bot2'), Span(2.0, 7.0, 'bot1'))
    assert TIME_LINE.stopped == (Span(0.0, 3.0), Span(6.0, 20.0))
    assert TIME_LINE.driven_at(1.0) == ('bot2',)


def test_marks_stops_and_what_was_no_calm_event_are_worth_a_jump():
    assert [(tick.at_s, tick.kind, tick.text) for tick in TIME_LINE.ticks] == [
        (5.0, MARK, 'mark 1: a door'), (6.0, STOP, 'STOP ALL'), (8.0, EVENT, 'silent')]


@pytest.mark.parametrize('position_s, before, after', [
    (0.0, None, 5.0), (5.0, None, 6.0), (5.6, 5.0, 6.0), (6.2, 5.0, 8.0), (7.0, 6.0, 8.0),
    (8.0, 6.0, None), (20.0, 8.0, None)])
def test_a_jump_goes_to_the_next_one_or_the_one_before(position_s, before, after):
    found = TIME_LINE.previous_tick(position_s), TIME_LINE.next_tick(position_s)
    assert tuple(tick and tick.at_s for tick in found) == (before, after)


def test_the_list_of_events_ends_where_the_replay_is():
    assert len(TIME_LINE.events_until(6.0)) == 5
    assert len(TIME_LINE.events_until(20.0)) == len(EVENTS) - 2, 'a note is no line of its own'


@pytest.mark.parametrize('times, groups', [
    ([], []), ([9.9, 10.0], [(10.0, [0, 1])]),
    ([4.0, 9.8, 4.1, 7.0], [(4.0, [0, 2]), (7.0, [3]), (10.0, [1])]),
    ([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
     [(1.0, [0, 1]), (2.0, [2]), (3.0, [3]), (4.0, [4]), (5.0, [5]), (6.0, [6])])])
def test_what_is_older_than_a_run_up_is_told_as_of_when_it_was_said(times, groups):
    assert age_groups(times, 10.0) == groups
