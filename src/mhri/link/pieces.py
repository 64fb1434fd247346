# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures in pieces, each of one packet: so that commands need not wait behind a whole picture.

A picture in one message is many packets, all sent at once, and lost with any one of them. On a
radio that loses packets a few pieces each have a spare one, their exclusive or, from which any one
of them comes back: for the bytes of a picture sent twice go two or three pictures in that way.
"""
from dataclasses import dataclass
import struct
from typing import Dict, List, Optional

from mhri.link.frames import FrameError

# With what is around it less than a packet of Ethernet [bytes].
PIECE_BYTES = 1200
MOST_PIECES = 4000
# Number of the picture, place of the piece, how many spare ones there are, bytes, when taken.
_HEAD = struct.Struct('>IHHId')


def _xor(parts: List[bytes], size: int) -> bytes:
    """Return the exclusive or of pieces, as if each had so many bytes."""
    found = 0
    for part in parts:
        found ^= int.from_bytes(part.ljust(size, b'\0'), 'big')
    return found.to_bytes(size, 'big')


def _plan(length: int) -> int:
    """Return the size of the pieces of a picture of so many bytes."""
    return -(-length // -(-length // PIECE_BYTES))


def split(number: int, stamp_s: float, body: bytes, group: int = 0) -> List[bytes]:
    """Return the pieces of a picture; none of one that is too large.

    :param number: of the picture
    :param stamp_s: its time by the sender's clock [s]
    :param group: so many pieces, at most, have a spare one; 0 for none
    """
    if not 0 < len(body) <= MOST_PIECES * PIECE_BYTES:
        return []
    size = _plan(len(body))
    parts = [body[at:at + size] for at in range(0, len(body), size)]
    spares = -(-len(parts) // group) if group else 0
    # Those of one group lie far apart: what a radio loses together is rarely of one.
    parts += [_xor(parts[first::spares], size) for first in range(spares)]
    return [_HEAD.pack(number & 0xffffffff, place, spares, len(body), stamp_s) + part
            for place, part in enumerate(parts)]


@dataclass(frozen=True)
class Whole:
    """A picture of which all pieces came."""

    stamp_s: float
    body: bytes


class Gathered:
    """Puts the newest picture of a stream together again."""

    def __init__(self) -> None:
        self._number = -1
        self._shape = (0, 0)
        self._pieces: Dict[int, bytes] = {}
        self._done = False

    def add(self, data: bytes) -> Optional[Whole]:
        """Take in a piece; return the picture if it was the last one missing.

        :raises FrameError: it is none
        """
        if len(data) <= _HEAD.size:
            raise FrameError('no piece of a picture')
        number, place, spares, length, stamp_s = _HEAD.unpack_from(data)
        if not 0 < length <= MOST_PIECES * PIECE_BYTES:
            raise FrameError('a piece that no picture has')
        size = _plan(length)
        count = -(-length // size)
        if spares > count or place >= count + spares or len(data) - _HEAD.size > size:
            raise FrameError('a piece that no picture has')
        if number != self._number:
            self._number, self._shape, self._pieces = number, (spares, length), {}
            self._done = False
        if (spares, length) != self._shape:
            raise FrameError('a piece of another picture')
        if self._done:
            return None
        self._pieces[place] = data[_HEAD.size:]
        if spares:
            self._mend(place % spares if place < count else place - count, count, size)
        if any(at not in self._pieces for at in range(count)):
            return None
        self._done = True
        return Whole(stamp_s, b''.join(self._pieces[at] for at in range(count))[:length])

    def _mend(self, first: int, count: int, size: int) -> None:
        """Find the one piece of a group that did not come."""
        group = list(range(first, count, self._shape[0])) + [count + first]
        missing = [at for at in group if at not in self._pieces]
        if len(missing) == 1:
            self._pieces[missing[0]] = _xor(
                [self._pieces[at] for at in group if at != missing[0]], size)
