# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The clock of the link."""
import time


def boot_clock():
    """Return the seconds of a monotonic clock that includes suspend."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)
