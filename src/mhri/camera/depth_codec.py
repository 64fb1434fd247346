# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads and writes depth pictures in the format of image_transport's ``compressedDepth`` plugin.

The format is '<encoding>; compressedDepth png', '<encoding>; compressedDepth rvl', or, from older
writers, '<encoding>; compressedDepth' or 'compressedDepth' alone, both png. The data begin with 12
bytes: int32 (0), float A, float B, little-endian; then a 16-bit grey png, or for rvl int32 columns,
int32 rows and the RVL stream. For 16UC1 the numbers are millimetres, and A and B are ignored; for
32FC1 they are inverse depth: q = A / depth + B, depth = A / (q - B), 0 invalid.
"""
from functools import lru_cache
import math
import struct
from typing import Optional, Tuple

import numpy as np

from mhri.base.opencv import cv2
from mhri.base.wire import Data
from mhri.camera.image_codec import decode_with_opencv, read_size
from mhri.camera.images import check_size, fit, FrameError, Size
from mhri.camera.rvl import decode_rvl, encode_rvl

_HEADER = struct.Struct('<iff')
_RVL_SIZE = struct.Struct('<ii')
DEPTH_MAX_M = 10.0
# Depth at which one step of a float32 picture is 1 m.
QUANTIZATION_M = 100.0
PNG_LEVEL = 1
MM_PER_M = 1000.0


def decode_depth(fmt: str, data: Data, view: Optional[Size] = None) -> Tuple[np.ndarray, Size, str]:
    """Decode the data of a ``sensor_msgs/CompressedImage`` of compressed depth.

    :param fmt: its ``format``
    :param data: its ``data``, bytes-like
    :param view: room for the picture (width, height) [pixels], None for the full size
    :returns: (depth [m] float32 (h, w), NaN invalid; (width, height) as sent; transport in words)
    :raises FrameError: another format, truncated, corrupted, or of an absurd size
    """
    encoding, codec = parse_format(fmt)
    if len(data) <= _HEADER.size:
        raise FrameError('{}: truncated, {} bytes'.format(fmt, len(data)))
    _, a, b = _HEADER.unpack_from(data)
    payload = memoryview(data)[_HEADER.size:]
    pixels = _decode_rvl(payload) if codec == 'rvl' else _decode_png(payload)
    rest = (pixels.shape[1], pixels.shape[0]), 'compressedDepth ' + codec
    pixels = shrink_depth(pixels, view)
    if encoding == '16UC1' or not encoding and not _is_quantised(a, b):
        return (metres(pixels),) + rest
    if not _is_quantised(a, b):
        raise FrameError('{}: corrupted, quantisation A = {:g}, B = {:g}'.format(fmt, a, b))
    return (np.take(_depth_table(a, b), pixels),) + rest


def parse_format(fmt: str) -> Tuple[str, str]:
    """Return (encoding '16UC1', '32FC1' or '' if not given, codec 'png' or 'rvl').

    :raises FrameError: the format is not compressed depth
    """
    encoding, _, rest = (part.strip() for part in fmt.partition(';'))
    if encoding == 'compressedDepth' or encoding.startswith('compressedDepth '):
        encoding, rest = '', encoding
    words = rest.split()
    codec = words[1] if len(words) > 1 else 'png'
    encoding = {'mono16': '16UC1'}.get(encoding, encoding)
    if words[:1] != ['compressedDepth'] or codec not in ('png', 'rvl') \
            or encoding not in ('', '16UC1', '32FC1'):
        raise FrameError('compressed depth: format {!r} is none of 16UC1 or 32FC1; '
                         'compressedDepth, compressedDepth png, compressedDepth rvl'.format(fmt))
    return encoding, codec


def _is_quantised(a: float, b: float) -> bool:
    """Return whether A and B are valid for inverse depth: older writers left them unset."""
    return math.isfinite(a) and math.isfinite(b) and 1e-6 < a < 1e9 and -1e9 < b <= 1.0


@lru_cache(maxsize=1)
def _depth_table(a: float, b: float) -> np.ndarray:
    """Return the depth [m] of each of the 65536 values; the last table is cached."""
    values = np.arange(65536, dtype=np.float32) - np.float32(b)
    with np.errstate(divide='ignore', invalid='ignore'):
        depth = np.float32(a) / values
    depth[0] = np.nan
    depth[~((depth > 0) & np.isfinite(depth))] = np.nan
    return depth


def _decode_png(payload: memoryview) -> np.ndarray:
    """Return the uint16 pixels of a grey 16-bit png."""
    kind, _ = read_size(payload, 'compressedDepth png')
    if kind != 'png':
        raise FrameError('compressedDepth png: it holds a {}'.format(kind))
    pixels = decode_with_opencv('compressedDepth png', payload, cv2.IMREAD_UNCHANGED)
    if pixels.dtype != np.uint16 or pixels.ndim != 2:
        raise FrameError('compressedDepth png: expected 16-bit grey pixels, got {} x {}'.format(
            pixels.dtype, pixels.shape[2] if pixels.ndim > 2 else 1))
    return pixels


def _decode_rvl(payload: memoryview) -> np.ndarray:
    """Return the uint16 pixels of an rvl payload."""
    if len(payload) < _RVL_SIZE.size:
        raise FrameError('compressedDepth rvl: truncated, {} bytes'.format(len(payload)))
    columns, rows = _RVL_SIZE.unpack_from(payload)
    check_size('compressedDepth rvl', columns, rows)
    return decode_rvl(payload[_RVL_SIZE.size:], columns * rows).reshape(rows, columns)


def metres(pixels: np.ndarray) -> np.ndarray:
    """Return depth [m] as float32 with NaN for invalid, from uint16 [mm] or float32 [m]."""
    if pixels.dtype.kind == 'u':
        return np.take(MM_TABLE, pixels)
    with np.errstate(invalid='ignore'):
        return np.where((pixels > 0) & (pixels < np.inf), pixels, np.float32(np.nan))


def _mm_table() -> np.ndarray:
    """Return the depth [m] of every possible pixel in millimetres."""
    table = np.arange(65536, dtype=np.float32) / np.float32(MM_PER_M)
    table[0] = np.nan
    return table


MM_TABLE = _mm_table()


def shrink_depth(pixels: np.ndarray, view: Optional[Size]) -> np.ndarray:
    """Return depth pixels of any unit, reduced to the size that fits a view (None: unchanged).

    Pixels are never averaged: a mean of a near and a far pixel, or of an invalid one, would be
    false.
    """
    full = (pixels.shape[1], pixels.shape[0])
    target = fit(full, view)
    if target == full:
        return pixels
    return cv2.resize(pixels, target, interpolation=cv2.INTER_NEAREST)


def encode_depth(depth: np.ndarray, codec: str = 'png',
                 depth_max_m: float = DEPTH_MAX_M) -> Tuple[str, bytes]:
    """Return (format, data) of a ``sensor_msgs/CompressedImage`` as written by the plugin.

    :param depth: (h, w) uint16 [mm], 0 invalid; or float32 [m], NaN, infinite or <= 0 invalid
    :param codec: 'png' or 'rvl'
    :param depth_max_m: greater depths are written as invalid [m]
    """
    if depth.dtype == np.uint16:
        encoding, a, b = '16UC1', 0.0, 0.0
        pixels = np.where(depth > min(depth_max_m * 1000.0, 65535.0), np.uint16(0), depth)
    else:
        encoding = '32FC1'
        a = QUANTIZATION_M * (QUANTIZATION_M + 1.0)
        b = 1.0 - a / depth_max_m
        # Depths below A / (65535 - B) do not fit into 16 bits (0.15 m at the defaults).
        with np.errstate(divide='ignore', invalid='ignore'):
            inverse = a / depth + b
            good = (depth > 0) & (depth < depth_max_m) & (inverse < 65536.0)
        pixels = np.where(good, inverse, 0).astype(np.uint16)
    if codec == 'rvl':
        payload = _RVL_SIZE.pack(pixels.shape[1], pixels.shape[0]) + encode_rvl(pixels)
    else:
        options = [cv2.IMWRITE_PNG_COMPRESSION, PNG_LEVEL]
        payload = cv2.imencode('.png', pixels, options)[1].tobytes()
    return ('{}; compressedDepth {}'.format(encoding, codec), _HEADER.pack(0, a, b) + payload)
