# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Questions to the X server that Qt does not ask, through libxcb. No Qt here."""
import ctypes
import struct


class XError(Exception):
    """The X server cannot be asked; the text says why."""


class _Cookie(ctypes.Structure):
    _fields_ = [('sequence', ctypes.c_uint)]


def load(name):
    """Return a library that Qt's own plugin for X11 needs as well.

    :raises XError: it is not there
    """
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise XError(str(error))


class XServer:
    """A connection to the X server of ``DISPLAY``.

    :raises XError: there is none
    """

    def __init__(self):
        self._xcb = load('libxcb.so.1')
        self._xcb.xcb_connect.restype = ctypes.c_void_p
        self._connection = ctypes.c_void_p(self._xcb.xcb_connect(None, None))
        if self.has_gone():
            self.close()
            raise XError('no X server answers')

    def has_gone(self):
        """Tell whether the connection has ended."""
        return bool(self._xcb.xcb_connection_has_error(self._connection))

    def fileno(self):
        """Return the descriptor to wait for."""
        return self._xcb.xcb_get_file_descriptor(self._connection)

    def ask(self, function, *arguments, library=None):
        """Return the bytes of an answer, None where there is none (a window that has gone).

        :param function: the C function that sends the question
        :param library: the one that has it; default libxcb
        """
        send, answer = (getattr(library or self._xcb, name) for name in (
            function, function + '_reply'))
        send.restype, answer.restype = _Cookie, ctypes.c_void_p
        place = answer(self._connection, send(self._connection, *arguments), None)
        return None if not place else _take(place, 32 + 4 * struct.unpack_from(
            '=I', ctypes.string_at(place, 8), 4)[0])

    def extensions(self):
        """Return the names of the extensions that the server has, none without an answer."""
        answer = self.ask('xcb_list_extensions')
        names, place = set(), 32
        for _ in range(answer[1] if answer else 0):
            end = place + 1 + answer[place]
            names.add(answer[place + 1:end].decode('latin-1'))
            place = end
        return frozenset(names)

    def next_event(self):
        """Return the first 32 bytes of the next event, None where there is none."""
        self._xcb.xcb_poll_for_event.restype = ctypes.c_void_p
        place = self._xcb.xcb_poll_for_event(self._connection)
        return None if not place else _take(place, 32)

    def close(self):
        """End the connection."""
        self._xcb.xcb_disconnect(self._connection)


def _take(place, size):
    """Copy what xcb has allocated, and free it."""
    data = ctypes.string_at(place, size)
    ctypes.CDLL(None).free(ctypes.c_void_p(place))
    return data
