# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The wire format: the header of each message, the beats, and a robot's description of itself.

The header is ``mh``, the version, the packing of the body, the session of the sender (new at each
start), the number of the message in its stream, and the sender's clock [s]. Received bytes are not
trusted: malformed ones raise :class:`FrameError`.
"""
from dataclasses import dataclass
import json
import math
import struct
from typing import Any, Dict, List, Mapping, Optional, Tuple
import zlib

from mhri.link.robot_claims import MAX_STATE_BYTES, MAX_TOPICS

VERSION = 5
_HEAD = struct.Struct('>2sBBIId')
_MAGIC = b'mh'
MAX_BYTES = 65536
# Packing of a body: none, zlib, or a piece of a picture (pieces.py).
PLAIN, DEFLATED, PIECE = 0, 1, 2


class FrameError(ValueError):
    """Bytes that are not a valid message of this link; the text names the reason."""


@dataclass(frozen=True)
class Frame:
    """A message with its header; ``stamp_s`` is the sender's clock [s]."""

    session: int
    number: int
    stamp_s: float
    body: bytes
    kind: int = PLAIN


def pack(session: int, number: int, stamp_s: float, body: bytes, kind: int = PLAIN) -> bytes:
    """Return the bytes of a :class:`Frame`; the number wraps around at 2^32.

    :param kind: packing of the body; :data:`DEFLATED` compresses it here
    """
    if kind == DEFLATED:
        body = zlib.compress(body, 1)
    return _HEAD.pack(_MAGIC, VERSION, kind, session, number & 0xffffffff, stamp_s) + body


def unpack(data: bytes) -> Frame:
    """Return the :class:`Frame` of bytes.

    :raises FrameError: the bytes are malformed, or of another version
    """
    if len(data) < _HEAD.size or data[:2] != _MAGIC:
        raise FrameError('not a message of mhri_link')
    _, version, kind, session, number, stamp_s = _HEAD.unpack_from(data)
    if version != VERSION:
        raise FrameError('the other side speaks version {} of mhri_link, this one {}: install the '
                         'same mhri on both'.format(version, VERSION))
    if not math.isfinite(stamp_s):
        raise FrameError('the stamp is not a number')
    body = data[_HEAD.size:]
    if kind == DEFLATED:
        return Frame(session, number, stamp_s, _inflated(body))
    if kind not in (PLAIN, PIECE):
        raise FrameError('unknown packing of the body')
    return Frame(session, number, stamp_s, body, kind)


def _inflated(body: bytes) -> bytes:
    inflater = zlib.decompressobj()
    try:
        found = inflater.decompress(body, MAX_STATE_BYTES)
    except zlib.error:
        raise FrameError('the body cannot be decompressed') from None
    if not inflater.eof:
        raise FrameError('the body is truncated or too large')
    return found


@dataclass(frozen=True)
class LinkStats:
    """Statistics of the recent messages from the other side.

    :param bytes_per_s: total rate
    :param queue_s: median delay beyond that of the fastest recent message [s]
    :param loss: fraction of the messages that were lost, from 0 to 1
    """

    bytes_per_s: float
    queue_s: float
    loss: float


@dataclass(frozen=True)
class Thinned:
    """The reductions by the robot side if the radio cannot carry everything; zeros without any.

    :param bytes_per_s: rate that the radio carries
    :param picture_hz: rate of the pictures
    :param looked_at: whether pictures have subscribers
    """

    bytes_per_s: float = 0.0
    picture_hz: float = 0.0
    looked_at: bool = False


@dataclass(frozen=True)
class Beat:
    """The message that each side sends five times a second.

    :param to: session of the other side that the sender is linked with, None before the first: one
        that is not addressed is not linked, because another program has its name
    :param echo: (stamp of the other side's newest beat [s of its clock], time since its arrival
        [s]), None before the first
    :param about: name of the :class:`About` that the sender has or describes, '' without one
    :param requested: indices of the topics that have subscribers on the host
    :param stats: statistics of the other side's messages at the sender, None without any
    :param thinned: reductions by the sender
    """

    echo: Optional[Tuple[float, float]] = None
    about: str = ''
    requested: Tuple[int, ...] = ()
    stats: Optional[LinkStats] = None
    thinned: Thinned = Thinned()
    to: Optional[int] = None


def pack_beat(beat: Beat) -> bytes:
    """Return the bytes of a beat."""
    stats, thinned = beat.stats, beat.thinned
    return json.dumps(
        [beat.echo, beat.about, beat.requested,
         stats and [round(stats.bytes_per_s), round(stats.queue_s, 4), round(stats.loss, 4)],
         [round(thinned.bytes_per_s), round(thinned.picture_hz, 2),
          int(thinned.looked_at)], beat.to],
        separators=(',', ':')).encode('ascii')


def unpack_beat(body: bytes) -> Beat:
    """Return the :class:`Beat` of bytes.

    :raises FrameError: they are none
    """
    found = read_rows(body)
    if len(found) != 6 or not isinstance(found[1], str) or not isinstance(found[2], list):
        raise FrameError('not a beat')
    echo, about, requested, stats, thinned, to = found
    echo = None if echo is None else _numbers(echo, 2)
    if len(requested) > MAX_TOPICS or not all(type(place) is int for place in requested):
        raise FrameError('a beat with invalid topics')
    if not (to is None or type(to) is int):
        raise FrameError('a beat to an invalid session')
    return Beat(echo and (echo[0], echo[1]), about[:40], tuple(requested),
                None if stats is None else LinkStats(*_numbers(stats, 3)),
                _thinned(*_numbers(thinned, 3)), to)


@dataclass(frozen=True)
class About:
    """A robot's description of itself: its parameters, and its topics with their ROS types.

    :mod:`mhri.link.robot_claims` decides how much of it is accepted.
    """

    parameters: Mapping[str, object]
    topics: Tuple[Tuple[str, str], ...]

    @property
    def name(self) -> str:
        """The name that identifies this description."""
        return '{:08x}'.format(zlib.crc32(pack_about(self)))


def _thinned(bytes_per_s: float, picture_hz: float, looked_at: float) -> Thinned:
    return Thinned(bytes_per_s, picture_hz, bool(looked_at))


def pack_about(about: About) -> bytes:
    """Return the bytes of an :class:`About`."""
    return json.dumps([about.parameters, about.topics], sort_keys=True,
                      default=str).encode('ascii')


def unpack_about(body: bytes) -> About:
    """Return the :class:`About` of bytes.

    :raises FrameError: they are none
    """
    found = read_rows(body)
    if len(found) != 2 or not isinstance(found[0], dict) or not isinstance(found[1], list):
        raise FrameError('not a description of a robot')
    topics: List[Tuple[str, str]] = []
    for row in found[1][:MAX_TOPICS]:
        if not (isinstance(row, list) and [type(word) for word in row] == [str, str]):
            raise FrameError('an invalid topic')
        topics.append((row[0], row[1]))
    parameters: Dict[str, object] = found[0]
    return About(parameters, tuple(topics))


def read_rows(body: bytes) -> List[Any]:
    """Return the JSON list of bytes.

    :raises FrameError: the bytes are malformed
    """
    if len(body) > MAX_BYTES:
        raise FrameError('too long')
    try:
        found = json.loads(body.decode('ascii'))
    except (ValueError, RecursionError):
        raise FrameError('cannot be read') from None
    if not isinstance(found, list):
        raise FrameError('cannot be read')
    return found


def _numbers(value: object, count: int) -> List[float]:
    """Return a list of ``count`` numbers."""
    if not isinstance(value, list) or len(value) != count or not all(map(_number, value)):
        raise FrameError('a beat with invalid numbers')
    return [float(part) for part in value]


def _number(value: object) -> bool:
    return type(value) in (int, float) and math.isfinite(float(str(value)))
