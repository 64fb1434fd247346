# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Presses of STOP as reported by the X server, for a process other than the GUI's.

Raw events (XInput 2, ``XI_Raw...`` of XI2proto.txt) report every button and key, even under a grab
of pointer or keyboard and however short the press is; the position of the pointer and the window
with the keyboard are then requested at once. No Qt here: this runs in parallel to it.
"""
import collections
import ctypes
import struct

from mhri.driving.gui.x_server import load, XError, XServer

_RAW_KEY, _RAW_KEY_UP, _RAW_BUTTON, _RAW_TOUCH = 13, 14, 15, 22
_MASK = 1 << _RAW_KEY | 1 << _RAW_KEY_UP | 1 << _RAW_BUTTON | 1 << _RAW_TOUCH
_ALL_MASTERS = 1
_GENERIC_EVENT, _MAPPING_CHANGED = 35, 34
_SHIFT_MASK, _LEFT_BUTTON_MASK = 1 << 0, 1 << 8
_SPACE, _SHIFT_L, _SHIFT_R = 0x20, 0xffe1, 0xffe2
_FIRST_KEY, _KEYS = 8, 248
# The focus follows the pointer.
_POINTER_ROOT = 1
# More than the depth of windows under any window manager.
_DEPTH = 20


class _Screens(ctypes.Structure):
    """``xcb_screen_iterator_t`` of xcb/xproto.h; a screen begins with its root window."""

    _fields_ = [('data', ctypes.POINTER(ctypes.c_uint32)), ('rem', ctypes.c_int),
                ('index', ctypes.c_int)]


_Pointer = collections.namedtuple('_Pointer', 'child x y mask')


class XPresses(XServer):
    """The buttons and keys of the X server of ``DISPLAY``.

    :raises XError: the server does not exist, or does not support raw events
    """

    def __init__(self):
        super().__init__()
        self._xcb.xcb_get_setup.restype = ctypes.c_void_p
        self._xcb.xcb_setup_roots_iterator.restype = _Screens
        setup = ctypes.c_void_p(self._xcb.xcb_get_setup(self._connection))
        self._root = self._xcb.xcb_setup_roots_iterator(setup).data[0]
        self._shifts_down = set()
        self._read_keyboard()
        self._select()

    def _select(self):
        """Select the raw events."""
        xinput = load('libxcb-xinput.so.0')
        version = self.ask('xcb_input_xi_query_version', 2, 2, library=xinput)
        if version is None or struct.unpack_from('=HH', version, 8) < (2, 1):
            raise XError('the X server is too old (XInput 2.1 is needed)')
        mask = struct.pack('=HHI', _ALL_MASTERS, 1, _MASK)
        xinput.xcb_input_xi_select_events(self._connection, self._root, 1, mask)
        self._xcb.xcb_flush(self._connection)

    def _read_keyboard(self):
        """Read the key codes of the space bar and Shift."""
        answer = self.ask('xcb_get_keyboard_mapping', _FIRST_KEY, _KEYS)
        if answer is None:
            raise XError('the X server does not tell its keys')
        width = answer[1]
        symbols = struct.unpack_from('={}I'.format(width * _KEYS), answer, 32)
        self._spaces, self._shifts = set(), set()
        for key in range(_KEYS):
            first = symbols[key * width]
            if first == _SPACE:
                self._spaces.add(_FIRST_KEY + key)
            elif first in (_SHIFT_L, _SHIFT_R):
                self._shifts.add(_FIRST_KEY + key)

    def stops(self, places):
        """Return whether STOP was pressed since the last call, by a stop button or Shift+Space.

        :param places: the result of :func:`mhri.driving.gui.stop_button.stop_places`
        :raises XError: the connection to the X server has ended
        """
        found = False
        while True:
            event = self.next_event()
            if event is None:
                break
            # Read all of them, since the state of Shift follows from all.
            found = self._is_stop(event, places) or found
        if self.has_gone():
            raise XError('the X server has gone')
        return found

    def _is_stop(self, event, places):
        """Return whether one event is a press of STOP."""
        if event[0] & 0x7f == _MAPPING_CHANGED:
            self._read_keyboard()
        if event[0] & 0x7f != _GENERIC_EVENT:
            return False
        kind, code = struct.unpack_from('=H6xI', event, 8)
        if kind == _RAW_KEY_UP:
            self._shifts_down.discard(code)
        elif kind == _RAW_KEY and code in self._shifts:
            self._shifts_down.add(code)
        elif kind == _RAW_KEY:
            return code in self._spaces and self._is_shifted() and self._has_keyboard(places)
        elif kind == _RAW_TOUCH or code == 1 or self._pointer().mask & _LEFT_BUTTON_MASK:
            return self._is_on_stop(places)
        return False

    def _is_shifted(self):
        """Return whether Shift is held, or latched by a desktop's sticky keys."""
        return bool(self._shifts_down or self._pointer().mask & _SHIFT_MASK)

    def _pointer(self, window=None):
        """Return the pointer's position in a window, and the child window it is in."""
        answer = self.ask('xcb_query_pointer', window or self._root)
        return _Pointer(0, 0, 0, 0) if answer is None else _Pointer(
            *struct.unpack_from('=I4xhhH', answer, 12))

    def _under_pointer(self):
        """Yield (window, x, y) of the windows under the pointer, the outermost first [px].

        Of overlapping windows only the front one is included.
        """
        window = self._pointer().child
        for _ in range(_DEPTH):
            if not window:
                return
            at = self._pointer(window)
            yield window, at.x, at.y
            window = at.child

    def _is_on_stop(self, places):
        """Return whether the pointer is on a visible stop button."""
        return any(left <= x < left + width and top <= y < top + height
                   for window, x, y in self._under_pointer()
                   for left, top, width, height in places.get(window, ()))

    def _has_keyboard(self, places):
        """Return whether one of the windows has the keyboard."""
        answer = self.ask('xcb_get_input_focus')
        window = struct.unpack_from('=I', answer, 8)[0] if answer else 0
        if window == _POINTER_ROOT:
            return any(each in places for each, _, _ in self._under_pointer())
        for _ in range(_DEPTH):
            if window in places:
                return True
            answer = self.ask('xcb_query_tree', window) if window else None
            window = struct.unpack_from('=I', answer, 12)[0] if answer else 0
        return False
