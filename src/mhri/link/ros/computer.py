# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tells this computer from another one of its name, for a link without keys."""
import os

import rosgraph

_NETWORK = '/sys/class/net'
_MACHINE = '/etc/machine-id'


def facts(network=_NETWORK, machine=_MACHINE, uri=None):
    """Return what stays the same here while the link is started again, and nowhere else.

    Copies of one disk have the same machine-id, so the addresses of the network cards count, too;
    and so does the master, since a computer may have several. What cannot be read is left out.

    :param uri: of the master, by default that of this process
    """
    return [_text(machine), rosgraph.get_master_uri() if uri is None else uri, *_cards(network)]


def _cards(folder):
    """Return the addresses of the cards that stay: wired before radio, whose address may change."""
    try:
        names = [name for name in sorted(os.listdir(folder)) if name != 'lo']
    except OSError:
        return []
    real = [name for name in names if os.path.exists(os.path.join(folder, name, 'device'))]
    wired = [name for name in real if not os.path.exists(os.path.join(folder, name, 'phy80211'))]
    return sorted(_text(os.path.join(folder, name, 'address')) for name in wired or real or names)


def _text(path):
    try:
        with open(path, encoding='ascii', errors='replace') as file:
            return file.read(1000).strip()
    except OSError:
        return ''
