# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The table of faults: what may be asked for, when it ends, how it is said; the slow link."""
import math

import pytest

from mhri.sim.delay_line import DelayLine
from mhri.sim.faults import failing_in, FaultBook, FaultRefused, FAULTS

NAN = float('nan')


@pytest.mark.parametrize('fault', FAULTS, ids=lambda fault: fault.key)
def test_every_fault_begins_with_its_default_and_ends_by_time(fault):
    book = FaultBook()
    book.begin(fault.key, NAN, 5.0, 100.0)
    assert book.value(fault.key, 104.9) == fault.default
    assert book.words(104.9) == [fault.words(fault.default) + ', 1 s left']
    assert not book.has(fault.key, 105.0) and book.words(105.0) == []
    assert fault.low <= fault.default <= fault.high


@pytest.mark.parametrize('fault', [fault for fault in FAULTS if not fault.timed],
                         ids=lambda fault: fault.key)
def test_every_fault_ends_by_request(fault):
    book = FaultBook()
    for key in (fault.key, 'all'):
        book.begin(fault.key, NAN, 0.0, 0.0)
        assert book.has(fault.key, 1e6)
        book.end(key)
        assert not book.has(fault.key, 0.0)


def test_only_the_named_fault_ends():
    book = FaultBook()
    book.begin('delay', 0.2, 0.0, 0.0)
    book.begin('loss', 10.0, 0.0, 0.0)
    book.end('delay')
    assert book.words(1.0) == ['loss each way 10 %']


@pytest.mark.parametrize('key, value, duration_s, words', [
    ('deley', NAN, 1.0, 'there is no fault \'deley\'; there are odometry_silent, '),
    ('delay', 9.0, 1.0, 'delay: expected a value from 0.01 to 5 s, got 9'),
    ('delay', math.inf, 1.0, 'delay: expected a value from 0.01 to 5 s, got inf'),
    ('loss', 0.0, 1.0, 'loss: expected a value from 1 to 100 %, got 0'),
    ('delay', NAN, 1e9, 'delay: expected a duration from 0 to 3600 s, got 1e+09'),
    ('delay', NAN, NAN, 'delay: expected a duration from 0 to 3600 s, got nan'),
    ('node_dead', NAN, 0.0, 'node_dead: give a duration: nobody can ask a dead program'),
])
def test_refused_with_the_remedy(key, value, duration_s, words):
    book = FaultBook()
    with pytest.raises(FaultRefused) as refused:
        book.begin(key, value, duration_s, 0.0)
    assert str(refused.value).startswith(words)
    assert book.words(0.0) == []


def test_ending_an_unknown_fault_is_refused():
    with pytest.raises(FaultRefused, match='there is no fault'):
        FaultBook().end('deley')


def test_a_slow_link_keeps_the_order():
    line = DelayLine(lambda: 0.5)
    assert line.put('a', 0.0, 0.4, 0.0)
    assert line.put('b', 0.1, 0.0, 0.0)
    assert line.take(0.39) == [] and len(line) == 2
    assert line.take(0.4) == ['a', 'b'] and len(line) == 0


def test_a_bad_link_loses_its_share():
    chances = iter((0.1, 0.3, 0.299))
    line = DelayLine(lambda: next(chances))
    assert [line.put(item, 0.0, 0.0, 0.3) for item in 'abc'] == [False, True, False]
    assert line.take(0.0) == ['b']


def test_an_answer_tells_what_fails():
    book = FaultBook()
    assert failing_in('bot1: nothing fails') == ()
    for fault in FAULTS:
        book.begin(fault.key, NAN, 3.0, 0.0)
        assert failing_in('bot1: ' + book.words(0.0)[-1]) == (fault.key,)
    assert failing_in('; '.join(book.words(0.0))) == tuple(fault.key for fault in FAULTS)
