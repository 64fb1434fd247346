# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The seat of the operator: every event in every state, and the lease to the millisecond."""
import pytest

from mhri.core.driving.seat import (
    ControlSeat, EMPTY, LAPSED, LEASE_S, LEASED, MOST_ROBOTS)


def seat_in(state):
    """Return a seat that /a has taken at 0 s (but for EMPTY)."""
    seat = ControlSeat()
    if state != EMPTY:
        seat.on_selection('/a', ['bot1'], 0.0)
    if state == LAPSED:
        seat.tick(LEASE_S)
    return seat


EVENTS = {
    'own selection': lambda seat: seat.on_selection('/a', ['bot2'], 2.0),
    'other selection': lambda seat: seat.on_selection('/b', ['bot3'], 2.0),
    'own end': lambda seat: seat.on_gone('/a'),
    'other end': lambda seat: seat.on_gone('/b'),
    'other takes': lambda seat: seat.take('/b', 2.0),
    'early tick': lambda seat: seat.tick(LEASE_S - 0.001),
    'late tick': lambda seat: seat.tick(LEASE_S),
}
# state -> {event: (state after it, operator, checked)}; what is left out changes nothing.
TABLE = {
    EMPTY: {'own selection': (LEASED, '/a', ('bot2',)),
            'other selection': (LEASED, '/b', ('bot3',)), 'other takes': (LEASED, '/b', ())},
    LEASED: {'own selection': (LEASED, '/a', ('bot2',)), 'own end': (EMPTY, '', ()),
             'other takes': (LEASED, '/b', ()), 'late tick': (LAPSED, '/a', ())},
    LAPSED: {'own selection': (LEASED, '/a', ('bot2',)), 'own end': (EMPTY, '', ()),
             'other takes': (LEASED, '/b', ())},
}


@pytest.mark.parametrize('event', sorted(EVENTS))
@pytest.mark.parametrize('state', sorted(TABLE))
def test_every_event_in_every_state(state, event):
    seat = seat_in(state)
    unchanged = (seat.state, seat.operator, seat.checked)
    EVENTS[event](seat)
    assert (seat.state, seat.operator, seat.checked) == TABLE[state].get(event, unchanged)


def test_the_lease_is_renewed_by_each_repetition():
    seat = seat_in(LEASED)
    assert seat.next_tick() == LEASE_S
    for now in (0.5, 1.0, 1.5, 2.0):
        assert seat.on_selection('/a', ['bot1'], now)
        seat.tick(now + LEASE_S - 0.001)
        assert seat.checked == ('bot1',)
    seat.tick(2.0 + LEASE_S)
    assert seat.checked == () and seat.next_tick() is None and seat.operator == '/a'


def test_another_is_refused_until_it_takes_control():
    seat = seat_in(LEASED)
    assert [seat.on_selection('/b', ['bot9'], 0.1) for _ in range(3)] == [False] * 3
    assert seat.checked == ('bot1',)
    seat.take('/b', 0.2)
    assert seat.since == 0.2
    assert seat.on_selection('/b', ['bot9'], 0.3) and not seat.on_selection('/a', [], 0.4)


def test_the_selection_is_bounded():
    seat = seat_in(LEASED)
    seat.on_selection('/a', ['bot{}'.format(number) for number in range(20000)], 0.1)
    assert len(seat.checked) == MOST_ROBOTS
