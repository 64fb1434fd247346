# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The host's end of the link to a guard, alone and with a guard at the other end."""
import collections
from pathlib import Path

import pytest

from mhri.driving import guard_link
from mhri.driving.guard_link import format_id, GuardLink, GuardState, parse_id, read_state
from play_guard import load

GUARD = load(str(Path(__file__).resolve().parents[3] / 'utils' / 'remote' / 'mhri_guard'))
LONG = 'x' * 32


@pytest.mark.parametrize('text, parts', [
    ('a:1:t', ('a', 1, 't', False)),
    ('a!:1:t', ('a', 1, 't', True)),
    ('a:1:t!', ('a', 1, 't', True)),
    ('-:0:7f-1', ('-', 0, '7f-1', False)),
    ('a!:1:', ('a', 1, '', True)),
    (LONG + ':999999999999999:' + LONG, (LONG, 999999999999999, LONG, False)),
    ('', None), ('map', None), ('a:1', None), (':1:t', None), ('a:1:t:', None), ('a:-1:t', None),
    ('a:1.0:t', None), ('a: 1:t', None), ('a:1:t\n', None), ('!:1:t', None), ('a!!:1:t', None),
    ('ä:1:t', None), ('a:١:t', None), ('a:1:t t', None), (LONG + 'x:1:t', None),
    ('a:1:' + LONG + 'x', None), ('a:1000000000000000:t', None), ('a:1:t' * 100000, None)])
def test_a_frame_id_is_read_alike_at_both_ends(text, parts):
    assert parse_id(text) == GUARD['parse_id'](text) == parts


@pytest.mark.parametrize('stop', [True, False])
def test_what_is_written_is_read(stop):
    assert parse_id(format_id('a', 12, 't', stop)) == ('a', 12, 't', stop)


@pytest.mark.parametrize('session', ['', '-', 'a:b', 'a!', 'a\n', LONG + 'x'])
def test_a_session_that_cannot_be_is_refused(session):
    with pytest.raises(ValueError, match='at most 32 of'):
        GuardLink(session)


def test_every_command_has_the_next_number_and_the_newest_token():
    link = GuardLink('a')
    assert link.next_id(True) == 'a!:1:'
    assert link.on_echo('-:0:t1', 0.1) and link.next_id(False) == 'a:2:t1'
    assert link.on_echo('a:2:t2!', 0.2) and link.next_id(True) == 'a!:3:t2'
    assert not link.on_echo('nonsense', 0.3) and not link.on_echo('a:3:', 0.3)
    assert link.next_id(False) == 'a:4:t2'
    assert link.last_id(True) == 'a!:999999999999999:t2', 'the greatest that a guard can read'


def test_a_link_is_alive_while_echoes_come():
    link = GuardLink('a')
    assert not link.alive(0.0) and not link.stop_is_own
    link.on_echo('-:0:t', 0.0)
    assert link.alive(0.35)
    assert not link.on_echo('no echo', 0.3) and not link.alive(0.36)


@pytest.mark.parametrize('echoes, obeyed, confirmed, displaced', [
    ([], 0, False, False),
    (['-:0:t'], 0, False, False),
    (['a:2:t'], 2, False, False),
    (['a:2:t!'], 2, True, False),
    (['b:7:t'], 0, False, False),
    (['a:1:t', 'b:7:t'], 0, False, True),
    (['a:2:t', 'b:7:t', 'b:8:t!'], 0, True, True),
    (['a:2:t', 'b:7:t', '-:0:t'], 0, False, False),
    (['a:2:t!', 'a:2:t'], 2, False, False)])
def test_the_newest_echo_tells_whom_the_robot_obeys(echoes, obeyed, confirmed, displaced):
    link = GuardLink('a')
    for now, echo in enumerate(echoes):
        assert link.on_echo(echo, float(now))
    assert link.speaker == (echoes[-1][0] if echoes else '')
    assert (link.obeyed_number, link.stop_confirmed, link.displaced) == (
        obeyed, confirmed, displaced)


def test_a_stop_behind_a_later_command_is_somebody_elses():
    link, owns = GuardLink('a'), []

    def hear(echo):
        link.on_echo(echo, 0.0)
        owns.append(link.stop_is_own)
    link.next_id(False)
    hear('a:1:t!')
    link.next_id(True)
    hear('a:2:t!')
    link.next_id(False)
    hear('a:2:t!')  # its release is on its way
    for echo in ('a:3:t', 'a:3:t!', 'b:1:t!'):
        hear(echo)
    assert owns == [False, True, True, False, False, False]


class Wire:
    """One direction of a link: in order, and as late as a function of the time has it."""

    def __init__(self, delay_s):
        self._delay_s = delay_s
        self._words = collections.deque()
        self._last = 0.0

    def send(self, word, now):
        """Put a word in."""
        self._last = max(self._last, now + self._delay_s(now))
        self._words.append((self._last, word))

    def arrived(self, now):
        """Take out what has come through."""
        while self._words and self._words[0][0] <= now:
            yield self._words.popleft()[1]


def drive(up_s, down_s, seconds, is_stop=lambda now: False):
    """Hold a stick for so long; return rows (arrival, sent at, velocity given) at the robot."""
    link, guard = GuardLink('a'), GUARD['Guard']('run')
    up, down, rows = Wire(up_s), Wire(down_s), []
    for step in range(int(seconds * 100)):
        now = step / 100.0
        for echo in down.arrived(now):
            link.on_echo(echo, now)
        if step % 5 == 0:
            up.send((link.next_id(is_stop(now)), now), now)
        answer = step % 10 == 0
        for frame_id, sent in up.arrived(now):
            said, fault = guard.on_command(frame_id, (0.3, 0.0, 0.0), now)
            answer = answer or not fault
            if said is not None:
                rows.append((now, sent, said))
        said = guard.tick(now)
        if said is not None:
            rows.append((now, now, said))
        if answer:
            down.send(guard.echo_id(now), now)
    return rows


def cut(begin, end):
    """Return the delay of a link that keeps everything from one time to another."""
    return lambda now: max(0.02, end - now) if now >= begin else 0.02


@pytest.mark.parametrize('name, up_s, down_s, drives_s', [
    ('quick', lambda now: 0.01, lambda now: 0.01, 60.0),
    ('slow', lambda now: 0.3, lambda now: 0.3, 60.0),
    ('creeping up', lambda now: 0.02 + 0.0066 * now, lambda now: 0.01, 140.0),
    ('creeping down', lambda now: 0.01, lambda now: 0.02 + 0.0066 * now, 140.0),
    ('creeping both ways', lambda now: 0.0066 * now, lambda now: 0.0066 * now, 70.0)])
def test_no_command_that_is_obeyed_is_older_than_the_limit(name, up_s, down_s, drives_s):
    rows = drive(up_s, down_s, 650.0)
    obeyed = [row for row in rows if row[2] != GUARD['ZERO']]
    assert all(now - sent < 1.0 for now, sent, _ in obeyed)
    assert obeyed[-1][0] > drives_s, 'a link within the limit drives'
    if name.startswith('creeping'):
        assert obeyed[-1][0] < 160.0 and rows[-1][2] == GUARD['ZERO'], 'one beyond it does not'


@pytest.mark.parametrize('seconds', [0.2, 0.9, 1.5, 15.0])
@pytest.mark.parametrize('ways', ['there', 'back', 'both'])
def test_after_a_cut_no_backlog_moves_the_robot(seconds, ways):
    """While echoes still come, the last second of what is sent is not old."""
    end, whole = 5.0 + seconds, cut(0.0, 0.0)
    broken = cut(5.0, end)
    rows = drive(broken if ways != 'back' else whole, broken if ways != 'there' else whole, end + 5)
    obeyed = [row for row in rows if row[2] != GUARD['ZERO']]
    assert all(now - sent < 1.0 for now, sent, _ in obeyed)
    if ways != 'back' and seconds >= 0.5:
        stopped = next(now for now, _, given in rows if now > 5.0 and given == GUARD['ZERO'])
        assert stopped <= 5.0 + 0.02 + 0.3 + 0.05, 'the lease ends'
    if seconds >= 1.5:
        again = [sent for now, sent, _ in obeyed if now >= end]
        assert again[0] >= end - (0.9 if ways == 'there' else 0.0), 'the backlog is dropped'
    assert obeyed[-1][0] > end + 4.9, 'then it drives on: it is the gates that wait for neutral'


def test_a_stop_in_the_backlog_of_a_cut_is_found():
    """Stopped and released while the link was away: what stood among the others is not lost."""
    rows = drive(cut(5.0, 8.0), lambda now: 0.02, 12.0, lambda now: 6.0 <= now < 7.0)
    assert all(given == GUARD['ZERO'] for now, _, given in rows if now >= 5.4)


def test_a_robot_that_is_removed_and_added_again_is_driven_at_once():
    """By a link with a new session, whose numbers begin again: none of its commands is dropped."""
    guard, now, given = GUARD['Guard']('run'), 0.0, []
    for session in ('run-1', 'run-2'):
        link = GuardLink(session)
        for velocity in ((0.0, 0.0, 0.0), *100 * [(0.3, 0.0, 0.0)]):
            now += 0.05
            link.on_echo(guard.echo_id(now), now)
            given.append(guard.on_command(link.next_id(False), velocity, now))
    assert [fault for _, fault in given if fault] == []
    assert [said for said, _ in given[101:103]] == [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0)]


def test_three_echoes_in_a_row_may_be_lost():
    assert 3 * GUARD['ECHO_S'] < guard_link.ECHO_S <= 4 * GUARD['ECHO_S']


@pytest.mark.parametrize('text, state', [
    ('', GuardState()), ('back_after:10', GuardState(back_after_s=10.0)),
    ('brake:slows way:0.6 back_after:2.5', GuardState('slows', 0.6, 2.5)),
    ('brake:tomorrow', GuardState('no_scan')), ('back_after:1.2.3 way', GuardState()),
    ('x' * 10000, GuardState()), ('x' * 490 + ' brake:on', GuardState('on')),
    ('x' * 500 + ' brake:on', GuardState())])
def test_what_a_guard_says_of_itself(text, state):
    found = read_state(text)
    assert (found.brake, found.back_after_s) == (state.brake, state.back_after_s)
    assert found.free_way_m == pytest.approx(state.free_way_m, nan_ok=True)


def test_the_guard_says_it_so():
    sight = GUARD['Sight'](0.2)
    guard = GUARD['Guard']('run', brake=sight, back=GUARD['WayBack'](sight, 10.0))
    assert read_state(guard.state(0.0)).brake == 'no_scan'
    sight.move((0.0, 0.0, 0.0), 0.0)
    sight.see([0.8] * 9, -0.4, 0.1, 0.1, 10.0, 0.0)
    assert read_state(guard.state(0.1)).brake == 'on'
    sight.allow((0.6, 0.0, 0.0), 0.1)
    state = read_state(guard.state(0.1))
    assert (state.brake, state.back_after_s) == ('slows', 10.0)
    assert state.free_way_m == pytest.approx(0.6, abs=0.05)


def test_who_else_commands_the_robot_is_read_and_bounded():
    assert read_state('brake:on also:/nav also:/bot1/move_base').also == ('/nav', '/bot1/move_base')
    assert read_state('also:nav also:/a;b also: also:/' + 'x' * 300).also == ()
