# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The seat of the operator: every event in every state, who may have it, and the lease."""
import json

import pytest

from mhri.driving.operator_lease import (
    Caller, EMPTY, LAPSED, LEASE_S, LEASED, MAX_REFUSED, MAX_ROBOTS, OperatorLease, RETURN_S)

A, B = (
    Caller(name, 'http://lab-pc1:{}/'.format(port), 'lab-pc1')
    for name, port in (('/a', 4001), ('/b', 4002)))
A_AGAIN = Caller('/a', 'http://lab-pc1:5001/', 'lab-pc1')
A_ELSEWHERE = Caller('/a', 'http://lab-pc2:4001/', 'lab-pc2')
GONE = 'gone'


def seat_in(state):
    """Return a seat that A has taken at 0 s (but for EMPTY)."""
    seat = OperatorLease()
    if state != EMPTY:
        seat.on_selection(A, ['bot1'], 0.0)
    if state == LAPSED:
        seat.tick(LEASE_S)
    if state == GONE:
        seat.on_gone(A, 1.0)
    return seat


EVENTS = {
    'own selection': lambda seat: seat.on_selection(A, ['bot2'], 2.0),
    'own selection, started again': lambda seat: seat.on_selection(A_AGAIN, ['bot2'], 2.0),
    'its name elsewhere': lambda seat: seat.on_selection(A_ELSEWHERE, ['bot3'], 2.0),
    'other selection': lambda seat: seat.on_selection(B, ['bot3'], 2.0),
    'own end': lambda seat: seat.on_gone(A, 2.0),
    'other end': lambda seat: seat.on_gone(B, 2.0),
    'other takes': lambda seat: seat.take(B, 2.0),
    'early tick': lambda seat: seat.tick(LEASE_S - 0.001),
    'late tick': lambda seat: seat.tick(LEASE_S),
    'tick, back': lambda seat: seat.tick(1.0 + RETURN_S, [A]),
    'tick, still gone': lambda seat: seat.tick(1.0 + RETURN_S, [B, A_ELSEWHERE]),
}
# state -> {event: (state after it, operator, selected)}; what is left out changes nothing.
OURS = {'own selection': (LEASED, '/a', ('bot2',)),
        'own selection, started again': (LEASED, '/a', ('bot2',)),
        'other takes': (LEASED, '/b', ())}
TABLE = {
    EMPTY: {**OURS, 'other selection': (LEASED, '/b', ('bot3',)),
            'its name elsewhere': (LEASED, '/a', ('bot3',))},
    LEASED: {**OURS, 'own end': (LAPSED, '/a', ()), 'late tick': (LAPSED, '/a', ()),
             'tick, back': (LAPSED, '/a', ()), 'tick, still gone': (LAPSED, '/a', ())},
    LAPSED: OURS,
    GONE: {**OURS, 'tick, still gone': (EMPTY, '', ())},
}


@pytest.mark.parametrize('event', sorted(EVENTS))
@pytest.mark.parametrize('state', sorted(TABLE))
def test_every_event_in_every_state(state, event):
    seat = seat_in(state)
    unchanged = (seat.state, seat.operator, seat.selected)
    EVENTS[event](seat)
    assert (seat.state, seat.operator, seat.selected) == TABLE[state].get(event, unchanged)


def test_the_lease_is_renewed_by_each_repetition():
    seat = seat_in(LEASED)
    assert (seat.next_tick(), RETURN_S) == (1.5, 3.0)
    for now in (0.5, 1.0, 1.5, 2.0):
        assert seat.on_selection(A, ['bot1'], now)
        seat.tick(now + LEASE_S - 0.001)
        assert seat.selected == ('bot1',)
    seat.tick(2.0 + LEASE_S)
    assert seat.selected == () and seat.next_tick() is None and seat.operator == '/a'


def test_whoever_is_connected_again_is_not_waited_for():
    seat = seat_in(GONE)
    assert seat.next_tick() == 1.0 + RETURN_S
    seat.tick(2.0, [A])
    assert seat.next_tick() is None


def test_another_is_refused_until_it_takes_control():
    seat = seat_in(LEASED)
    assert [seat.on_selection(B, ['bot9'], 0.1) for _ in range(3)] == [False] * 3
    assert seat.selected == ('bot1',)
    seat.take(B, 0.2)
    assert seat.since == 0.2
    assert seat.on_selection(B, ['bot9'], 0.3) and not seat.on_selection(A, [], 0.4)


def test_an_empty_seat_goes_to_nobody_who_was_refused():
    seat = seat_in(LEASED)
    assert not seat.on_selection(B, ['bot9'], 0.1)
    seat.on_gone(A, 1.0)
    seat.tick(1.0 + RETURN_S, [B])
    assert seat.state == EMPTY and not seat.on_selection(B, ['bot9'], 5.0)
    started_anew = Caller('/b', 'http://lab-pc1:6002/', 'lab-pc1')
    assert seat.on_selection(started_anew, ['bot9'], 5.1) and seat.operator == '/b'


def test_the_last_process_of_an_operator_that_was_started_again_has_no_say():
    seat = seat_in(LEASED)
    assert seat.on_selection(A_AGAIN, [], 1.0)
    assert not seat.on_selection(A, ['bot1'], 1.1) and seat.selected == ()
    assert not seat.on_gone(A, 1.2) and seat.state == LEASED


def test_the_next_process_knows_who_had_the_seat_and_who_was_refused():
    seat = seat_in(LEASED)
    seat.on_selection(B, ['bot9'], 0.1)
    kept = json.loads(json.dumps(seat.kept()))
    assert seat.on_selection(A, ['bot1'], 0.2)
    assert json.loads(json.dumps(seat.kept())) == kept, 'a repetition is nothing to keep'
    after = OperatorLease()
    after.restore(OperatorLease().kept(), 9.0)
    assert after.state == EMPTY
    after.restore(kept, 10.0)
    assert (after.state, after.operator, after.selected, after.since) == (LAPSED, '/a', (), 0.0)
    assert not after.on_selection(B, ['bot9'], 10.1)
    assert after.on_selection(A, ['bot1'], 10.5) and after.selected == ('bot1',)
    after.restore(kept, 20.0)
    after.tick(20.0 + RETURN_S, [B])
    assert after.state == EMPTY and not after.on_selection(B, ['bot9'], 24.0)
    assert after.on_selection(A, ['bot1'], 24.1)


def test_a_lease_whose_past_is_lost_is_given_to_nobody_and_then_to_one_that_is_alone():
    seat = OperatorLease()
    seat.forget(0.0)
    for now in (0.1, 1.0, RETURN_S - 0.1):
        assert not seat.on_selection(A, ['bot1'], now)
    assert seat.on_selection(A, ['bot1'], RETURN_S) and seat.selected == ('bot1',)
    assert not seat.on_selection(B, [], RETURN_S)


def test_of_several_only_one_that_takes_control_gets_a_lease_whose_past_is_lost():
    before = OperatorLease()
    before.forget(0.0)
    seat = OperatorLease()
    seat.restore(json.loads(json.dumps(before.kept())), 1.0)
    for second in range(1, 10):
        assert not seat.on_selection(A, ['bot1'], 1.0 + second)
        assert not seat.on_selection(B, ['bot1'], 1.1 + second)
    seat.take(A, 11.0)
    assert seat.on_selection(A, ['bot1'], 11.1) and not seat.on_selection(B, ['bot1'], 11.2)
    assert not seat.kept()['forgotten']


def test_a_lease_whose_past_is_lost_goes_to_the_one_that_is_left():
    seat = OperatorLease()
    seat.forget(0.0)
    for now in (2.0, RETURN_S):
        assert not seat.on_selection(B, [], now - 0.1)
        assert not seat.on_selection(A, [], now)
    assert not seat.on_selection(A, [], RETURN_S + LEASE_S - 0.2)
    assert seat.on_selection(A, [], RETURN_S + LEASE_S - 0.1)


def test_what_was_kept_before_the_clock_began_anew_is_not_in_the_future():
    kept = dict(OperatorLease().kept(), holder=list(A), since=1e6)
    seat = OperatorLease()
    seat.restore(kept, 5.0)
    assert seat.since == 5.0


def test_what_is_kept_is_bounded():
    seat = seat_in(LEASED)
    seat.on_selection(A, ['bot{}'.format(number) for number in range(20000)], 0.1)
    assert len(seat.selected) == MAX_ROBOTS == MAX_REFUSED == 64
    for number in range(20000):
        seat.on_selection(Caller('/x{}'.format(number) * 100, 'http://x/' * 1000), [], 0.2)
    assert len(seat.kept()['refused']) == MAX_REFUSED
    assert len(json.dumps(seat.kept())) < 65536
    assert {len(text) for text in seat.kept()['refused'][-1]} == {200, 0}
