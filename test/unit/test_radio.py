# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules of the bad radio: which packet leaves when, and what is told of it."""
import os
import random
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.radio import Channel, DEFAULTS, read_table, Table, TableError  # noqa: E402

PACKET = bytes(1250)  # 10 ms at 1 Mbit/s


def channel(*rows, seed=1):
    """Return a channel whose table starts at 100 s."""
    return Channel(Table(read_table(list(rows)), 100.0), random.Random(seed))


def taken(one, until_s):
    """Return [(when, packet)] as somebody gets them who looks in time."""
    found = []
    while one.next_s() is not None and one.next_s() <= until_s:
        now_s = one.next_s()
        found += [(now_s, packet) for packet in one.take(now_s)]
    return found


@pytest.mark.parametrize('rows, words', [
    ([], 'list of rows'), ({'at_s': 0}, 'list of rows'), ([3], 'row 1'),
    ([{'delay_ms': 1}], 'row 1: expected at_s'), ([{'at_s': 1}], 'the first is 0'),
    ([{'at_s': 0}, {'at_s': 0}], 'row 2: at_s'),
    ([{'at_s': 0, 'colour': 1}], 'no colour; there are delay_ms, down'),
    ([{'at_s': 0, 'delay_ms': -1}], 'delay_ms: expected a number from 0 up'),
    ([{'at_s': 0, 'delay_ms': float('nan')}], 'delay_ms'), ([{'at_s': 0, 'rate_mbit': '3'}], "'3'"),
    ([{'at_s': 0, 'loss_percent': 101}], '0 to 100'), ([{'at_s': 0, 'down': 1}], 'true or false')])
def test_bad_table_is_named(rows, words):
    with pytest.raises(TableError, match=words):
        read_table(rows)


def test_rows_change_what_they_name():
    table = read_table([{'at_s': 0, 'delay_ms': 50}, {'at_s': 5, 'down': True},
                        {'at_s': 5.5, 'down': False, 'loss_percent': 20}])
    assert table == [(0.0, dict(DEFAULTS, delay_ms=50.0)),
                     (5.0, dict(DEFAULTS, delay_ms=50.0, down=True)),
                     (5.5, dict(DEFAULTS, delay_ms=50.0, loss_percent=20.0))]


def test_row_in_force():
    table = Table(read_table([{'at_s': 0}, {'at_s': 2}, {'at_s': 3}]), 100.0)
    assert [table.at(now_s)[0] for now_s in (99.0, 100.0, 101.9, 102.0, 102.9, 103.0, 1e9)] == [
        0, 0, 0, 1, 1, 2, 2]


def test_clean_cable_passes_at_once():
    one = channel({'at_s': 0})
    one.put(100.0, b'a')
    assert one.next_s() == 100.0 and one.take(100.0) == [b'a'] and one.next_s() is None


def test_delay():
    one = channel({'at_s': 0, 'delay_ms': 50})
    one.put(100.0, b'a')
    one.put(100.01, b'b')
    assert one.take(100.049) == []
    assert taken(one, 101.0) == [(pytest.approx(100.05), b'a'), (pytest.approx(100.06), b'b')]


def test_jitter_delays_and_keeps_the_order():
    one = channel({'at_s': 0, 'delay_ms': 20, 'jitter_ms': 30})
    for number in range(500):
        one.put(100.0 + 0.001 * number, bytes([number % 256]))
    got = taken(one, 200.0)
    assert [packet[0] for _, packet in got] == [number % 256 for number in range(500)]
    late_s = [when - 100.0 - 0.001 * number for number, (when, _) in enumerate(got)]
    assert 0.0199 < min(late_s) and max(late_s) < 0.0501 and max(late_s) - min(late_s) > 0.01


def test_rate_spreads_a_burst_and_the_queue_is_bounded():
    one = channel({'at_s': 0, 'rate_mbit': 1, 'queue_ms': 45})
    for _ in range(10):
        one.put(100.0, PACKET)
    assert [when for when, _ in taken(one, 200.0)] == [
        pytest.approx(100.0 + 0.01 * number) for number in range(1, 6)]
    assert one.counts[0].fates == {'passed': 5, 'queue_full': 5}
    one.put(100.2, PACKET)
    assert one.next_s() == pytest.approx(100.21), 'the queue is empty again'


def test_loss_takes_its_share_and_its_time():
    one = channel({'at_s': 0, 'loss_percent': 20})
    for number in range(5000):
        one.put(100.0 + number, b'x')
        one.take(100.0 + number)
    assert 18.0 < one.counts[0].figures(1.0)['lost_percent'] < 22.0
    all_lost = channel({'at_s': 0, 'loss_percent': 100, 'rate_mbit': 1, 'queue_ms': 15})
    for _ in range(3):
        all_lost.put(100.0, PACKET)
    assert all_lost.next_s() is None
    assert all_lost.counts[0].fates == {'lost': 2, 'queue_full': 1}


def test_the_same_seed_loses_the_same():
    def fates(seed):
        one = channel({'at_s': 0, 'loss_percent': 50}, seed=seed)
        for number in range(100):
            one.put(100.0, bytes([number]))
        return one.take(100.0)
    assert fates(1) == fates(1) != fates(2)


def test_outage_loses_what_goes_in_and_what_would_come_out():
    one = channel({'at_s': 0, 'delay_ms': 200}, {'at_s': 1, 'down': True},
                  {'at_s': 1.5, 'down': False})
    for when, packet in ((100.7, b'out before'), (100.9, b'on its way'), (101.2, b'in it'),
                         (101.6, b'after')):
        one.put(when, packet)
    assert taken(one, 200.0) == [(pytest.approx(100.9), b'out before'),
                                 (pytest.approx(101.8), b'after')]
    assert [count.fates for count in one.counts] == [
        {'passed': 1, 'down': 1}, {'down': 1}, {'passed': 1}]


def test_figures():
    one = channel({'at_s': 0, 'delay_ms': 10})
    for number in range(20):
        one.put(100.0 + number, PACKET)
        one.take(100.01 + number + (0.05 if number == 19 else 0.0))
    figures = one.counts[0].figures(20.0)
    assert figures['packets'] == figures['passed'] == 20 and figures['bytes_per_s'] == 1250.0
    assert figures['delay_p50_ms'] == pytest.approx(10.0)
    assert figures['delay_p95_ms'] == pytest.approx(60.0), 'what the looker adds counts'
    nothing = channel({'at_s': 0}).counts[0].figures(0.0)
    assert nothing['delay_p50_ms'] is None and nothing['gone_percent'] == 0.0


def test_another_table_keeps_what_is_on_its_way():
    one = channel({'at_s': 0, 'delay_ms': 1000})
    one.put(100.0, b'slow')
    one.follow(Table(read_table([{'at_s': 0}]), 100.5))
    one.put(100.5, b'quick')
    assert taken(one, 200.0) == [(pytest.approx(101.0), b'slow'), (pytest.approx(101.0), b'quick')]
    assert one.counts[0].fates == {'passed': 1}
