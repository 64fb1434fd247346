# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prefixes a robot's frames with its name, in serialized messages, without decoding them.

On its own master a robot's frames are ``odom`` and ``base_link``; among other robots they are
``bot1/odom`` and ``bot1/base_link``. Messages are in the ROS wire format
(http://wiki.ros.org/msg).
"""
import struct
from typing import Callable, Collection, Dict, Iterator, Optional, Tuple

from mhri.base.wire import Wire
from mhri.link.carried import SHARED_FRAMES

_LENGTH = struct.Struct('<I')
_MAX_TRANSFORMS = 10000
Rename = Callable[[bytes], bytes]


def renamer(robot: str, shared: Tuple[str, ...] = SHARED_FRAMES) -> Rename:
    """Return a function from a frame to its name on the host.

    :param shared: frames shared by all robots
    """
    prefix = robot.encode('ascii') + b'/'
    kept = frozenset(name.encode('utf-8') for name in shared) | {b''}

    def rename(frame: bytes) -> bytes:
        """Return the name of a frame on the host."""
        frame = frame.lstrip(b'/')
        return frame if frame in kept or frame.startswith(prefix) else prefix + frame
    return rename


def first_text(data: bytes) -> str:
    """Return the frame_id of a message with a header.

    :raises ValueError: it has no header
    """
    wire = Wire('message', data)
    wire.header()
    return bytes(wire.array()).decode('utf-8')


def rewritten(data: bytes, number: int, names: int, rename: Rename) -> bytes:
    """Return a message with its number and leading frame names replaced.

    The number counts sent messages, so that gaps indicate loss on the radio, not skipped messages.

    :param names: number of frame names, see :data:`mhri.link.carried.FRAME_NAMES`; 0: no header
    :raises ValueError: it is malformed
    """
    if not names:
        return data
    wire = Wire('message', data)
    wire.header()
    parts = [_LENGTH.pack(number & 0xffffffff), data[4:wire.at]]
    for _ in range(names):
        parts += _sized(rename(bytes(wire.array())))
    head = b''.join(parts)
    # Avoid a copy: most received pictures already have their final names.
    return data if head == data[:wire.at] else head + data[wire.at:]


def _sized(name: bytes) -> Tuple[bytes, bytes]:
    return _LENGTH.pack(len(name)), name


def transforms(data: bytes, rename: Rename) -> Iterator[Tuple[bytes, bytes]]:
    """Yield (child frame, bytes) of each transform of a tf message, with new names.

    :raises ValueError: it is malformed
    """
    wire = Wire('tf', data)
    count, = wire.numbers('<I')
    if count > _MAX_TRANSFORMS:
        raise ValueError('too many transforms')
    for _ in range(count):
        begin = wire.at
        wire.header()
        head = data[begin:wire.at]
        frame, child = rename(bytes(wire.array())), rename(bytes(wire.array()))
        begin = wire.at
        wire.numbers('<7d')
        yield child, b''.join((head, *_sized(frame), *_sized(child), data[begin:wire.at]))


def packed_transforms(rows: Collection[bytes]) -> bytes:
    """Return the tf message of the rows of :func:`transforms`."""
    return _LENGTH.pack(len(rows)) + b''.join(rows)


class Transforms:
    """The newest transform of each frame, since several nodes publish ``/tf``.

    :param keep: whether transforms remain after :meth:`take` (``/tf_static``)
    """

    def __init__(self, rename: Rename, keep: bool) -> None:
        self._rename = rename
        self._keep = keep
        self._newest: Dict[bytes, bytes] = {}

    def add(self, data: bytes) -> None:
        """Handle a tf message.

        :raises ValueError: the message is malformed, and is ignored as a whole
        """
        self._newest.update(dict(transforms(data, self._rename)))

    def take(self) -> Optional[bytes]:
        """Return a tf message of the stored transforms, None without any."""
        if not self._newest:
            return None
        data = packed_transforms(self._newest.values())
        if not self._keep:
            self._newest = {}
        return data
