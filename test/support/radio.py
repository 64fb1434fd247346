# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a bad radio does to packets: which of them leave, and when. No clocks and no network here.

A table is a list of rows; each says from when on it holds [s from the start] and what changes then:

    - {at_s: 0, delay_ms: 50, jitter_ms: 10, loss_percent: 1, rate_mbit: 10, queue_ms: 200}
    - {at_s: 5, down: true}
    - {at_s: 5.5, down: false}

What no row has named is that of a clean cable. Packets keep their order, as on a real radio, which
sends one again before the next; so jitter only delays. A packet takes its time at ``rate_mbit`` (0:
no limit) whether it is lost or not; one that would wait for more than ``queue_ms`` is thrown away.
While it is down, all is lost that goes in or would come out.
"""
import collections
import math

DEFAULTS = {'delay_ms': 0.0, 'jitter_ms': 0.0, 'loss_percent': 0.0, 'rate_mbit': 0.0,
            'queue_ms': 200.0, 'down': False}
FATES = ('passed', 'lost', 'queue_full', 'down')


class TableError(ValueError):
    """A table that cannot be followed; the text names the row and the key."""


def _value(number, key, value):
    """Return a value of a row, checked."""
    if key == 'down':
        if not isinstance(value, bool):
            raise TableError('row {}: down: expected true or false, got {!r}'.format(number, value))
        return value
    good = isinstance(value, (int, float)) and not isinstance(value, bool) and \
        math.isfinite(value) and value >= 0 and (key != 'loss_percent' or value <= 100)
    if not good:
        raise TableError('row {}: {}: expected a number from 0{}, got {!r}'.format(
            number, key, ' to 100' if key == 'loss_percent' else ' up', value))
    return float(value)


def read_table(rows):
    """Return a table as a list of (time [s], all values by their keys).

    :param rows: a list of dictionaries, as from YAML
    :raises TableError: it says what is wrong with which row
    """
    if not isinstance(rows, list) or not rows:
        raise TableError('expected a list of rows, got {!r}'.format(rows))
    found, values = [], dict(DEFAULTS)
    for number, row in enumerate(rows, 1):
        if not isinstance(row, dict) or 'at_s' not in row:
            raise TableError('row {}: expected at_s and what changes then, got {!r}'.format(
                number, row))
        unknown = set(row) - set(DEFAULTS) - {'at_s'}
        if unknown:
            raise TableError('row {}: there is no {}; there are {}'.format(
                number, ', '.join(sorted(map(str, unknown))), ', '.join(sorted(DEFAULTS))))
        at_s = _value(number, 'at_s', row['at_s'])
        if (found and at_s <= found[-1][0]) or (not found and at_s != 0.0):
            raise TableError('row {}: at_s: the first is 0, each other later than the one before'
                             .format(number))
        values = dict(values, **{key: _value(number, key, value)
                                 for key, value in row.items() if key != 'at_s'})
        found.append((at_s, values))
    return found


class Table:
    """A table in use.

    :param rows: from :func:`read_table`
    :param start_s: when it starts, on the clock of whoever asks
    """

    def __init__(self, rows, start_s):
        self.rows = [(start_s + at_s, values) for at_s, values in rows]

    def at(self, now_s):
        """Return (number of the row, its values) in force at a time; the first before it, too."""
        for number in range(len(self.rows) - 1, 0, -1):
            if self.rows[number][0] <= now_s:
                return number, self.rows[number][1]
        return 0, self.rows[0][1]


class Count:
    """What became of the packets that came in under one row."""

    def __init__(self):
        self.fates = collections.Counter()
        self.bytes_passed = 0
        self.delays_s = []

    def figures(self, took_s):
        """Return it as a dictionary; ``took_s``: how long the row was in force [s].

        Delays are ``None`` where nothing passed.
        """
        total = sum(self.fates.values())
        delays = sorted(self.delays_s)
        found = {fate: self.fates[fate] for fate in FATES}
        found.update(
            packets=total, bytes_per_s=self.bytes_passed / took_s if took_s > 0.0 else 0.0,
            gone_percent=100.0 * (1.0 - self.fates['passed'] / total) if total else 0.0,
            lost_percent=self._lost_percent(),
            delay_p50_ms=percentile_ms(delays, 0.5), delay_p95_ms=percentile_ms(delays, 0.95))
        return found

    def _lost_percent(self):
        """Return the share that the radio lost of what it sent, neither down nor full."""
        sent = self.fates['passed'] + self.fates['lost']
        return 100.0 * self.fates['lost'] / sent if sent else 0.0


def percentile_ms(values_s, share):
    """Return the value below which a share of the sorted values lies [ms]; None of no values."""
    if not values_s:
        return None
    return 1000.0 * values_s[min(len(values_s) - 1, int(share * len(values_s)))]


class Channel:
    """One direction of the radio.

    :param table: a :class:`Table`
    :param dice: a ``random.Random``, for loss and jitter
    """

    def __init__(self, table, dice):
        self._dice = dice
        self._free_s = self._last_s = -math.inf
        self._on_the_way = collections.deque()
        self.follow(table)

    def follow(self, table):
        """Go over to another table; counting starts anew, what is on its way goes on."""
        self._table = table
        self.counts = [Count() for _ in table.rows]

    def put(self, now_s, packet):
        """Take a packet in."""
        row, values = self._table.at(now_s)
        count = self.counts[row]
        if values['down']:
            count.fates['down'] += 1
            return
        begin_s = max(now_s, self._free_s)
        if begin_s - now_s > values['queue_ms'] * 1e-3:
            count.fates['queue_full'] += 1
            return
        rate = values['rate_mbit'] * 1e6
        self._free_s = begin_s + (8 * len(packet) / rate if rate else 0.0)
        if self._dice.random() * 100.0 < values['loss_percent']:
            count.fates['lost'] += 1
            return
        due_s = self._free_s + values['delay_ms'] * 1e-3
        if values['jitter_ms']:
            due_s += self._dice.random() * values['jitter_ms'] * 1e-3
        self._last_s = due_s = max(due_s, self._last_s)
        self._on_the_way.append((due_s, now_s, packet, count))

    def next_s(self):
        """Return when the next packet is due; None if none is on its way."""
        return self._on_the_way[0][0] if self._on_the_way else None

    def take(self, now_s):
        """Return the packets that are due by now, in order; those due while down are lost."""
        found = []
        while self._on_the_way and self._on_the_way[0][0] <= now_s:
            due_s, came_s, packet, count = self._on_the_way.popleft()
            if self._table.at(due_s)[1]['down']:
                count.fates['down'] += 1
                continue
            count.fates['passed'] += 1
            count.bytes_passed += len(packet)
            count.delays_s.append(now_s - came_s)
            found.append(packet)
        return found
