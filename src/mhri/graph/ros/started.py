# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""When this program was started, from the view of whoever waits for it."""
import os
import time

BELIEVED_S = 5.0


def started_s():
    """Return when this process began [s, monotonic], before Python and all it imports.

    Under ``rosrun`` that is the moment of the command, since rosrun becomes the program. So does a
    terminal's shell with ``exec``, which may be hours old: an age over ``BELIEVED_S`` counts as
    none, and so does an unreadable one (not on Linux).
    """
    now = time.monotonic()
    try:
        with open('/proc/self/stat', 'rb') as stat:
            # The program's name comes first, in brackets, and may contain anything.
            ticks = int(stat.read().rpartition(b')')[2].split()[19])
        age_s = time.clock_gettime(time.CLOCK_BOOTTIME) - ticks / os.sysconf('SC_CLK_TCK')
    except (OSError, AttributeError, LookupError, ValueError):
        return now
    return now - age_s if 0.0 <= age_s <= BELIEVED_S else now
