# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera's message, as it came over the wire, turned into a :class:`Frame`.

The wire is ROS's: little-endian; ``sensor_msgs/CompressedImage`` is (header, string format, uint8[]
data), ``sensor_msgs/Image`` is (header, height, width, string encoding, is_bigendian, step, uint8[]
data), the header (seq, stamp, string frame_id). It is read in place: no picture is copied.
"""
import struct
from typing import Any, Optional, Tuple, Type

import numpy as np

from mhri.camera.depth_codec import decode_depth
from mhri.camera.depth_colour import DepthColour
from mhri.camera.image_codec import decode_compressed
from mhri.camera.images import Data, DEPTH, Frame, FrameError, RGB, Size
from mhri.camera.raw_image import decode_raw, decode_raw_depth, RawImage

COMPRESSED_TYPE = 'sensor_msgs/CompressedImage'
RAW_TYPE = 'sensor_msgs/Image'
_LONGEST_NAME = 4096


class Wire:
    """Reads the fields of a serialised message in order.

    :param what: what the message calls itself, for the error's text
    :param error: raised if it ends early
    """

    def __init__(self, what: str, data: Data, error: Type[ValueError] = FrameError) -> None:
        self._what = what
        self._error = error
        self._data = memoryview(data)
        self._place = 0

    def numbers(self, form: str) -> Tuple[Any, ...]:
        """Return the tuple of a struct format."""
        try:
            values = struct.unpack_from(form, self._data, self._place)
        except struct.error:
            raise self._error('{}: truncated message of {} bytes'.format(
                self._what, len(self._data)))
        self._place += struct.calcsize(form)
        return values

    def array(self) -> memoryview:
        """Return a uint8[] as a view."""
        (length,) = self.numbers('<I')
        if self._place + length > len(self._data):
            raise self._error('{}: truncated, {} of {} bytes'.format(
                self._what, len(self._data) - self._place, length))
        self._place += length
        return self._data[self._place - length:self._place]

    def text(self) -> str:
        """Return a string."""
        value = self.array()
        if len(value) > _LONGEST_NAME:
            raise self._error('{}: corrupted, a name of {} bytes'.format(self._what, len(value)))
        return bytes(value).decode('utf-8', 'replace')


def read_compressed(data: Data) -> Tuple[str, memoryview]:
    """Return (format, data) of a serialised ``sensor_msgs/CompressedImage``.

    :raises FrameError: it ends early
    """
    wire = Wire(COMPRESSED_TYPE, data)
    wire.numbers('<III')
    wire.text()
    return wire.text(), wire.array()


def read_raw(data: Data) -> RawImage:
    """Return the :class:`RawImage` of a serialised ``sensor_msgs/Image``.

    :raises FrameError: it ends early
    """
    wire = Wire(RAW_TYPE, data)
    wire.numbers('<III')
    wire.text()
    height, width = wire.numbers('<II')
    encoding = wire.text()
    is_bigendian, step = wire.numbers('<BI')
    return RawImage(height, width, encoding, is_bigendian, step, wire.array())


def read_picture(kind: str, message_type: str, data: Data, view: Optional[Size],
                 colour: DepthColour, received_s: float) -> Tuple[Frame, str]:
    """Return (:class:`Frame`, transport in words) of a serialised message.

    :param kind: 'rgb' or 'depth'
    :param message_type: e.g. 'sensor_msgs/CompressedImage'
    :param view: room for the picture (width, height) [pixels], None for the full size
    :param colour: :class:`mhri.camera.depth_colour.DepthColour` of the stream
    :raises FrameError: another type, or a picture that cannot be decoded
    """
    if message_type not in (COMPRESSED_TYPE, RAW_TYPE):
        raise FrameError('{} is not a picture'.format(message_type))
    if kind == RGB:
        return _read_rgb(message_type, data, view, received_s)
    return _read_depth(message_type, data, view, colour, received_s)


def _read_rgb(message_type: str, data: Data, view: Optional[Size],
              received_s: float) -> Tuple[Frame, str]:
    if message_type == RAW_TYPE:
        rgb, full = decode_raw(read_raw(data), view)
        transport = 'raw'
    else:
        rgb, full, transport = decode_compressed(*read_compressed(data), view)
    return Frame(RGB, rgb, None, full, None, received_s), transport


def read_depth(message_type: str, data: Data,
               view: Optional[Size] = None) -> Tuple[np.ndarray, Size, str]:
    """Return (depth float32 (h, w) [m], NaN invalid; size as sent; transport) of a message.

    :raises FrameError: another type, or a picture that cannot be decoded
    """
    if message_type == COMPRESSED_TYPE:
        return decode_depth(*read_compressed(data), view)
    if message_type != RAW_TYPE:
        raise FrameError('{} is not a picture'.format(message_type))
    return (*decode_raw_depth(read_raw(data), view), 'raw')


def _read_depth(message_type: str, data: Data, view: Optional[Size], colour: DepthColour,
                received_s: float) -> Tuple[Frame, str]:
    depth, full, transport = read_depth(message_type, data, view)
    rgb, depth_range = colour.colour(depth, received_s)
    return Frame(DEPTH, rgb, depth, full, depth_range, received_s), transport
