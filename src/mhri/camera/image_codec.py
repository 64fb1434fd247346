# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compressed colour pictures (jpeg, png) turned into RGB of the size they are shown at.

The formats are those of image_transport's ``compressed`` plugin: 'jpeg' or 'png' alone, as single
cameras write it, or '<encoding>; jpeg compressed [bgr8]'. The first bytes of the data decide; the
format only tells of a Bayer mosaic, and of an unusual order of a png's colours.
"""
import struct
from typing import Optional, Tuple

import numpy as np

from mhri.base.opencv import cv2
from mhri.camera.bayer import bayer_encoding, debayered
from mhri.camera.images import check_size, Data, fit, FrameError, Size
from mhri.camera.jpeg import decode_jpeg

_PNG = b'\x89PNG\r\n\x1a\n'
_JPEG = b'\xff\xd8\xff'
_REDUCED = {1: cv2.IMREAD_COLOR, 2: cv2.IMREAD_REDUCED_COLOR_2, 4: cv2.IMREAD_REDUCED_COLOR_4,
            8: cv2.IMREAD_REDUCED_COLOR_8}
# Markers without a length, and those of a frame header: SOF0..15 without DHT, JPG and DAC.
_BARE = frozenset([0x01, *range(0xd0, 0xd8)])
_FRAME = frozenset(range(0xc0, 0xd0)) - {0xc4, 0xc8, 0xcc}


def decode_compressed(fmt: str, data: Data,
                      view: Optional[Size] = None) -> Tuple[np.ndarray, Size, str]:
    """Decode the data of a ``sensor_msgs/CompressedImage``.

    A jpeg has no checksum: damage in its middle shows as a smear and is not an error; a picture
    that ends early is.

    :param fmt: its ``format``
    :param data: its ``data``, bytes-like
    :param view: room for the picture (width, height) [pixels], None for the full size
    :returns: (rgb uint8 (h, w, 3), (width, height) as sent, 'jpeg' or 'png')
    :raises FrameError: not a jpeg or png, cut off, corrupted, or of an absurd size
    """
    kind, full = read_size(data, fmt)
    target = fit(full, view)
    rgb = _decode_mosaic(fmt, kind, data)
    if rgb is None:
        rgb = _decode_colours(fmt, kind, data, full, _factor(full, target) if kind == 'jpeg' else 1)
    if (rgb.shape[1], rgb.shape[0]) != target:
        rgb = cv2.resize(rgb, target, interpolation=interpolation(rgb, target))
    return rgb, full, kind


def _decode_mosaic(fmt: str, kind: str, data: Data) -> Optional[np.ndarray]:
    """Return the RGB picture of a compressed Bayer mosaic; None if it is not one.

    Decode it at full size: reduced, the colours of its pixels would mix into grey.
    """
    encoding = bayer_encoding(fmt)
    if encoding is None:
        return None
    mosaic = decode_with_opencv(kind, data, cv2.IMREAD_UNCHANGED)
    # Some publishers make the colours themselves, and leave the sensor's encoding in the format.
    return debayered(mosaic, encoding) if mosaic.ndim == 2 else None


def _decode_colours(fmt: str, kind: str, data: Data, full: Size, factor: int) -> np.ndarray:
    """Return the RGB picture of coded data, a jpeg ``factor`` times smaller."""
    rgb = decode_jpeg(data, full, factor) if kind == 'jpeg' else None
    if rgb is None:
        # Ignore the orientation in the data (EXIF): a robot's camera is shown as it is mounted.
        rgb = decode_with_opencv(kind, data, _REDUCED[factor] | cv2.IMREAD_IGNORE_ORIENTATION)
        if kind == 'jpeg' or not _is_rgb_order(fmt):
            # In place: a fresh array of this size costs ten times as much, in page faults.
            cv2.cvtColor(rgb, cv2.COLOR_BGR2RGB, rgb)
    return rgb


def _is_rgb_order(fmt: str) -> bool:
    """Tell whether the writer of a png handed over RGB where the coder takes BGR.

    The plugin assumes so for a png of 'rgb8' whose format does not say 'compressed bgr8'; it trusts
    a jpeg's own header, whatever the format says.
    """
    encoding, _, rest = fmt.partition(';')
    return encoding.startswith('rgb') and 'compressed' in rest and 'bgr' not in rest


def _factor(full: Size, target: Size) -> int:
    """Return how many times smaller a jpeg can be decoded: 1, 2, 4 or 8."""
    return next(factor for factor in sorted(_REDUCED, reverse=True)
                if factor == 1 or (target[0] * factor <= full[0] and target[1] * factor <= full[1]))


def interpolation(picture: np.ndarray, target: Size) -> int:
    """Return the cheapest interpolation that does not flicker at this reduction."""
    way: int = cv2.INTER_AREA if picture.shape[1] >= 2 * target[0] else cv2.INTER_LINEAR
    return way


def decode_with_opencv(what: str, data: Data, flags: int) -> np.ndarray:
    """Call ``cv2.imdecode``; return its array.

    :raises FrameError: OpenCV could make no picture of the data
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

    :param fmt: what the message calls it, for the error's text
    :raises FrameError: neither of the two, cut off, or of an absurd size
    """
    if not len(data):
        raise FrameError('{}: empty'.format(fmt or 'compressed image'))
    head = bytes(data[:8])
    if head == _PNG:
        return 'png', _png_size(data)
    if head.startswith(_JPEG):
        return 'jpeg', _jpeg_size(data)
    raise FrameError('{}: neither jpeg nor png, it begins with {}'.format(
        fmt or 'compressed image', head[:4].hex()))


def _png_size(data: Data) -> Size:
    """Return (width, height) of a png; check both of its ends."""
    if len(data) < 33 or b'IEND' not in bytes(data[-64:]):
        raise FrameError('png: truncated at {} bytes'.format(len(data)))
    size = struct.unpack_from('>II', data, 16)
    check_size('png', *size)
    return size


def _jpeg_size(data: Data) -> Size:
    """Return (width, height) of a jpeg; check both of its ends."""
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
    # Within the picture data 0 or a restart marker always follows an 0xff, so the end marker cannot
    # be mistaken; some cameras pad behind it.
    if bytes(data).rfind(b'\xff\xd9', place) < 0:
        raise FrameError('jpeg: truncated at {} bytes'.format(len(data)))
    return size
