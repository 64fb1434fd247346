# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which keys are down in truth.

An X server repeats a held key as releases and presses. Qt 5 knows them for repeats only where the
press is in its queue already when it reads the release; under load it often is not, and a key that
is held seems to be let go and pressed again, many times in a minute. So the server is asked.
"""
import contextlib
import os

from python_qt_binding.QtGui import QGuiApplication

from mhri.base.remote_display import remote_kind
from mhri.driving.gui.x_server import XError, XServer


class KeyState:
    """The keyboard as the X server has it; one short question to it for each look.

    Where there is no X server nothing is known: a Wayland compositor leaves repeating to Qt, which
    then knows its own repeats.
    """

    def __init__(self):
        self._server = None
        #: how the display is shown on another computer, see :func:`remote_kind`
        self.remote = ''
        if QGuiApplication.platformName() == 'xcb':
            with contextlib.suppress(XError):
                self._server = XServer()
                self.remote = remote_kind(os.environ.get('DISPLAY', ''), self._server.extensions())

    def down(self):
        """Return the key codes (X11: evdev's plus 8) that are down now; None: not known."""
        answer = self._server and self._server.ask('xcb_query_keymap')
        if not answer:
            return None
        bits = answer[8:40]
        return frozenset(code for code in range(8, 256) if bits[code // 8] >> code % 8 & 1)

    def close(self):
        """End the connection; nothing is known any more."""
        if self._server is not None:
            self._server.close()
            self._server = None
