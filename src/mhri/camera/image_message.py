# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the fields of a camera's serialised message.

``sensor_msgs/CompressedImage`` is (header, string format, uint8[] data), ``sensor_msgs/Image`` is
(header, height, width, string encoding, is_bigendian, step, uint8[] data).
"""
from typing import NamedTuple, Tuple

from mhri.base.wire import Data, Wire
from mhri.camera.images import FrameError

COMPRESSED_TYPE = 'sensor_msgs/CompressedImage'
RAW_TYPE = 'sensor_msgs/Image'


class RawImage(NamedTuple):
    """The fields of a ``sensor_msgs/Image`` except its header; ``data`` is not a copy."""

    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    data: Data


def read_compressed(data: Data) -> Tuple[str, memoryview]:
    """Return (format, data) of a serialised ``sensor_msgs/CompressedImage``.

    :raises FrameError: it is truncated
    """
    wire = Wire(COMPRESSED_TYPE, data, FrameError)
    wire.header()
    wire.text()
    return wire.text(), wire.array()


def has_content(kind: str, data: Data) -> bool:
    """Return whether a message of a type has content: a compressed picture may be empty."""
    try:
        return kind != COMPRESSED_TYPE or len(read_compressed(data)[1]) > 0
    except FrameError:
        return False


def read_raw(data: Data) -> RawImage:
    """Return the :class:`RawImage` of a serialised ``sensor_msgs/Image``.

    :raises FrameError: it is truncated
    """
    wire = Wire(RAW_TYPE, data, FrameError)
    wire.header()
    wire.text()
    height, width = wire.numbers('<II')
    encoding = wire.text()
    is_bigendian, step = wire.numbers('<BI')
    return RawImage(height, width, encoding, is_bigendian, step, wire.array())
