# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Class record: what the robot kept while the host was gone is fetched when the link is back.

The robot keeps pieces, bags of some seconds. The host asks again and again, for a few parts of one
piece at a time, beginning where it has got to; whatever is lost is asked for once more. So nothing
has to be remembered on the robot, and an outage in the middle only takes time.
"""
from dataclasses import dataclass, replace
import json
import re
import struct
from typing import Collection, Dict, List, Optional, Tuple
import zlib

from mhri.link.frames import FrameError, read_rows
from mhri.link.robot_claims import offer_problem
from mhri.robots.figures import FETCHING_WORD

RECORD = 'record'
# What a host has kept for it on the robot: in a session alone, always, always and with pictures.
IN_SESSIONS, STATES, PICTURES = KEEPS = 'session', 'states', 'pictures'
# Streams of the link: what the host asks; what there is; a part of it.
ASK, OFFER, PART = '_ask', '_offer', '_part'
PIECE_S = 10.0
PART_BYTES = 8192
# So many parts are asked for at once, and fewer where they come over a longer time than this [s]:
# for so long a pose or a command may wait behind them.
MOST_PARTS, HOLD_S = 16, 0.03
# Without an answer it is asked again, for less; after so many times as an answer takes, within [s].
AGAIN_S, LEAST_AGAIN_S, ANSWERS = 1.0, 0.1, 4.0
# Who has nothing to fetch says so every so often [s].
IDLE_S = 1.0
# What a host asked a robot to keep is all there once it has nothing to offer for so long [s].
ALL_THERE_S = 30.0
MOST_PIECES, MOST_OFFERED = 2000, 200
_HEAD = struct.Struct('>IQ')
_NAME = re.compile(r'(\d{6,10})_(\d{1,15})_(\d{1,9})\.bag\Z')


@dataclass(frozen=True)
class Piece:
    """A bag that the robot has kept.

    :param number: of this piece alone, and higher than those before it
    :param begun_ms: by the robot's clock [ms since 1970]
    :param lasts_ms: how long it is [ms]
    :param size: its bytes
    :param crc: of all of them (CRC-32)
    """

    number: int
    begun_ms: int
    lasts_ms: int
    size: int = 0
    crc: int = 0

    @property
    def name(self) -> str:
        """Return its file's name."""
        return '{:06d}_{}_{}.bag'.format(self.number, self.begun_ms, self.lasts_ms)


def piece_of(name: str) -> Optional[Piece]:
    """Return the piece that a file is, as far as its name says; None if it is none."""
    found = _NAME.match(name)
    return Piece(*map(int, found.groups())) if found else None


def too_many(pieces: Collection[Piece], most_bytes: int) -> List[Piece]:
    """Return the oldest pieces, which have to go so that the rest takes no more than that."""
    gone: List[Piece] = []
    size = sum(piece.size for piece in pieces)
    for piece in sorted(pieces, key=lambda piece: piece.number):
        if size <= most_bytes and len(pieces) - len(gone) <= MOST_PIECES:
            break
        gone.append(piece)
        size -= piece.size
    return gone


@dataclass(frozen=True)
class Ask:
    """What the host says to the robot.

    :param keep: keep what I miss from now on
    :param have: numbers of pieces that came whole
    :param number: of the piece that is wanted, -1 for none
    :param offset: from which byte on
    :param count: how many parts
    :param pictures: keep pictures, too
    """

    keep: bool = False
    have: Tuple[int, ...] = ()
    number: int = -1
    offset: int = 0
    count: int = 0
    pictures: bool = False


def pack_ask(ask: Ask) -> bytes:
    """Return the bytes of an :class:`Ask`."""
    row = [ask.keep, ask.have, ask.number, ask.offset, ask.count]
    # An older mhri on the robot knows five.
    return json.dumps(row + [True] * ask.pictures).encode('ascii')


def unpack_ask(body: bytes) -> Ask:
    """Return the :class:`Ask` of bytes.

    :raises FrameError: they are none
    """
    found = read_rows(body)
    more = found[5:]
    if (len(found) < 5 or [type(part) for part in more] not in ([], [bool])
            or type(found[0]) is not bool or not isinstance(found[1], list)
            or not all(type(part) is int for part in found[1] + found[2:5])
            or found[3] < 0 or not 0 <= found[4] <= MOST_PARTS):
        raise FrameError('no request for a recording')
    return Ask(found[0], tuple(found[1]), found[2], found[3], found[4], True in more)


def pack_offer(pieces: Collection[Piece]) -> bytes:
    """Return the bytes of what there is to fetch, the oldest first."""
    first = sorted(pieces, key=lambda piece: piece.number)[:MOST_OFFERED]
    return json.dumps([[piece.number, piece.begun_ms, piece.lasts_ms, piece.size, piece.crc]
                       for piece in first]).encode('ascii')


def unpack_offer(body: bytes) -> List[Piece]:
    """Return the pieces that bytes say.

    :raises FrameError: they say none
    """
    found = read_rows(body)
    problem = offer_problem(found)
    if problem:
        raise FrameError(problem)
    return [Piece(*row) for row in found[:MOST_PIECES]]


def pack_part(number: int, offset: int, data: bytes) -> bytes:
    """Return the bytes of a part of a piece."""
    return _HEAD.pack(number, offset) + data


def unpack_part(body: bytes) -> Tuple[int, int, bytes]:
    """Return (number of the piece, offset, bytes).

    :raises FrameError: it is none
    """
    if len(body) <= _HEAD.size:
        raise FrameError('no part of a recording')
    number, offset = _HEAD.unpack_from(body)
    return number, offset, body[_HEAD.size:]


class Fetch:
    """Decides what the host asks for next; times are [s] of a clock that never goes back.

    :param got: {number: bytes that are there already} of pieces that came in part
    :param done: pieces that came whole and wait for the rest
    :param window: how many parts are asked for at first
    :param asked: whether this host has asked the robot, in an earlier run, to keep something
    """

    def __init__(self, got: Optional[Dict[int, int]] = None, window: int = 1,
                 done: Collection[Piece] = (), asked: bool = False) -> None:
        self.keep = self.pictures = False
        #: whether the robot may have something that this host asked it to keep; remember it
        self.asked = asked
        #: how many pieces the robot offers that this host never asked for
        self.unasked = 0
        self._empty_since: Optional[float] = None
        self._got = dict(got or {})
        self._told = False
        self._offered: Dict[int, Piece] = {}
        self._done = {piece.number: piece for piece in done}
        self._asked_at = self._heard_at = self._first_at = -1e9
        self._until = 0
        self._window = window
        # Of the parts that were asked for last one is missing; how long an answer takes [s].
        self._torn, self._answer_s = False, AGAIN_S

    def on_offer(self, pieces: Collection[Piece], now: float) -> None:
        """Take in what there is to fetch; nothing, unless this host asked the robot to keep it."""
        self.unasked = 0 if self.asked else len(pieces)
        self._offered = {piece.number: piece for piece in pieces} if self.asked else {}
        self._told = True
        if pieces or self.keep:
            self._empty_since = None
        elif self._empty_since is None:
            self._empty_since = now
        elif now - self._empty_since >= ALL_THERE_S:
            self.asked = False

    def on_part(self, number: int, offset: int, data: bytes, now: float) -> bool:
        """Take in a part; return whether it is the next one, and to be written."""
        piece, end = self.wanted(), offset + len(data)
        if piece is None or number != piece.number or end > piece.size:
            return False
        got = self._got.get(number, 0)
        if offset != got:
            # Behind the last one comes none of those that are missing.
            self._torn = self._torn or got < offset and end >= self._until
            return False
        if self._first_at < self._asked_at:
            self._first_at = now
            self._answer_s += 0.2 * (now - self._asked_at - self._answer_s)
        self._heard_at = now
        self._got[number] = end
        if end >= self._until:
            held = now - self._first_at > HOLD_S
            self._window = max(1, self._window // 2) if held else min(MOST_PARTS, self._window + 1)
        return True

    def wanted(self) -> Optional[Piece]:
        """Return the piece that is being fetched, None for none."""
        left = [piece for number, piece in self._offered.items() if number not in self._done]
        return min(left, key=lambda piece: piece.number) if left else None

    def whole(self) -> Optional[Piece]:
        """Return the piece all bytes of which have come, to be checked."""
        piece = self.wanted()
        return piece if piece and self._got.get(piece.number, 0) >= piece.size else None

    def checked(self, piece: Piece, good: bool) -> None:
        """Take in that a piece came whole, or has to be fetched once more."""
        self._got.pop(piece.number, None)
        self._until = 0
        if good:
            self._done[piece.number] = piece

    def ask(self, now: float) -> Optional[Ask]:
        """Return what to ask now, None for nothing."""
        self.asked = self.asked or self.keep
        piece = self.wanted()
        base = Ask(self.keep, tuple(sorted(set(self._done) & set(self._offered))),
                   pictures=self.pictures)
        if piece is None:
            if now - self._asked_at < IDLE_S:
                return None
            self._asked_at = now
            return base
        got = self._got.get(piece.number, 0)
        if got < self._until:
            again_s = min(AGAIN_S, max(LEAST_AGAIN_S, ANSWERS * self._answer_s))
            if not self._torn and now - max(self._asked_at, self._heard_at) < again_s:
                return None
            # What was lost was too much for the radio.
            self._window = max(1, self._window // 2)
            self._answer_s = min(AGAIN_S, self._answer_s * (1.0 if self._torn else 2.0))
        self._asked_at, self._torn = now, False
        self._until = min(piece.size, got + self._window * PART_BYTES)
        return replace(base, number=piece.number, offset=got, count=self._window)

    def finished(self) -> List[Piece]:
        """Return the pieces that came, once nothing is left to fetch; they count no more then."""
        # The robot has to know that they came.
        if not self._told or self._offered or not self._done:
            return []
        done, self._done = sorted(self._done.values(), key=lambda piece: piece.number), {}
        return done

    def words(self, robot: str) -> str:
        """Return how far it is, e.g. "fetching 38 of 120 s from bot1"; '' if nothing is fetched."""
        piece = self.wanted()
        if piece is None:
            return ''
        all_ms = sum(one.lasts_ms for one in {**self._offered, **self._done}.values())
        done_ms = sum(one.lasts_ms for one in self._done.values())
        done_ms += int(piece.lasts_ms * self._got.get(piece.number, 0) / max(1, piece.size))
        return '{} {:.0f} of {:.0f} s from {}'.format(
            FETCHING_WORD, 1e-3 * done_ms, 1e-3 * all_ms, robot)


def crc_of(data: bytes, before: int = 0) -> int:
    """Return the checksum of bytes, going on from that of those before them."""
    return zlib.crc32(data, before)
