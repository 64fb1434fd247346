# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Raw ``sensor_msgs/Image`` data turned into RGB or depth, whatever the encoding and padding.

Encodings: http://docs.ros.org/en/noetic/api/sensor_msgs/html/image__encodings_8h_source.html and
REP-118 for depth.
"""
from typing import NamedTuple, Optional, Tuple

import numpy as np

from mhri.base.opencv import cv2
from mhri.camera.bayer import BAYER
from mhri.camera.image_codec import interpolation
from mhri.camera.images import check_size, Data, fit, FrameError, Size

# Encoding: (type of one element, elements per pixel, how cv2 makes RGB of it; None: RGB already).
_COLOUR = {
    'rgb8': ('u1', 3, None), 'bgr8': ('u1', 3, cv2.COLOR_BGR2RGB),
    '8UC3': ('u1', 3, cv2.COLOR_BGR2RGB),
    'rgba8': ('u1', 4, cv2.COLOR_RGBA2RGB), 'bgra8': ('u1', 4, cv2.COLOR_BGRA2RGB),
    'mono8': ('u1', 1, cv2.COLOR_GRAY2RGB), '8UC1': ('u1', 1, cv2.COLOR_GRAY2RGB),
    'mono16': ('u2', 1, cv2.COLOR_GRAY2RGB),
    # In ROS yuv422 is UYVY, yuv422_yuy2 is YUYV; drivers say yuyv and uyvy too.
    'yuv422': ('u1', 2, cv2.COLOR_YUV2RGB_UYVY), 'uyvy': ('u1', 2, cv2.COLOR_YUV2RGB_UYVY),
    'yuv422_yuy2': ('u1', 2, cv2.COLOR_YUV2RGB_YUY2), 'yuyv': ('u1', 2, cv2.COLOR_YUV2RGB_YUY2),
    **{name: ('u2' if name.endswith('16') else 'u1', 1, conversion)
       for name, conversion in BAYER.items()},
}
_DEPTH = {'16UC1': ('u2', 1), 'mono16': ('u2', 1), '32FC1': ('f4', 1)}
MM_PER_M = 1000.0


class RawImage(NamedTuple):
    """The fields of a ``sensor_msgs/Image`` that say how to read it; ``data`` is not a copy."""

    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    data: Data


def decode_raw(image: RawImage, view: Optional[Size] = None) -> Tuple[np.ndarray, Size]:
    """Return (rgb uint8 (h, w, 3), (width, height) as sent) of a raw colour or grey picture.

    :param image: :class:`RawImage`-like: height, width, encoding, is_bigendian, step, data
    :param view: room for the picture (width, height) [pixels], None for the full size
    :raises FrameError: an unknown encoding, an absurd size, or too little data
    """
    if image.encoding not in _COLOUR:
        raise FrameError('raw image: encoding {!r} is none of {}'.format(
            image.encoding, ', '.join(sorted(_COLOUR))))
    kind, channels, conversion = _COLOUR[image.encoding]
    pixels = _pixels(image, kind, channels)
    full = (image.width, image.height)
    target = fit(full, view)
    if kind == 'u2':
        pixels = (pixels >> 8).astype(np.uint8)
    if channels != 2 and not image.encoding.startswith('bayer'):
        pixels = _reduce(pixels, target)
    elif channels == 2 and image.width % 2:
        raise FrameError('raw image: {} with an odd width of {}'.format(
            image.encoding, image.width))
    if conversion is not None:
        pixels = cv2.cvtColor(pixels, conversion)
    return np.ascontiguousarray(_reduce(pixels, target)), full


def decode_raw_depth(image: RawImage, view: Optional[Size] = None) -> Tuple[np.ndarray, Size]:
    """Return (depth [m] float32 (h, w), NaN invalid; (width, height) as sent) of a raw picture.

    16UC1 is in millimetres, 0 invalid; 32FC1 in metres, NaN, infinite or <= 0 invalid (REP-118).

    :param view: room for the picture (width, height) [pixels], None for the full size
    :raises FrameError: an unknown encoding, an absurd size, or too little data
    """
    if image.encoding not in _DEPTH:
        raise FrameError('raw depth: encoding {!r} is none of {}'.format(
            image.encoding, ', '.join(sorted(_DEPTH))))
    kind, channels = _DEPTH[image.encoding]
    pixels = _pixels(image, kind, channels)
    return metres(shrink_depth(pixels, view)), (image.width, image.height)


def metres(pixels: np.ndarray) -> np.ndarray:
    """Return depth [m] as float32 with NaN for invalid, from uint16 [mm] or float32 [m]."""
    if pixels.dtype.kind == 'u':
        return np.take(MM_TABLE, pixels)
    with np.errstate(invalid='ignore'):
        return np.where((pixels > 0) & (pixels < np.inf), pixels, np.float32(np.nan))


def _mm_table() -> np.ndarray:
    """Return the metres of every possible pixel in millimetres."""
    table = np.arange(65536, dtype=np.float32) / np.float32(MM_PER_M)
    table[0] = np.nan
    return table


MM_TABLE = _mm_table()


def _pixels(image: RawImage, kind: str, channels: int) -> np.ndarray:
    """Return the pixels in this machine's byte order: (h, w), or (h, w, channels)."""
    what = 'raw image ' + image.encoding
    check_size(what, image.width, image.height)
    row = image.width * channels * np.dtype(kind).itemsize
    step = image.step or row
    needed = step * (image.height - 1) + row
    if step < row or len(image.data) < needed:
        raise FrameError('{}: truncated, {} x {} pixels need rows of {} bytes and {} bytes in all; '
                         'there are rows of {} and {} bytes'.format(
                             what, image.width, image.height, row, needed, step, len(image.data)))
    stored = np.dtype(kind).newbyteorder('>' if image.is_bigendian else '<')
    shape = (image.height, image.width, channels)[:2 if channels == 1 else 3]
    strides = (step, channels * stored.itemsize, stored.itemsize)[:len(shape)]
    pixels = np.ndarray(shape, stored, image.data, strides=strides)
    return pixels.astype(stored.newbyteorder('='), copy=False)


def _reduce(pixels: np.ndarray, target: Size) -> np.ndarray:
    """Return the picture at the target size."""
    if (pixels.shape[1], pixels.shape[0]) == target:
        return pixels
    return cv2.resize(pixels, target, interpolation=interpolation(pixels, target))


def shrink_depth(pixels: np.ndarray, view: Optional[Size]) -> np.ndarray:
    """Return depth pixels of any unit at the size that fits a view (None: as they are).

    Nothing is mixed: a pixel between a near and a far one, or an invalid one, would be a lie.
    """
    full = (pixels.shape[1], pixels.shape[0])
    target = fit(full, view)
    if target == full:
        return pixels
    return cv2.resize(pixels, target, interpolation=cv2.INTER_NEAREST)
