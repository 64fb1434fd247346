# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Splits the byte stream of a TCPROS connection into messages."""
import struct
from typing import List, Sequence

_UNPACK_U32 = struct.Struct('<I').unpack_from


class FrameSplitter:
    """Splits the bytes of one TCPROS connection into frames: a length (4 bytes) and a message.

    ``wanted`` is the number of missing bytes of the present message, 0 if unknown.
    """

    MAX_BYTES = 10 ** 9

    def __init__(self) -> None:
        self.wanted = 0
        self._parts: List[bytes] = []

    def split(self, data: bytes) -> Sequence[bytes]:
        """Return the frames completed by these bytes.

        :raises ValueError: a length is over the limit of roscpp, 1 GB
        """
        if self._parts:
            if self.wanted > len(data):
                self._parts.append(data)
                self.wanted -= len(data)
                return ()
            self._parts.append(data)
            data = b''.join(self._parts)
            self._parts = []
            self.wanted = 0
        length = len(data)
        if length >= 4 and _UNPACK_U32(data)[0] == length - 4:
            return (data,)
        return self._cut(data, length)

    def _cut(self, data: bytes, length: int) -> List[bytes]:
        frames: List[bytes] = []
        start = 0
        while length - start >= 4:
            size = _UNPACK_U32(data, start)[0]
            if size > self.MAX_BYTES:
                raise ValueError('a message of {} bytes'.format(size))
            end = start + 4 + size
            if end > length:
                self.wanted = end - length
                break
            frames.append(data[start:end])
            start = end
        if start < length:
            self._parts.append(data[start:])
        return frames
