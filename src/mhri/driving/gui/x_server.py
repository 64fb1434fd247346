# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests to the X server that Qt does not offer, through libxcb. No Qt here.

Why not python-xlib: see doc/libraries.md.
"""
import ctypes
import struct


class XError(Exception):
    """A request to the X server is impossible; the text gives the reason."""


class _Cookie(ctypes.Structure):
    _fields_ = [('sequence', ctypes.c_uint)]


def load(name):
    """Load a library that Qt's own plugin for X11 needs as well.

    :raises XError: the library is missing
    """
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise XError(str(error))


class XServer:
    """A connection to the X server of ``DISPLAY``.

    :raises XError: the server cannot be reached
    """

    def __init__(self):
        self._xcb = load('libxcb.so.1')
        self._xcb.xcb_connect.restype = ctypes.c_void_p
        self._connection = ctypes.c_void_p(self._xcb.xcb_connect(None, None))
        if self.has_gone():
            self.close()
            raise XError('no X server answers')

    def has_gone(self):
        """Return whether the connection has ended."""
        return bool(self._xcb.xcb_connection_has_error(self._connection))

    def fileno(self):
        """Return the file descriptor to wait for."""
        return self._xcb.xcb_get_file_descriptor(self._connection)

    def ask(self, function, *arguments, library=None):
        """Return the bytes of a reply, None without one (e.g. for a closed window).

        :param function: the C function that sends the request
        :param library: the library of that function; default libxcb
        """
        send, answer = (getattr(library or self._xcb, name) for name in (
            function, function + '_reply'))
        send.restype, answer.restype = _Cookie, ctypes.c_void_p
        place = answer(self._connection, send(self._connection, *arguments), None)
        return None if not place else _take(place, 32 + 4 * struct.unpack_from(
            '=I', ctypes.string_at(place, 8), 4)[0])

    def extensions(self):
        """Return the names of the server's extensions, none without a reply."""
        answer = self.ask('xcb_list_extensions')
        names, place = set(), 32
        for _ in range(answer[1] if answer else 0):
            end = place + 1 + answer[place]
            names.add(answer[place + 1:end].decode('latin-1'))
            place = end
        return frozenset(names)

    def next_event(self):
        """Return the first 32 bytes of the next event, None if none is queued."""
        self._xcb.xcb_poll_for_event.restype = ctypes.c_void_p
        place = self._xcb.xcb_poll_for_event(self._connection)
        return None if not place else _take(place, 32)

    def close(self):
        """Close the connection."""
        self._xcb.xcb_disconnect(self._connection)


def _take(place, size):
    """Copy memory allocated by xcb, and free it."""
    data = ctypes.string_at(place, size)
    ctypes.CDLL(None).free(ctypes.c_void_p(place))
    return data
