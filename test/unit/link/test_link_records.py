# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Fetching what a robot kept during an outage, over a radio that loses things."""
import heapq
import json
import random
from zlib import crc32

import pytest

from mhri.link.frames import FrameError
from mhri.link.records import (
    AGAIN_S, ALL_THERE_S, Ask, Fetch, MAX_STEPS, pack_ask, pack_offer, pack_part, Piece,
    piece_of, STEP_BYTES, too_many, unpack_ask, unpack_offer, unpack_part)

FILES = {3: bytes(range(256)) * 500, 4: b'x' * 70000, 7: b'y'}


def pieces():
    return [Piece(number, 1000 * number, 10000, len(data), crc32(data))
            for number, data in FILES.items()]


class Robot:
    """Answers an ask with a part, unless the connection breaks."""

    def __init__(self, dice, loss):
        self.kept = {piece.number: piece for piece in pieces()}
        self._dice, self._loss = dice, loss
        self.sent = 0

    def answer(self, ask):
        for number in ask.have:
            self.kept.pop(number, None)
        if ask.number in self.kept:
            data = FILES[ask.number][ask.offset:ask.offset + ask.count * STEP_BYTES]
            self.sent += len(data)
            if data and self._dice.random() >= self._loss:
                yield unpack_part(pack_part(ask.number, ask.offset, data))


def fetched(loss, fetch, robot, came, until=600.0, spoil=None):
    """Let host and robot talk; return when all was there [s]."""
    now = 0.0
    while now < until:
        now += 0.01
        if int(now * 100) % 100 == 0:
            fetch.on_offer(unpack_offer(pack_offer(robot.kept.values())), now)
        ask = fetch.ask(now)
        for number, offset, data in robot.answer(unpack_ask(pack_ask(ask))) if ask else ():
            if fetch.on_part(number, offset, data, now):
                came[number] = came.get(number, b'')[:offset] + (spoil or (lambda part: part))(data)
        whole = fetch.whole()
        if whole:
            good = crc32(came[whole.number]) == whole.crc
            fetch.checked(whole, good)
            spoil = None
        if fetch.finished():
            return now
    raise AssertionError('not fetched')


@pytest.mark.parametrize('loss', [0.0, 0.05, 0.3])
def test_all_comes_whole_whatever_is_lost(loss):
    robot, came = Robot(random.Random(1), loss), {}
    fetched(loss, Fetch(asked=True), robot, came)
    assert came == FILES and robot.kept == {}
    # It goes on where it had got to, and only a part on its way is sent again.
    assert robot.sent < (1.0 + 12.0 * loss) * sum(map(len, FILES.values())) + 1


class Radio:
    """Carries asks and parts, one after the other; times are [s].

    :param rate: of what it carries [bytes/s]
    :param delay_s: how long anything is on its way, without what waits before it
    """

    def __init__(self, rate, delay_s):
        self._rate, self._delay_s = rate, delay_s
        self._free_at = 0.0
        #: the longest that anything would have waited behind parts
        self.waits_s = 0.0

    def _answered(self, ask, size, now):
        """Yield (when it comes, offset, bytes) of each part that comes."""
        self._free_at = max(self._free_at, now + self._delay_s)
        data = bytes(min(ask.count * STEP_BYTES, size - ask.offset))
        self._free_at += len(data) / self._rate
        yield self._free_at + self._delay_s, ask.offset, data
        self.waits_s = max(self.waits_s, self._free_at - now - self._delay_s)

    def fetches(self, size, until_s=200.0):
        """Return how many bytes a second come of a piece."""
        fetch, on_way, now = Fetch(asked=True), [], 0.0
        fetch.on_offer([Piece(1, 1, 1, size, 1)], now)
        while now < until_s:
            ask = fetch.ask(now)
            for row in self._answered(ask, size, now) if ask else ():
                heapq.heappush(on_way, row)
            # As the host's side does: it looks when something comes, and ten times a second.
            now = min([now + 0.1] + [row[0] for row in on_way[:1]])
            while on_way and on_way[0][0] <= now:
                fetch.on_part(1, *heapq.heappop(on_way)[1:], now)
            if fetch.whole():
                return size / now
        return 0.0


@pytest.mark.parametrize('rate, delay_s, least', [
    (10e6, 0.001, 0.7), (1e6, 0.005, 0.6), (2e5, 0.02, 0.4)])
def test_it_takes_what_a_radio_bears_and_holds_up_others_for_a_moment_alone(rate, delay_s, least):
    radio = Radio(rate, delay_s)
    share = radio.fetches(int(5.0 * rate)) / rate
    print('MEASURED of {:.1f} MB/s: {:.0%}, others wait {:.0f} ms'.format(
        1e-6 * rate, share, 1e3 * radio.waits_s))
    assert share > least
    # Of a slow radio one part is more.
    assert radio.waits_s < 0.05 + 2.0 * STEP_BYTES / rate


def test_a_part_has_at_most_64_kb_and_is_asked_for_again_once_the_connection_is_another():
    fetch, size, offset, now = Fetch(asked=True), 100 * STEP_BYTES, 0, 0.0
    fetch.on_offer([Piece(1, 1, 1, size, 1)], now)
    for _ in range(2 * MAX_STEPS):
        ask = fetch.ask(now)
        assert ask.offset == offset and ask.count * STEP_BYTES <= 65536
        assert fetch.on_part(1, offset, bytes(ask.count * STEP_BYTES), now)
        offset += ask.count * STEP_BYTES
    assert ask.count == MAX_STEPS and fetch.ask(now).offset == offset
    assert fetch.ask(now + 0.9 * AGAIN_S) is None
    assert fetch.ask(now + AGAIN_S).offset == offset


def test_a_piece_that_came_wrong_is_fetched_once_more():
    robot, came = Robot(random.Random(1), 0.0), {}
    fetched(0.0, Fetch(asked=True), robot, came, spoil=lambda data: b'?' * len(data))
    assert came == FILES


@pytest.mark.parametrize('offset', [1, STEP_BYTES, 10 ** 9])
def test_a_part_that_does_not_follow_is_not_taken(offset):
    fetch = Fetch(asked=True)
    fetch.on_offer(pieces(), 0.0)
    fetch.ask(0.0)
    assert not fetch.on_part(3, offset, b'x', 0.1)
    assert not fetch.on_part(4, 0, b'x', 0.1)


def test_what_nobody_asked_for_is_not_fetched():
    fetch = Fetch()
    for now in (0.0, 10.0, 20.0):
        fetch.on_offer(pieces(), now)
        assert fetch.next_piece() is None and fetch.ask(now).number == -1 and fetch.unasked == 3
        assert not fetch.on_part(3, 0, FILES[3], now)
    fetch.keep = True
    assert fetch.ask(30.0).keep
    fetch.keep = False
    fetch.on_offer(pieces(), 31.0)
    assert fetch.ask(32.0).number == 3 and fetch.unasked == 0


def test_what_was_asked_for_is_fetched_until_there_is_no_more_of_it():
    fetch = Fetch(asked=True)
    for now in (0.0, 0.9 * ALL_THERE_S):
        fetch.on_offer([], now)
    fetch.on_offer(pieces(), now + 1.0)
    assert fetch.ask(now + 2.0).number == 3
    for since in (2.0, 3.0 + ALL_THERE_S):
        fetch.on_offer([], now + since)
    fetch.on_offer(pieces(), now + 4.0 + ALL_THERE_S)
    assert fetch.next_piece() is None and not fetch.asked


@pytest.mark.parametrize('most, numbers', [(10 ** 9, []), (100000, [3]), (0, [3, 4, 7])])
def test_the_oldest_go_where_there_is_no_room(most, numbers):
    assert [piece.number for piece in too_many(pieces(), most)] == numbers


def test_a_name_says_what_a_piece_is():
    piece = Piece(12, 1700000000123, 10000)
    assert piece_of(piece.name) == piece
    for name in ('000012.bag', '000012_1_2.bag.active', 'x000012_1_2.bag', '000012_1_2.bag/..'):
        assert piece_of(name) is None


@pytest.mark.parametrize('body', [
    b'', b'{}', b'[1]', b'[true,[],0,0]', b'[true,[],0,-1,1]', b'[true,[],0,0,9999]',
    b'[true,["a"],0,0,1]', b'[1,[],0,0,1]',
    b'[true,[],0,0,1,""]', b'[true,[],0,0,1,1]', b'[true,[],0,0,1,true,true]',
    b'[true,[],0.5,0,1]', b'\xff'])
def test_what_is_no_ask_is_refused(body):
    with pytest.raises(FrameError):
        unpack_ask(body)


@pytest.mark.parametrize('body', [b'', b'[[1]]', b'[[1,2,3,4,-5]]', b'[["a",1,1,1,1]]', b'{}',
                                  b'[[1,2,3,1000000000000000000,5]]'])
def test_what_is_no_offer_is_refused(body):
    with pytest.raises(FrameError):
        unpack_offer(body)


def test_an_ask_comes_back_as_it_was():
    for ask in (Ask(True, (1, 2), 3, 4, 5), Ask(True, (), -1, 0, 0, pictures=True)):
        assert unpack_ask(pack_ask(ask)) == ask
    assert json.loads(pack_ask(Ask(True)).decode()) == [True, [], -1, 0, 0], 'as it always was'
