# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The start time of this program, as seen by the process that waits for it."""
import os
import time

MAX_AGE_S = 5.0


def started_s():
    """Return when this process started [s, monotonic], before Python and its imports.

    Under ``rosrun`` that is the time of the command, since rosrun execs the program. So does a
    terminal's shell with ``exec``, which may be hours old: an age above ``MAX_AGE_S`` is ignored,
    as is an unreadable one (not on Linux).
    """
    now = time.monotonic()
    try:
        with open('/proc/self/stat', 'rb') as stat:
            # The program's name comes first, in brackets, and may contain anything.
            ticks = int(stat.read().rpartition(b')')[2].split()[19])
        age_s = time.clock_gettime(time.CLOCK_BOOTTIME) - ticks / os.sysconf('SC_CLK_TCK')
    except (OSError, AttributeError, LookupError, ValueError):
        return now
    return now - age_s if 0.0 <= age_s <= MAX_AGE_S else now
