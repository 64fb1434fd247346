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
    assert len(book.words(104.9)) == 1
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


@pytest.mark.parametrize('key, value, duration_s', [
    ('deley', NAN, 1.0), ('delay', 9.0, 1.0), ('delay', math.inf, 1.0), ('loss', 0.0, 1.0),
    ('delay', NAN, 1e9), ('delay', NAN, NAN), ('node_dead', NAN, 0.0)])
def test_an_impossible_fault_is_refused_by_name(key, value, duration_s):
    book = FaultBook()
    with pytest.raises(FaultRefused, match=key):
        book.begin(key, value, duration_s, 0.0)
    assert book.words(0.0) == []


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
    assert failing_in('bot1: ') == ()
    for fault in FAULTS:
        book.begin(fault.key, NAN, 3.0, 0.0)
        assert failing_in('bot1: ' + book.words(0.0)[-1]) == (fault.key,)
    assert failing_in('; '.join(book.words(0.0))) == tuple(fault.key for fault in FAULTS)
