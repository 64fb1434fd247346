# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What goes over the air: a head before each message, the beats, and what a robot says of itself.

The head is ``mh``, the version, how the body is packed, the session of the sender (another one at
each start), the number of the message in its stream, and the sender's clock [s]. Whatever comes may
be anybody's bytes: what cannot be read raises :class:`FrameError`.
"""
from collections import deque
from dataclasses import dataclass
import json
import math
import struct
from typing import Any, Deque, Dict, List, Mapping, Optional, Tuple
import zlib

from mhri.link.robot_claims import MAX_STATE_BYTES, MAX_TOPICS

VERSION = 4
_HEAD = struct.Struct('>2sBBIId')
_MAGIC = b'mh'
MOST_BYTES = 65536
# How a body is packed: as it is, by zlib, or as a piece of a picture (pieces.py).
PLAIN, DEFLATED, PIECE = 0, 1, 2
# Of replaced sessions so many are known, so that their late messages count for nothing.
_RETIRED = 16


class FrameError(ValueError):
    """Bytes that are no message of this link; the text says why."""


@dataclass(frozen=True)
class Frame:
    """A message with its head; ``stamp_s`` is the sender's clock [s]."""

    session: int
    number: int
    stamp_s: float
    body: bytes
    kind: int = PLAIN


def pack(session: int, number: int, stamp_s: float, body: bytes, kind: int = PLAIN) -> bytes:
    """Return the bytes of a :class:`Frame`; the number begins again after 2^32.

    :param kind: how the body is packed; with :data:`DEFLATED` it is packed here
    """
    if kind == DEFLATED:
        body = zlib.compress(body, 1)
    return _HEAD.pack(_MAGIC, VERSION, kind, session, number & 0xffffffff, stamp_s) + body


def unpack(data: bytes) -> Frame:
    """Return the :class:`Frame` of bytes.

    :raises FrameError: they are none, or of another version
    """
    if len(data) < _HEAD.size or data[:2] != _MAGIC:
        raise FrameError('no message of mhri_link')
    _, version, kind, session, number, stamp_s = _HEAD.unpack_from(data)
    if version != VERSION:
        raise FrameError('the other side speaks version {} of mhri_link, this one {}: install the '
                         'same mhri on both'.format(version, VERSION))
    if not math.isfinite(stamp_s):
        raise FrameError('a stamp that is no number')
    body = data[_HEAD.size:]
    if kind == DEFLATED:
        return Frame(session, number, stamp_s, _inflated(body))
    if kind not in (PLAIN, PIECE):
        raise FrameError('a body that is packed in an unknown way')
    return Frame(session, number, stamp_s, body, kind)


def _inflated(body: bytes) -> bytes:
    inflater = zlib.decompressobj()
    try:
        found = inflater.decompress(body, MAX_STATE_BYTES)
    except zlib.error:
        raise FrameError('a body that cannot be unpacked') from None
    if not inflater.eof:
        raise FrameError('a body that is cut off, or too large')
    return found


class Newest:
    """Lets through what is newer than everything before it, and no session that was replaced."""

    def __init__(self) -> None:
        self._session: Optional[int] = None
        self._number = -1
        self._retired: Deque[int] = deque(maxlen=_RETIRED)

    def takes(self, frame: Frame) -> bool:
        """Tell whether a message counts, and remember that it came."""
        if frame.session == self._session:
            if frame.number <= self._number:
                return False
        elif frame.session in self._retired:
            return False
        else:
            if self._session is not None:
                self._retired.append(self._session)
            self._session = frame.session
        self._number = frame.number
        return True


@dataclass(frozen=True)
class Heard:
    """What came lately from the other side.

    :param bytes_per_s: all of it
    :param queue_s: how much longer it took than the quickest of the last while, the median [s]
    :param loss: the share of the messages that did not come, from 0 to 1
    """

    bytes_per_s: float
    queue_s: float
    loss: float


@dataclass(frozen=True)
class Thinned:
    """What a robot's side sends less of, since the radio does not bear all; zeros for nothing.

    :param bytes_per_s: what the radio bears
    :param picture_hz: how often a picture goes
    :param looked_at: whether any is asked for
    """

    bytes_per_s: float = 0.0
    picture_hz: float = 0.0
    looked_at: bool = False


@dataclass(frozen=True)
class Beat:
    """What each side says five times a second.

    :param echo: (stamp of the other side's newest beat [s of its clock], how long ago that came
        [s]), None before the first
    :param about: which :class:`About` the sender has, or is of; '' for none
    :param wanted: of its topics those that somebody on the host listens to, by their place
    :param heard: what came from the other side, None of nothing
    :param thinned: what the sender sends less of
    """

    echo: Optional[Tuple[float, float]] = None
    about: str = ''
    wanted: Tuple[int, ...] = ()
    heard: Optional[Heard] = None
    thinned: Thinned = Thinned()


def pack_beat(beat: Beat) -> bytes:
    """Return the bytes of a beat."""
    heard, thinned = beat.heard, beat.thinned
    return json.dumps(
        [beat.echo, beat.about, beat.wanted,
         heard and [round(heard.bytes_per_s), round(heard.queue_s, 4), round(heard.loss, 4)],
         [round(thinned.bytes_per_s), round(thinned.picture_hz, 2),
          int(thinned.looked_at)]],
        separators=(',', ':')).encode('ascii')


def unpack_beat(body: bytes) -> Beat:
    """Return the :class:`Beat` of bytes.

    :raises FrameError: they are none
    """
    found = read_rows(body)
    if len(found) != 5 or not isinstance(found[1], str) or not isinstance(found[2], list):
        raise FrameError('no beat')
    echo, about, wanted, heard, thinned = found
    echo = None if echo is None else _numbers(echo, 2)
    if len(wanted) > MAX_TOPICS or not all(type(place) is int for place in wanted):
        raise FrameError('a beat with wrong topics')
    return Beat(echo and (echo[0], echo[1]), about[:40], tuple(wanted),
                None if heard is None else Heard(*_numbers(heard, 3)),
                _thinned(*_numbers(thinned, 3)))


@dataclass(frozen=True)
class About:
    """What a robot says of itself: its parameters, and its topics with their ROS types.

    How much of it is believed is in :mod:`mhri.link.robot_claims`.
    """

    parameters: Mapping[str, object]
    topics: Tuple[Tuple[str, str], ...]

    @property
    def name(self) -> str:
        """Tell it apart from others."""
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
        raise FrameError('no description of a robot')
    topics: List[Tuple[str, str]] = []
    for row in found[1][:MAX_TOPICS]:
        if not (isinstance(row, list) and [type(word) for word in row] == [str, str]):
            raise FrameError('a robot with a topic that none can have')
        topics.append((row[0], row[1]))
    parameters: Dict[str, object] = found[0]
    return About(parameters, tuple(topics))


def read_rows(body: bytes) -> List[Any]:
    """Return the list that bytes say, as JSON.

    :raises FrameError: they say none
    """
    if len(body) > MOST_BYTES:
        raise FrameError('too long')
    try:
        found = json.loads(body.decode('ascii'))
    except (ValueError, RecursionError):
        raise FrameError('cannot be read') from None
    if not isinstance(found, list):
        raise FrameError('cannot be read')
    return found


def _numbers(value: object, count: int) -> List[float]:
    """Return a list of so many numbers."""
    if not isinstance(value, list) or len(value) != count or not all(map(_number, value)):
        raise FrameError('a beat with wrong numbers')
    return [float(part) for part in value]


def _number(value: object) -> bool:
    return type(value) in (int, float) and math.isfinite(float(str(value)))
