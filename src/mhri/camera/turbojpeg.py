# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Loads libjpeg-turbo's own interface, without numpy, so that the doctor can check for it.

Why not simplejpeg: see doc/libraries.md.
"""
import ctypes
from functools import lru_cache
from typing import Optional

_NAMES = ('libturbojpeg.so.0', 'libturbojpeg.so', 'libturbojpeg.dylib')


@lru_cache(maxsize=1)
def load() -> Optional[ctypes.CDLL]:
    """Return the library with its functions declared, None if it is not installed."""
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
            library.tjInitCompress.restype = ctypes.c_void_p
            library.tjInitCompress.argtypes = []
            library.tjBufSize.restype = ctypes.c_ulong
            library.tjBufSize.argtypes = [ctypes.c_int, ctypes.c_int, ctypes.c_int]
            library.tjCompress2.argtypes = [
                ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_int,
                ctypes.c_int, ctypes.POINTER(ctypes.c_void_p), ctypes.POINTER(ctypes.c_ulong),
                ctypes.c_int, ctypes.c_int, ctypes.c_int]
            return library
        except (OSError, AttributeError):
            continue
    return None
