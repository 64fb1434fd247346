# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Jpeg pictures decoded by libjpeg-turbo's own interface, where it is installed.

The pixels are those of ``cv2.imdecode``, for which libjpeg-turbo works as well, in a third of the
time (2.5 and 0.7 ms for 640 x 480 where this was written): OpenCV asks for them row by row. The
library is called through ctypes, which lets other threads run meanwhile; every call has a
decompressor of its own, so that any thread may decode. Interface: turbojpeg.h, 1.5 and later.
"""
import ctypes

import numpy as np

_NAMES = ('libturbojpeg.so.0', 'libturbojpeg.so', 'libturbojpeg.dylib')
_RGB = 0             # TJPF_RGB
_FATAL = 1           # TJERR_FATAL; the other is a warning, and there is a picture


def _load():
    """Return the library with its functions declared, None where it is not installed."""
    for name in _NAMES:
        try:
            library = ctypes.CDLL(name)
            library.tjInitDecompress.restype = ctypes.c_void_p
            library.tjInitDecompress.argtypes = []
            library.tjDestroy.argtypes = [ctypes.c_void_p]
            library.tjGetErrorCode.argtypes = [ctypes.c_void_p]
            library.tjDecompress2.argtypes = [
                ctypes.c_void_p, ctypes.c_void_p, ctypes.c_ulong, ctypes.c_void_p, ctypes.c_int,
                ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_int]
            return library
        except (OSError, AttributeError):
            continue
    return None


_LIBRARY = _load()


def available():
    """Tell whether the library is there."""
    return _LIBRARY is not None


def decode_jpeg(data, full, factor=1):
    """Decode a jpeg.

    As with any decoder, damage in the middle of the data shows as a smear.

    :param data: bytes-like, contiguous
    :param full: (width, height) that its header says [pixels]
    :param factor: 1, 2, 4 or 8: make it so many times smaller, rounded up, which is quicker
    :returns: rgb uint8 (h, w, 3), or None: the library is not there, or does not take this one
        (e.g. one in the colours of a printer)
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
