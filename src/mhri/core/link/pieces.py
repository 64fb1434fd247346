# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures in pieces, each of one packet: so that commands need not wait behind a whole picture.

A picture in one message is many packets, all sent at once, and lost with any one of them.
"""
from dataclasses import dataclass
import struct
from typing import Dict, List, Optional

from mhri.core.link.frames import FrameError

# With what is around it less than a packet of Ethernet [bytes].
PIECE_BYTES = 1200
MOST_PIECES = 4000
_HEAD = struct.Struct('>IHHd')


def split(number: int, stamp_s: float, body: bytes) -> List[bytes]:
    """Return the pieces of a picture; none of one that is too large.

    :param number: of the picture
    :param stamp_s: its time by the sender's clock [s]
    """
    count = -(-len(body) // PIECE_BYTES)
    if count > MOST_PIECES:
        return []
    return [_HEAD.pack(number & 0xffffffff, place, count, stamp_s)
            + body[place * PIECE_BYTES:(place + 1) * PIECE_BYTES] for place in range(count)]


@dataclass(frozen=True)
class Whole:
    """A picture of which all pieces came."""

    stamp_s: float
    body: bytes


class Gathered:
    """Puts the newest picture of a stream together again."""

    def __init__(self) -> None:
        self._number = -1
        self._count = 0
        self._pieces: Dict[int, bytes] = {}

    def add(self, data: bytes) -> Optional[Whole]:
        """Take in a piece; return the picture if it was the last one missing.

        :raises FrameError: it is none
        """
        if len(data) <= _HEAD.size:
            raise FrameError('no piece of a picture')
        number, place, count, stamp_s = _HEAD.unpack_from(data)
        if not place < count <= MOST_PIECES:
            raise FrameError('a piece that no picture has')
        if number != self._number:
            self._number, self._count, self._pieces = number, count, {}
        if count != self._count:
            raise FrameError('a piece of another picture')
        if place in self._pieces or len(self._pieces) == count:
            return None
        self._pieces[place] = data[_HEAD.size:]
        if len(self._pieces) < count:
            return None
        return Whole(stamp_s, b''.join(self._pieces[at] for at in range(count)))
