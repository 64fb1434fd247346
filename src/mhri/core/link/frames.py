# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What goes over the air: a head before each message, the beats, and what a robot says of itself.

The head is ``mh``, the version, the session of the sender (another one at each start), the number
of the message in its stream, and the sender's clock [s]. Whatever comes may be anybody's bytes:
what cannot be read raises :class:`FrameError`.
"""
from collections import deque
from dataclasses import dataclass
import json
import math
import struct
from typing import Any, Deque, Dict, List, Mapping, Optional, Tuple
import zlib

from mhri.core.link.carried import valid_topic, valid_type

VERSION = 1
_HEAD = struct.Struct('>2sBIId')
_MAGIC = b'mh'
MOST_TOPICS = 100
MOST_BYTES = 65536
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


def pack(session: int, number: int, stamp_s: float, body: bytes) -> bytes:
    """Return the bytes of a :class:`Frame`; the number begins again after 2^32."""
    return _HEAD.pack(_MAGIC, VERSION, session, number & 0xffffffff, stamp_s) + body


def unpack(data: bytes) -> Frame:
    """Return the :class:`Frame` of bytes.

    :raises FrameError: they are none, or of another version
    """
    if len(data) < _HEAD.size or data[:2] != _MAGIC:
        raise FrameError('no message of mhri_link')
    _, version, session, number, stamp_s = _HEAD.unpack_from(data)
    if version != VERSION:
        raise FrameError('the other side speaks version {} of mhri_link, this one {}: install the '
                         'same mhri on both'.format(version, VERSION))
    if not math.isfinite(stamp_s):
        raise FrameError('a stamp that is no number')
    return Frame(session, number, stamp_s, data[_HEAD.size:])


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
class Beat:
    """What each side says five times a second.

    :param echo: (stamp of the other side's newest beat [s of its clock], how long ago that came
        [s]), None before the first
    :param about: which :class:`About` the sender has, or is of; '' for none
    :param wanted: of its topics those that somebody on the host listens to, by their place
    """

    echo: Optional[Tuple[float, float]] = None
    about: str = ''
    wanted: Tuple[int, ...] = ()


def pack_beat(beat: Beat) -> bytes:
    """Return the bytes of a beat."""
    return json.dumps([beat.echo, beat.about, beat.wanted], separators=(',', ':')).encode('ascii')


def unpack_beat(body: bytes) -> Beat:
    """Return the :class:`Beat` of bytes.

    :raises FrameError: they are none
    """
    found = read_rows(body)
    if len(found) != 3 or not isinstance(found[1], str) or not isinstance(found[2], list):
        raise FrameError('no beat')
    echo, about, wanted = found
    if echo is not None:
        if not isinstance(echo, list) or len(echo) != 2 or not all(map(_number, echo)):
            raise FrameError('a beat with a wrong echo')
        echo = (float(echo[0]), float(echo[1]))
    if len(wanted) > MOST_TOPICS or not all(type(place) is int for place in wanted):
        raise FrameError('a beat with wrong topics')
    return Beat(echo, about[:40], tuple(wanted))


@dataclass(frozen=True)
class About:
    """What a robot says of itself: its parameters, and its topics with their ROS types."""

    parameters: Mapping[str, object]
    topics: Tuple[Tuple[str, str], ...]

    @property
    def name(self) -> str:
        """Tell it apart from others."""
        return '{:08x}'.format(zlib.crc32(pack_about(self)))


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
    for row in found[1][:MOST_TOPICS]:
        if not (isinstance(row, list) and len(row) == 2 and valid_topic(row[0])
                and valid_type(row[1])):
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


def _number(value: object) -> bool:
    return type(value) in (int, float) and math.isfinite(float(str(value)))
