# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Fetches the robot's recordings of a link outage once the link is back.

The robot keeps pieces, bags of some seconds. The host requests the next part of a piece, of 64 kB
at most, each time the one before has arrived; TLS carries them, so that nothing is lost but what
was on its way when the connection broke. So the robot keeps no state of a transfer, and an outage
only delays it.
"""
from dataclasses import dataclass, replace
import json
import math
import re
import struct
from typing import Collection, Dict, List, Optional, Tuple

from mhri.link.frames import FrameError, read_rows
from mhri.link.robot_claims import offer_problem
from mhri.robots.figures import FETCHING_WORD

RECORD = 'record'
# When the robot records for a host: during sessions; always; always, with pictures.
IN_SESSIONS, STATES, PICTURES = KEEPS = 'session', 'states', 'pictures'
# Streams of the link: the host's requests; the robot's offer; a part of a piece.
ASK, OFFER, PART = '_ask', '_offer', '_part'
PIECE_S = 10.0
# A part has up to so many steps; fewer if it takes longer than this [s] more than the shortest
# answer, since poses and commands may wait behind it for that time.
STEP_BYTES, MAX_STEPS, HOLD_S = 8192, 8, 0.03
# Maximum number of steps in a request of an older mhri.
_MAX_COUNT = 16
# An unanswered request is repeated after this: by then the connection is another one [s].
AGAIN_S = 5.0
# Period of the requests while nothing has to be fetched [s].
IDLE_S = 1.0
# Fetching is complete once the robot has offered nothing for this long [s].
ALL_THERE_S = 30.0
MAX_PIECES, MAX_OFFERED = 2000, 200
_HEAD = struct.Struct('>IQ')
_NAME = re.compile(r'(\d{6,10})_(\d{1,15})_(\d{1,9})\.bag\Z')


@dataclass(frozen=True)
class Piece:
    """A bag kept on the robot.

    :param number: unique, higher than those of earlier pieces
    :param begun_ms: start by the robot's clock [ms since 1970]
    :param lasts_ms: duration [ms]
    :param size: size [bytes]
    :param crc: CRC-32 of its bytes
    """

    number: int
    begun_ms: int
    lasts_ms: int
    size: int = 0
    crc: int = 0

    @property
    def name(self) -> str:
        """The name of its file."""
        return '{:06d}_{}_{}.bag'.format(self.number, self.begun_ms, self.lasts_ms)


def piece_of(name: str) -> Optional[Piece]:
    """Return the piece with a file name, None for other files."""
    found = _NAME.match(name)
    return Piece(*map(int, found.groups())) if found else None


def too_many(pieces: Collection[Piece], max_bytes: int) -> List[Piece]:
    """Return the oldest pieces, which have to be dropped to fit into a size."""
    gone: List[Piece] = []
    size = sum(piece.size for piece in pieces)
    for piece in sorted(pieces, key=lambda piece: piece.number):
        if size <= max_bytes and len(pieces) - len(gone) <= MAX_PIECES:
            break
        gone.append(piece)
        size -= piece.size
    return gone


@dataclass(frozen=True)
class Ask:
    """A request from the host to the robot.

    :param keep: whether to record outages from now on
    :param have: numbers of the pieces that are complete
    :param number: number of the requested piece, -1 for none
    :param offset: first byte requested
    :param count: maximum size of the part, in steps
    :param pictures: whether to record pictures, too
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
    # An older mhri on the robot expects five elements.
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
            or found[3] < 0 or not 0 <= found[4] <= _MAX_COUNT):
        raise FrameError('not a request for a recording')
    return Ask(found[0], tuple(found[1]), found[2], found[3], found[4], True in more)


def pack_offer(pieces: Collection[Piece]) -> bytes:
    """Return the bytes of an offer of pieces, the oldest first."""
    first = sorted(pieces, key=lambda piece: piece.number)[:MAX_OFFERED]
    return json.dumps([[piece.number, piece.begun_ms, piece.lasts_ms, piece.size, piece.crc]
                       for piece in first]).encode('ascii')


def unpack_offer(body: bytes) -> List[Piece]:
    """Return the pieces of an offer.

    :raises FrameError: it is malformed, or too large
    """
    found = read_rows(body)
    problem = offer_problem(found)
    if problem:
        raise FrameError(problem)
    return [Piece(*row) for row in found[:MAX_PIECES]]


def pack_part(number: int, offset: int, data: bytes) -> bytes:
    """Return the bytes of a part of a piece."""
    return _HEAD.pack(number, offset) + data


def unpack_part(body: bytes) -> Tuple[int, int, bytes]:
    """Return (number of the piece, offset, bytes).

    :raises FrameError: it is malformed
    """
    if len(body) <= _HEAD.size:
        raise FrameError('not a part of a recording')
    number, offset = _HEAD.unpack_from(body)
    return number, offset, body[_HEAD.size:]


class Fetch:
    """Decides what the host requests next; times are [s] of a monotonic clock.

    :param done: complete pieces of an earlier run
    :param asked: whether this host requested recordings in an earlier run
    """

    def __init__(self, done: Collection[Piece] = (), asked: bool = False) -> None:
        self.keep = self.pictures = False
        #: whether the robot may have recordings for this host; stored across restarts
        self.asked = asked
        #: number of offered pieces that this host never requested
        self.unasked = 0
        self._empty_since: Optional[float] = None
        # {number: received bytes} of incomplete pieces
        self._got: Dict[int, int] = {}
        self._told = False
        self._offered: Dict[int, Piece] = {}
        self._done = {piece.number: piece for piece in done}
        self._asked_at = -1e9
        # Number and offset of the unanswered request; the shortest answer of this piece [s].
        self._open: Optional[Tuple[int, int]] = None
        self._least_s = math.inf
        self._steps = 1

    def on_offer(self, pieces: Collection[Piece], now: float) -> None:
        """Handle an offer; it is ignored unless this host requested recordings."""
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
        """Handle a part; return whether it is the next one, which has to be written."""
        piece, end = self.next_piece(), offset + len(data)
        if piece is None or number != piece.number or end > piece.size \
                or offset != self._got.get(number, 0):
            return False
        self._got[number] = end
        if self._open == (number, offset):
            self._open, took_s = None, now - self._asked_at
            self._least_s = min(self._least_s, took_s)
            held = took_s - self._least_s > HOLD_S
            self._steps = max(1, self._steps // 2) if held else min(MAX_STEPS, self._steps + 1)
        return True

    def next_piece(self) -> Optional[Piece]:
        """Return the piece being fetched, or None."""
        left = [piece for number, piece in self._offered.items() if number not in self._done]
        return min(left, key=lambda piece: piece.number) if left else None

    def whole(self) -> Optional[Piece]:
        """Return the piece that is complete and has to be checked, or None."""
        piece = self.next_piece()
        return piece if piece and self._got.get(piece.number, 0) >= piece.size else None

    def checked(self, piece: Piece, good: bool) -> None:
        """Record that a piece is complete, or has to be fetched again."""
        self._got.pop(piece.number, None)
        self._open, self._least_s = None, math.inf
        if good:
            self._done[piece.number] = piece

    def ask(self, now: float) -> Optional[Ask]:
        """Return the request to send now, or None."""
        self.asked = self.asked or self.keep
        piece = self.next_piece()
        base = Ask(self.keep, tuple(sorted(set(self._done) & set(self._offered))),
                   pictures=self.pictures)
        if piece is None:
            if now - self._asked_at < IDLE_S:
                return None
            self._asked_at = now
            return base
        following = piece.number, self._got.get(piece.number, 0)
        if self._open == following and now - self._asked_at < AGAIN_S:
            return None
        self._open, self._asked_at = following, now
        return replace(base, number=following[0], offset=following[1], count=self._steps)

    def finished(self) -> List[Piece]:
        """Return the complete pieces once nothing is left to fetch, and forget them."""
        # Wait until the robot has deleted them.
        if not self._told or self._offered or not self._done:
            return []
        done, self._done = sorted(self._done.values(), key=lambda piece: piece.number), {}
        return done

    def words(self, robot: str) -> str:
        """Return the progress, e.g. "fetching 38 of 120 s from bot1"; '' if nothing is fetched."""
        piece = self.next_piece()
        if piece is None:
            return ''
        all_ms = sum(one.lasts_ms for one in {**self._offered, **self._done}.values())
        done_ms = sum(one.lasts_ms for one in self._done.values())
        done_ms += int(piece.lasts_ms * self._got.get(piece.number, 0) / max(1, piece.size))
        return '{} {:.0f} of {:.0f} s from {}'.format(
            FETCHING_WORD, 1e-3 * done_ms, 1e-3 * all_ms, robot)
