# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Decodes compressed colour pictures (jpeg, png) to RGB at the displayed size.

The formats are those of image_transport's ``compressed`` plugin: 'jpeg' or 'png' alone, as some
cameras write it, or '<encoding>; jpeg compressed [bgr8]'. The first bytes of the data identify the
codec; the format is only used to detect a Bayer mosaic, and an unusual order of a png's colours.
"""
import struct
from typing import Optional, Tuple

import numpy as np

from mhri.base.opencv import cv2
from mhri.base.wire import Data
from mhri.camera.image_message import RawImage
from mhri.camera.images import check_size, fit, FrameError, Size
from mhri.camera.jpeg import decode_jpeg

_PNG = b'\x89PNG\r\n\x1a\n'
# Offset of its number of bits per sample, before its kind of pixels, and the colour bit of that.
_PNG_DEPTH, _PNG_COLOURS = 24, 2
_JPEG, _JPEG_END = b'\xff\xd8\xff', b'\xff\xd9'
_REDUCED = {1: cv2.IMREAD_COLOR, 2: cv2.IMREAD_REDUCED_COLOR_2, 4: cv2.IMREAD_REDUCED_COLOR_4,
            8: cv2.IMREAD_REDUCED_COLOR_8}
# Markers without a length, and those of a frame header: SOF0..15 without DHT, JPG and DAC.
_BARE = frozenset([0x01, *range(0xd0, 0xd8)])
_FRAME = frozenset(range(0xc0, 0xd0)) - {0xc4, 0xc8, 0xcc}


def decode_compressed(fmt: str, data: Data,
                      view: Optional[Size] = None) -> Tuple[np.ndarray, Size, str]:
    """Decode the data of a ``sensor_msgs/CompressedImage``.

    A jpeg has no checksum: damage in its middle shows as a smear and is not an error; a truncated
    picture is, but not one that lacks only its end marker, as some cameras send it.

    :param fmt: its ``format``
    :param data: its ``data``, bytes-like
    :param view: room for the picture (width, height) [pixels], None for the full size
    :returns: (RGB (h, w, 3), uint8 or, in a png of 16 bits, uint16, or its grey (h, w);
        (width, height) as sent; 'jpeg' or 'png')
    :raises FrameError: not a jpeg or png, truncated, corrupted, or of an absurd size
    """
    kind, full = read_size(data, fmt)
    target = fit(full, view)
    rgb = _decode_colours(fmt, kind, data, full, _factor(full, target) if kind == 'jpeg' else 1)
    return reduced(rgb, target), full, kind


def read_mosaic(fmt: str, data: Data) -> Optional[RawImage]:
    """Return the Bayer mosaic of a compressed picture as a raw picture; None if it is not one.

    image_transport's ``compressed`` plugin compresses a mosaic as a grey picture, and only the
    format shows it, e.g. 'bayer_rggb8; jpeg compressed ' (compressed_publisher.cpp: a pattern does
    not count as colour); its subscriber passes the mosaic on. It is decoded at full size: reduction
    would mix the colours of its pixels into grey.

    :raises FrameError: as :func:`decode_compressed`
    """
    encoding = fmt.partition(';')[0].strip()
    if not encoding.startswith('bayer_'):
        return None
    kind, (width, height) = read_size(data, fmt)
    mosaic = decode_with_opencv(kind, data, cv2.IMREAD_UNCHANGED)
    if mosaic.ndim > 2:
        # Some publishers convert it to colour themselves, but leave the encoding in the format.
        return None
    encoding = '{}{}'.format(encoding.rstrip('0123456789'), 8 * mosaic.itemsize)
    return RawImage(height, width, encoding, 0, 0, mosaic.tobytes())


def _decode_colours(fmt: str, kind: str, data: Data, full: Size, factor: int) -> np.ndarray:
    """Return the RGB picture of coded data, a jpeg ``factor`` times smaller."""
    rgb = None
    if kind == 'jpeg':
        ended = _is_ended(data)
        data = data if ended else bytes(data) + _JPEG_END
        rgb = decode_jpeg(data, full, factor, damaged=ended)
    if rgb is None:
        # Ignore the orientation in the data (EXIF): a robot's camera is shown as it is mounted.
        flags = _REDUCED[factor] | cv2.IMREAD_IGNORE_ORIENTATION
        if kind == 'png' and data[_PNG_DEPTH] == 16:
            grey = not data[_PNG_DEPTH + 1] & _PNG_COLOURS
            flags = cv2.IMREAD_ANYDEPTH | (cv2.IMREAD_GRAYSCALE if grey else cv2.IMREAD_COLOR)
        rgb = decode_with_opencv(kind, data, flags)
        if rgb.ndim > 2 and (kind == 'jpeg' or not _is_rgb_order(fmt)):
            # In place: a new array of this size takes ten times as long, in page faults.
            cv2.cvtColor(rgb, cv2.COLOR_BGR2RGB, rgb)
    return rgb


def _is_rgb_order(fmt: str) -> bool:
    """Return whether a png was written from RGB although the encoder expects BGR.

    The plugin assumes so for a png of 'rgb8' without 'compressed bgr8' in the format; for a jpeg it
    uses the picture's own header, whatever the format is.
    """
    encoding, _, rest = fmt.partition(';')
    return encoding.startswith('rgb') and 'compressed' in rest and 'bgr' not in rest


def _factor(full: Size, target: Size) -> int:
    """Return the factor by which a jpeg can be reduced in decoding: 1, 2, 4 or 8."""
    return next(factor for factor in sorted(_REDUCED, reverse=True)
                if factor == 1 or (target[0] * factor <= full[0] and target[1] * factor <= full[1]))


def reduced(picture: np.ndarray, target: Size) -> np.ndarray:
    """Return a picture at a smaller size, by the cheapest method that does not flicker."""
    if picture.shape[1::-1] == target:
        return picture
    way = cv2.INTER_AREA if picture.shape[1] >= 2 * target[0] else cv2.INTER_LINEAR
    return cv2.resize(picture, target, interpolation=way)


def decode_with_opencv(what: str, data: Data, flags: int) -> np.ndarray:
    """Call ``cv2.imdecode``; return its array.

    :raises FrameError: OpenCV cannot decode the data
    """
    try:
        picture = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except cv2.error as error:
        raise FrameError('{}: corrupted ({})'.format(what, error.err))
    if picture is None:
        raise FrameError('{}: corrupted, no picture can be made of its {} bytes'.format(
            what, len(data)))
    return picture


def read_size(data: Data, fmt: str = '') -> Tuple[str, Size]:
    """Return ('jpeg' or 'png', (width, height)) from the header of a coded picture.

    :param fmt: its format in the message, for the error's text
    :raises FrameError: neither of the two, truncated, or of an absurd size
    """
    if not len(data):
        raise FrameError('{}: empty'.format(fmt or 'compressed image'))
    head = bytes(data[:8])
    if head == _PNG:
        return 'png', _png_size(data)
    if head.startswith(_JPEG):
        return 'jpeg', _jpeg_head(data)[0]
    raise FrameError('{}: neither jpeg nor png, it begins with {}'.format(
        fmt or 'compressed image', head[:4].hex()))


def _png_size(data: Data) -> Size:
    """Return (width, height) of a png; check both of its ends."""
    if len(data) < 33 or b'IEND' not in bytes(data[-64:]):
        raise FrameError('png: truncated at {} bytes'.format(len(data)))
    size = struct.unpack_from('>II', data, 16)
    check_size('png', *size)
    return size


def _is_ended(data: Data) -> bool:
    """Return whether a jpeg has its end marker.

    Within the picture data a 0 or a restart marker always follows an 0xff, so the end marker is
    unambiguous; some cameras add padding after it.
    """
    return bytes(data).rfind(_JPEG_END, _jpeg_head(data)[1]) >= 0


def _jpeg_head(data: Data) -> Tuple[Size, int]:
    """Return ((width, height) of a jpeg, offset of its picture data)."""
    size: Optional[Size] = None
    place = 2
    try:
        while True:
            marker = data[place + 1]
            if data[place] != 0xff:
                raise FrameError('jpeg: corrupted, no marker at byte {}'.format(place))
            if marker == 0xff or marker in _BARE:
                place += 1 if marker == 0xff else 2
                continue
            (length,) = struct.unpack_from('>H', data, place + 2)
            if marker in _FRAME:
                size = struct.unpack_from('>HH', data, place + 5)[::-1]
            elif marker == 0xda:
                break
            place += 2 + length
    except (IndexError, struct.error):
        raise FrameError('jpeg: truncated in its header, {} bytes'.format(len(data)))
    if size is None:
        raise FrameError('jpeg: corrupted, it does not say its size')
    check_size('jpeg', *size)
    return size, place
