# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether a display is shown on another computer, and what is held there may be long let go.

When the connection of such a display freezes, no release arrives, and the X server of a VNC goes on
saying that the key is down. Of a key that is held, though, its repeats come over the connection:
the server of a VNC makes none itself.
"""
import re
from typing import Collection

#: How long what is held counts without a sign of life [s]; the first repeat of a key takes 0.2 to
#: 0.7 s on the usual desktops.
HELD_S = 1.0

VNC, FORWARDED = 'VNC', 'forwarded X'
_VNC_EXTENSION = 'VNC-EXTENSION'
# "host:10.0", "tcp/host:0", "[::1]:10"; a path stands for a socket of this computer (macOS).
_DISPLAY = re.compile(r'(?:[a-z0-9]+/)?(?P<host>[^/]*):(?P<number>\d+)(?:\.\d+)?$')
_THIS_COMPUTER = ('localhost', '127.0.0.1', '[::1]', '::1')
# The first display that ssh forwards.
_FIRST_OF_SSH = 10


def remote_kind(display: str, extensions: Collection[str]) -> str:
    """Return how a display is shown elsewhere: VNC, FORWARDED; '' where nothing says that it is.

    :param display: the variable ``DISPLAY``
    :param extensions: those that the X server has
    """
    if _VNC_EXTENSION in extensions:
        return VNC
    match = _DISPLAY.match(display.strip())
    host = match.group('host').lower() if match else ''
    if host in _THIS_COMPUTER:
        return FORWARDED if match and int(match.group('number')) >= _FIRST_OF_SSH else ''
    return FORWARDED if host not in ('', 'unix') else ''
