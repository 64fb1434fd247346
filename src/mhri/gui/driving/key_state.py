# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which keys are down in truth.

An X server repeats a held key as releases and presses. Qt 5 knows them for repeats only where the
press is in its queue already when it reads the release; under load it often is not, and a key that
is held seems to be let go and pressed again, many times in a minute. So the server is asked.
"""
import ctypes
import ctypes.util

from python_qt_binding.QtGui import QGuiApplication


class _Cookie(ctypes.Structure):
    _fields_ = [('sequence', ctypes.c_uint)]


class _Keymap(ctypes.Structure):
    """``xcb_query_keymap_reply_t`` of xcb/xproto.h."""

    _fields_ = [('response_type', ctypes.c_uint8), ('pad', ctypes.c_uint8),
                ('sequence', ctypes.c_uint16), ('length', ctypes.c_uint32),
                ('keys', ctypes.c_uint8 * 32)]


def _load():
    """Return libxcb, which Qt's own plugin for X11 needs as well, or None."""
    try:
        library = ctypes.CDLL(ctypes.util.find_library('xcb') or 'libxcb.so.1')
        library.xcb_connect.restype = ctypes.c_void_p
        library.xcb_connect.argtypes = [ctypes.c_char_p, ctypes.POINTER(ctypes.c_int)]
        library.xcb_connection_has_error.argtypes = [ctypes.c_void_p]
        library.xcb_disconnect.argtypes = [ctypes.c_void_p]
        library.xcb_query_keymap.restype = _Cookie
        library.xcb_query_keymap.argtypes = [ctypes.c_void_p]
        library.xcb_query_keymap_reply.restype = ctypes.POINTER(_Keymap)
        library.xcb_query_keymap_reply.argtypes = [ctypes.c_void_p, _Cookie, ctypes.c_void_p]
    except (OSError, AttributeError):
        return None
    return library


class KeyState:
    """The keyboard as the X server has it; one short question to it for each look.

    Where there is no X server nothing is known: a Wayland compositor leaves repeating to Qt, which
    then knows its own repeats.
    """

    def __init__(self):
        self._library = self._connection = None
        if QGuiApplication.platformName() != 'xcb':
            return
        library = _load()
        if library is None:
            return
        connection = library.xcb_connect(None, None)
        if library.xcb_connection_has_error(connection):
            library.xcb_disconnect(connection)
            return
        self._library, self._connection = library, connection

    def down(self):
        """Return the key codes (X11: evdev's plus 8) that are down now; None: not known."""
        if self._connection is None:
            return None
        reply = self._library.xcb_query_keymap_reply(
            self._connection, self._library.xcb_query_keymap(self._connection), None)
        if not reply:
            return None
        bits = bytes(reply.contents.keys)
        ctypes.CDLL(None).free(ctypes.cast(reply, ctypes.c_void_p))
        return frozenset(code for code in range(8, 256) if bits[code // 8] >> code % 8 & 1)

    def close(self):
        """End the connection; nothing is known any more."""
        if self._connection is not None:
            self._library.xcb_disconnect(self._connection)
            self._connection = None
