# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The records of a rosbag 2.0 file as bytes (http://wiki.ros.org/Bags/Format/2.0).

``rosbag.Bag`` writes a chunk piece by piece and goes back to its header at the end: a program that
is killed leaves the chunk without a size, and a full disk leaves half an index. Here a chunk is
made in memory, with its size and its index, to be written in one piece. It also costs much less:
the header of a message is the same for all messages of a connection but for the time, and the
length and bytes of its data are what came over the wire (TCPROS has the same framing). The files
are, byte for byte, those that ``rosbag.Bag`` writes.
"""
import struct
from typing import Dict, Iterable, List, Optional, Sequence, Tuple

VERSION_LINE = b'#ROSBAG V2.0\n'
_FILE_HEADER_LENGTH = 4096
_OP_MESSAGE, _OP_FILE_HEADER, _OP_INDEX, _OP_CHUNK, _OP_CHUNK_INFO, _OP_CONNECTION = range(2, 8)
_PACK_U32 = struct.Struct('<I').pack
_PACK_U64 = struct.Struct('<Q').pack
_PACK_TIME = struct.Struct('<II').pack
_UNPACK_U32 = struct.Struct('<I').unpack_from
_NS = 10 ** 9


def _header(fields: Iterable[Tuple[bytes, bytes]]) -> bytes:
    """Return a record header: pairs of a name and a value, both bytes."""
    text = b''.join(_PACK_U32(len(key) + 1 + len(value)) + key + b'=' + value
                    for key, value in fields)
    return _PACK_U32(len(text)) + text


def _record(op: int, fields: List[Tuple[bytes, bytes]], data: bytes) -> bytes:
    header = _header([(b'op', bytes([op]))] + fields)
    return header + _PACK_U32(len(data)) + data


def _time_bytes(time_ns: int) -> bytes:
    return _PACK_TIME(*divmod(time_ns, _NS))


def file_header(index_pos: int = 0, connections: int = 0, chunks: int = 0) -> bytes:
    """Return the first record, of fixed length; zeros while the file has no index yet."""
    header = _header([(b'op', bytes([_OP_FILE_HEADER])), (b'index_pos', _PACK_U64(index_pos)),
                      (b'conn_count', _PACK_U32(connections)),
                      (b'chunk_count', _PACK_U32(chunks))])
    # Counted without the length in front, as the library does: it writes over this record in place.
    padding = _FILE_HEADER_LENGTH - (len(header) - 4)
    return header + _PACK_U32(padding) + b' ' * padding


class Connection:
    """One publisher of one topic.

    :param fields: {name: text} as the publisher introduced itself; ``topic``, ``type``, ``md5sum``
        and ``message_definition`` must be among them
    """

    def __init__(self, number: int, fields: Dict[str, str]) -> None:
        self.number = number
        encoded = [(key.encode(), value.encode()) for key, value in fields.items()]
        data = _header(encoded)
        self.record = _header([(b'op', bytes([_OP_CONNECTION])),
                               (b'topic', fields['topic'].encode()),
                               (b'conn', _PACK_U32(number))]) + data
        # All of a message record up to the value of its time, which is the last field.
        message = _header([(b'op', bytes([_OP_MESSAGE])), (b'conn', _PACK_U32(number)),
                           (b'time', bytes(8))])
        self.message_head = message[:-8]


class Chunk:
    """Messages on their way to the file, at least one.

    ``size`` is that of its records [bytes]; ``messages`` their number.
    """

    def __init__(self) -> None:
        self.size = 0
        self.messages = 0
        self._parts: List[bytes] = []
        self._index: Dict[int, List[bytes]] = {}
        self._last_ns: Optional[int] = None
        self._least_ns = self._greatest_ns = 0
        self._ordered = True

    def introduce(self, connection: Connection) -> None:
        """Add the record of a connection, before the first message that it brings to the file."""
        self._parts.append(connection.record)
        self.size += len(connection.record)

    def add(self, connection: Connection, time_ns: int, frame: bytes) -> None:
        """Add one message.

        :param time_ns: the receipt time [ns since 1970], > 0
        :param frame: length (4 bytes, little endian) and bytes of the serialised message
        """
        if time_ns != self._last_ns:
            self._new_time(time_ns)
        time_bytes = self._time_bytes
        entries = self._index.get(connection.number)
        if entries is None:
            entries = self._index[connection.number] = []
        entries.append(time_bytes)
        entries.append(_PACK_U32(self.size))
        self._parts += (connection.message_head, time_bytes, frame)
        self.size += len(connection.message_head) + 8 + len(frame)
        self.messages += 1

    def _new_time(self, time_ns: int) -> None:
        if self._last_ns is None:
            self._least_ns = self._greatest_ns = time_ns
        elif time_ns < self._last_ns:
            self._ordered = False
            self._least_ns = min(self._least_ns, time_ns)
        self._greatest_ns = max(self._greatest_ns, time_ns)
        self._last_ns = time_ns
        self._time_bytes = _time_bytes(time_ns)

    def finish(self, position: int) -> Tuple[bytes, bytes]:
        """Return (its bytes with its index, its entry in the index of the file).

        :param position: where in the file it will stand [bytes]
        """
        size = _PACK_U32(self.size)
        parts = [_header([(b'op', bytes([_OP_CHUNK])), (b'compression', b'none'),
                          (b'size', size)]), size] + self._parts
        for number, entries in self._index.items():
            if not self._ordered:
                entries = _sorted_entries(entries)
            parts.append(_record(_OP_INDEX, [
                (b'conn', _PACK_U32(number)), (b'ver', _PACK_U32(1)),
                (b'count', _PACK_U32(len(entries) // 2))], b''.join(entries)))
        counts = b''.join(_PACK_U32(number) + _PACK_U32(len(entries) // 2)
                          for number, entries in self._index.items())
        info = _record(_OP_CHUNK_INFO, [
            (b'ver', _PACK_U32(1)), (b'chunk_pos', _PACK_U64(position)),
            (b'start_time', _time_bytes(self._least_ns)),
            (b'end_time', _time_bytes(self._greatest_ns)),
            (b'count', _PACK_U32(len(self._index)))], counts)
        return b''.join(parts), info


def _sorted_entries(entries: List[bytes]) -> List[bytes]:
    """Return index entries by time: a simulated clock may run backwards, readers search by time."""
    pairs = sorted(zip(entries[::2], entries[1::2]),
                   key=lambda pair: struct.unpack('<II', pair[0]))
    return [item for pair in pairs for item in pair]


class FrameSplitter:
    """Cuts the bytes of one TCPROS connection into frames: a length (4 bytes) and a message.

    ``wanted`` is how many bytes are still missing of the present message, 0 where unknown.
    """

    LONGEST = 10 ** 9

    def __init__(self) -> None:
        self.wanted = 0
        self._parts: List[bytes] = []

    def split(self, data: bytes) -> Sequence[bytes]:
        """Return the frames that are whole with these bytes.

        :raises ValueError: a length that no message has (the limit of roscpp, 1 GB)
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
            if size > self.LONGEST:
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
