# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The keys that are physically down.

An X server repeats a held key as releases and presses. Qt 5 detects such repeats only if the press
is already in its queue when it reads the release; under load it often is not, and a held key seems
to be released and pressed again, many times a minute. So this module asks the server.
"""
import contextlib
import os

from python_qt_binding.QtGui import QGuiApplication

from mhri.base.remote_display import remote_kind
from mhri.driving.gui.x_server import XError, XServer


class KeyState:
    """The state of the keyboard at the X server; each call is one short request.

    Without an X server the state is unknown: a Wayland compositor leaves repeating to Qt, which
    then recognises its own repeats.
    """

    def __init__(self):
        self._server = None
        #: the kind of remote display, see :func:`remote_kind`
        self.remote = ''
        if QGuiApplication.platformName() == 'xcb':
            with contextlib.suppress(XError):
                self._server = XServer()
                self.remote = remote_kind(os.environ.get('DISPLAY', ''), self._server.extensions())

    def down(self):
        """Return the key codes (X11: evdev's plus 8) that are down now, None if unknown."""
        answer = self._server and self._server.ask('xcb_query_keymap')
        if not answer:
            return None
        bits = answer[8:40]
        return frozenset(code for code in range(8, 256) if bits[code // 8] >> code % 8 & 1)

    def close(self):
        """Close the connection; the state is unknown from now on."""
        if self._server is not None:
            self._server.close()
            self._server = None
