# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detection of a display shown on another computer, where the release of a key may arrive late.

When the connection of such a display freezes, no release arrives, and the X server of VNC keeps
reporting the key as down. But the repeats of a held key come over the connection: the server of VNC
generates none itself.
"""
import re
from typing import Collection

#: How long a held key or stick counts without a sign of life [s]; the first repeat of a key takes
#: 0.2 to 0.7 s on common desktops.
HELD_S = 1.0

VNC, FORWARDED = 'VNC', 'forwarded X'
_VNC_EXTENSION = 'VNC-EXTENSION'
# "host:10.0", "tcp/host:0", "[::1]:10"; a path is a socket of this computer (macOS).
_DISPLAY = re.compile(r'(?:[a-z0-9]+/)?(?P<host>[^/]*):(?P<number>\d+)(?:\.\d+)?$')
_THIS_COMPUTER = ('localhost', '127.0.0.1', '[::1]', '::1')
# The first display that ssh forwards.
_FIRST_OF_SSH = 10


def remote_kind(display: str, extensions: Collection[str]) -> str:
    """Return the kind of a remote display: VNC or FORWARDED; '' without a sign of one.

    :param display: the variable ``DISPLAY``
    :param extensions: the extensions of the X server
    """
    if _VNC_EXTENSION in extensions:
        return VNC
    match = _DISPLAY.match(display.strip())
    host = match.group('host').lower() if match else ''
    if host in _THIS_COMPUTER:
        return FORWARDED if match and int(match.group('number')) >= _FIRST_OF_SSH else ''
    return FORWARDED if host not in ('', 'unix') else ''
