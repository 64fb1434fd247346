# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""On change, at most 100 Hz, at 20 Hz while held, and never without the newest."""
import pytest

from mhri.devices.publish_throttle import MIN_PERIOD_S, Pacer


def test_first_state_at_once_then_repeated_at_20_hz():
    pacer = Pacer()
    pacer.offer('a')
    assert pacer.due_in(1.0) == 0.0
    assert pacer.take(1.0) == 'a'
    assert pacer.take(1.0) is None
    assert pacer.due_in(1.0) == pytest.approx(0.05)
    assert pacer.take(1.049) is None
    assert pacer.take(1.0501) == 'a'


def test_a_change_is_not_held_up_after_a_pause():
    pacer = Pacer()
    pacer.offer('a')
    pacer.take(1.0)
    pacer.offer('b')
    assert pacer.due_in(1.02) == 0.0
    assert pacer.take(1.02) == 'b'


def test_changes_are_coalesced_and_the_newest_is_sent():
    pacer = Pacer()
    pacer.offer('a')
    pacer.take(1.0)
    pacer.offer('b')
    assert pacer.take(1.001) is None
    assert pacer.holding_back
    pacer.offer('c')
    assert pacer.due_in(1.004) == pytest.approx(0.006)
    assert pacer.take(1.0101) == 'c'
    assert not pacer.holding_back


@pytest.mark.parametrize('event_hz', [30.0, 101.0, 4000.0])
def test_never_faster_than_100_hz_and_the_last_one_arrives(event_hz):
    pacer, sent, now, number = Pacer(), [], 0.0, 0
    while now < 2.0:
        pacer.offer(number)
        number += 1
        state = pacer.take(now)
        if state is not None:
            sent.append((now, state))
        now += 1.0 / event_hz
    state = pacer.take(now + MIN_PERIOD_S)
    if state is not None:
        sent.append((now + MIN_PERIOD_S, state))
    assert sent[-1][1] == number - 1
    assert min(after - before for (before, _), (after, _) in zip(sent, sent[1:])) >= 0.0099
