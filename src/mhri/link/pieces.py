# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Splits pictures into pieces of one packet, so that commands do not wait for whole pictures.

A picture in one message consists of many packets, sent in one burst and lost with any one of them.
On a radio that loses packets each group of pieces has a spare, their exclusive or, which replaces
any one of them. This is cheaper than sending each picture twice.
"""
from dataclasses import dataclass
import struct
from typing import Dict, List, Optional

from mhri.link.frames import FrameError

# Fits into an Ethernet packet with its headers [bytes].
PIECE_BYTES = 1200
MAX_PIECES = 4000
# Number of the picture, index of the piece, number of spares, size of the picture, its time.
_HEAD = struct.Struct('>IHHId')


def _xor(parts: List[bytes], size: int) -> bytes:
    """Return the exclusive or of pieces, padded to a size."""
    found = 0
    for part in parts:
        found ^= int.from_bytes(part.ljust(size, b'\0'), 'big')
    return found.to_bytes(size, 'big')


def _plan(length: int) -> int:
    """Return the size of the pieces of a picture by its length [bytes]."""
    return -(-length // -(-length // PIECE_BYTES))


def split(number: int, stamp_s: float, body: bytes, group: int = 0) -> List[bytes]:
    """Return the pieces of a picture, [] if it is too large.

    :param number: number of the picture
    :param stamp_s: its time by the sender's clock [s]
    :param group: maximum number of pieces per spare; 0 for no spares
    """
    if not 0 < len(body) <= MAX_PIECES * PIECE_BYTES:
        return []
    size = _plan(len(body))
    parts = [body[at:at + size] for at in range(0, len(body), size)]
    spares = -(-len(parts) // group) if group else 0
    # Pieces of a group are spread, since a radio often loses consecutive packets.
    parts += [_xor(parts[first::spares], size) for first in range(spares)]
    return [_HEAD.pack(number & 0xffffffff, place, spares, len(body), stamp_s) + part
            for place, part in enumerate(parts)]


@dataclass(frozen=True)
class WholePicture:
    """A complete picture."""

    stamp_s: float
    body: bytes


class PieceAssembler:
    """Reassembles the newest picture of a stream."""

    def __init__(self) -> None:
        self._number = -1
        self._shape = (0, 0)
        self._pieces: Dict[int, bytes] = {}
        self._done = False

    def add(self, data: bytes) -> Optional[WholePicture]:
        """Handle a piece; return the picture once it is complete.

        :raises FrameError: the piece is malformed
        """
        if len(data) <= _HEAD.size:
            raise FrameError('not a piece of a picture')
        number, place, spares, length, stamp_s = _HEAD.unpack_from(data)
        if not 0 < length <= MAX_PIECES * PIECE_BYTES:
            raise FrameError('an impossible piece of a picture')
        size = _plan(length)
        count = -(-length // size)
        if spares > count or place >= count + spares or len(data) - _HEAD.size > size:
            raise FrameError('an impossible piece of a picture')
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
        return WholePicture(stamp_s, b''.join(self._pieces[at] for at in range(count))[:length])

    def _mend(self, first: int, count: int, size: int) -> None:
        """Restore the one missing piece of a group."""
        group = list(range(first, count, self._shape[0])) + [count + first]
        missing = [at for at in group if at not in self._pieces]
        if len(missing) == 1:
            self._pieces[missing[0]] = _xor(
                [self._pieces[at] for at in group if at != missing[0]], size)
