# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Puts a robot's name before its frames, in the bytes of messages: nothing is decoded.

On its own master a robot calls its frames ``odom`` and ``base_link``; beside others they are
``bot1/odom`` and ``bot1/base_link``. Bytes are as ROS writes them (http://wiki.ros.org/msg).
"""
import struct
from typing import Callable, Collection, Dict, Iterator, Optional, Tuple

from mhri.link.carried import SHARED_FRAMES

_LENGTH = struct.Struct('<I')
_STAMP = struct.Struct('<II')
# Number and stamp of a header.
_BEFORE_FRAME = 12
# Translation and rotation of a transform.
_TRANSFORM = 56
_MOST_TRANSFORMS = 10000
Rename = Callable[[bytes], bytes]


def renamer(robot: str, shared: Tuple[str, ...] = SHARED_FRAMES) -> Rename:
    """Return a function from a frame to its name on the host.

    :param shared: frames that are everybody's
    """
    prefix = robot.encode('ascii') + b'/'
    kept = frozenset(name.encode('utf-8') for name in shared) | {b''}

    def rename(frame: bytes) -> bytes:
        """Return the name of a frame on the host."""
        frame = frame.lstrip(b'/')
        return frame if frame in kept or frame.startswith(prefix) else prefix + frame
    return rename


def _text(data: bytes, at: int) -> Tuple[bytes, int]:
    """Return (text, where what follows it begins).

    :raises ValueError: the bytes end before it does
    """
    if at + 4 > len(data):
        raise ValueError('a message that ends too early')
    begin = at + 4
    end = begin + int(_LENGTH.unpack_from(data, at)[0])
    if end > len(data):
        raise ValueError('a message that ends too early')
    return data[begin:end], end


def first_text(data: bytes) -> str:
    """Return the frame_id of a message with a header.

    :raises ValueError: it has none
    """
    return _text(data, _BEFORE_FRAME)[0].decode('utf-8')


def after_texts(data: bytes, count: int) -> int:
    """Return where that begins which follows its number, stamp and so many texts.

    :raises ValueError: it ends before
    """
    at = _BEFORE_FRAME
    for _ in range(count):
        _, at = _text(data, at)
    return at


def stamp_of(data: bytes) -> float:
    """Return the stamp of a message with a header [s].

    :raises ValueError: it has none
    """
    if len(data) < _BEFORE_FRAME:
        raise ValueError('a message that ends too early')
    seconds, nanoseconds = _STAMP.unpack_from(data, 4)
    return float(seconds + 1e-9 * nanoseconds)


def rewritten(data: bytes, number: int, names: int, rename: Rename) -> bytes:
    """Return a message with its number and the frame names that it begins with replaced.

    The number counts what is sent: who counts gaps sees what the radio lost, not what was left out.

    :param names: how many, see :data:`mhri.link.carried.FRAME_NAMES`; 0 for no header
    :raises ValueError: it is not such a message
    """
    if not names:
        return data
    parts = [_LENGTH.pack(number & 0xffffffff), data[4:_BEFORE_FRAME]]
    at = _BEFORE_FRAME
    for _ in range(names):
        frame, at = _text(data, at)
        frame = rename(frame)
        parts += [_LENGTH.pack(len(frame)), frame]
    head = b''.join(parts)
    # Most pictures that come have their names already: no copy of those.
    return data if head == data[:at] else head + data[at:]


def transforms(data: bytes, rename: Rename) -> Iterator[Tuple[bytes, bytes]]:
    """Yield (child frame, bytes) of each transform of a tf message, with new names.

    :raises ValueError: it is not such a message
    """
    if len(data) < 4:
        raise ValueError('a message that ends too early')
    count = _LENGTH.unpack_from(data)[0]
    if count > _MOST_TRANSFORMS:
        raise ValueError('too many transforms')
    at = 4
    for _ in range(count):
        head = data[at:at + _BEFORE_FRAME]
        frame, at = _text(data, at + _BEFORE_FRAME)
        child, at = _text(data, at)
        frame, child = rename(frame), rename(child)
        if at + _TRANSFORM > len(data):
            raise ValueError('a message that ends too early')
        yield child, b''.join((head, _LENGTH.pack(len(frame)), frame, _LENGTH.pack(len(child)),
                               child, data[at:at + _TRANSFORM]))
        at += _TRANSFORM


def packed_transforms(rows: Collection[bytes]) -> bytes:
    """Return the tf message of what :func:`transforms` yields."""
    return _LENGTH.pack(len(rows)) + b''.join(rows)


class Transforms:
    """The newest transform of each frame, since several nodes speak on ``/tf``.

    :param keep: what was taken stays for the next time (``/tf_static``)
    """

    def __init__(self, rename: Rename, keep: bool) -> None:
        self._rename = rename
        self._keep = keep
        self._newest: Dict[bytes, bytes] = {}

    def add(self, data: bytes) -> None:
        """Take in a tf message.

        :raises ValueError: it is not one; then nothing of it counts
        """
        self._newest.update(dict(transforms(data, self._rename)))

    def take(self) -> Optional[bytes]:
        """Return a tf message of what is there, None if there is nothing."""
        if not self._newest:
            return None
        data = packed_transforms(self._newest.values())
        if not self._keep:
            self._newest = {}
        return data
