# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The addresses of this computer."""
import socket

import psutil


def own_addresses():
    """Return the current IPv4 addresses of this computer's interfaces."""
    return tuple(entry.address for entries in psutil.net_if_addrs().values()
                 for entry in entries if entry.family == socket.AF_INET)
