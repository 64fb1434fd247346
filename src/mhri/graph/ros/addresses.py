# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The addresses of this computer."""
import netifaces


def own_addresses():
    """Return the current IPv4 addresses of this computer's interfaces."""
    found = []
    for interface in netifaces.interfaces():
        try:
            entries = netifaces.ifaddresses(interface).get(netifaces.AF_INET, ())
        except ValueError:  # the interface has disappeared
            continue
        found += [entry['addr'] for entry in entries if 'addr' in entry]
    return tuple(found)
