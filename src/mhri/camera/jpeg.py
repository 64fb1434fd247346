# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Jpeg pictures read and written by libjpeg-turbo's own interface, where it is installed.

The pixels are those of ``cv2.imdecode``, which uses libjpeg-turbo as well, in a third of the time
(2.5 and 0.7 ms for 640 x 480 where this was written): OpenCV asks for them row by row. Calls go
through ctypes, which lets other threads run meanwhile; every call has its own handle, so any thread
may call. Interface: turbojpeg.h, 1.5 and later.
"""
import ctypes
from typing import Optional

import numpy as np

from mhri.camera.images import Data, Size
from mhri.camera.turbojpeg import load

_RGB = 0             # TJPF_RGB
_FATAL = 1           # TJERR_FATAL; the other is a warning: the picture is usable
_HALF_BOTH_WAYS = 2  # TJSAMP_420: colour at half the size, as cv2 writes it
_KEEP_BUFFER = 1024  # TJFLAG_NOREALLOC


_LIBRARY = load()


def decode_jpeg(data: Data, full: Size, factor: int = 1) -> Optional[np.ndarray]:
    """Decode a jpeg.

    As with any decoder, damage in the middle of the data shows as a smear.

    :param data: bytes-like, contiguous
    :param full: (width, height) from its header [pixels]
    :param factor: 1, 2, 4 or 8: make it so many times smaller, rounded up; larger is faster
    :returns: rgb uint8 (h, w, 3), or None: the library is not installed, or cannot read this one
        (e.g. in CMYK)
    """
    if _LIBRARY is None:
        return None
    coded = np.frombuffer(data, np.uint8)
    width, height = (-(-side // factor) for side in full)
    pixels = np.empty((height, width, 3), np.uint8)
    decompressor = _LIBRARY.tjInitDecompress()
    if not decompressor:
        return None
    try:
        failed = _LIBRARY.tjDecompress2(
            decompressor, coded.ctypes.data, coded.size, pixels.ctypes.data, width,
            pixels.strides[0], height, _RGB, 0)
        if failed and _LIBRARY.tjGetErrorCode(decompressor) == _FATAL:
            return None
        return pixels
    finally:
        _LIBRARY.tjDestroy(decompressor)


def encode_jpeg(rgb: np.ndarray, quality: int = 80) -> bytes:
    """Return a picture as the bytes of a jpeg.

    :param rgb: uint8 (h, w, 3)
    :param quality: 1 to 100
    """
    return _encode_by_library(np.ascontiguousarray(rgb), quality) or _encode_by_cv2(rgb, quality)


def _encode_by_cv2(rgb: np.ndarray, quality: int) -> bytes:
    """Return the bytes as OpenCV writes them."""
    # Importing cv2 takes a second on a busy machine; asking for the library must not.
    from mhri.base.opencv import cv2
    coded: bytes = cv2.imencode('.jpg', cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR),
                                [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
    return coded


def _encode_by_library(rgb: np.ndarray, quality: int) -> Optional[bytes]:
    """Return the bytes, or None if the library is not installed or fails."""
    if _LIBRARY is None:
        return None
    compressor = _LIBRARY.tjInitCompress()
    if not compressor:
        return None
    try:
        height, width = rgb.shape[:2]
        coded = np.empty(_LIBRARY.tjBufSize(width, height, _HALF_BOTH_WAYS), np.uint8)
        where, size = ctypes.c_void_p(coded.ctypes.data), ctypes.c_ulong(coded.size)
        failed = _LIBRARY.tjCompress2(
            compressor, rgb.ctypes.data, width, rgb.strides[0], height, _RGB,
            ctypes.byref(where), ctypes.byref(size), _HALF_BOTH_WAYS, quality, _KEEP_BUFFER)
        return None if failed else coded[:size.value].tobytes()
    finally:
        _LIBRARY.tjDestroy(compressor)
