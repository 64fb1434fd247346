# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor looks at links to robots on masters of their own: their ends, and the keys here."""
from dataclasses import replace
import os
import socket
import threading
import time

from mhri.core.doctor.facts import ANSWERS, KeysSeen, REFUSED, SILENT, UNRESOLVED

# Through which the authority's own computer is known.
_AUTHORITY = '~/.config/mhri/authority/authority.pem'
_ASK_S = 0.8


class LinkLook:
    """Asks the ends of the links that hear nobody, and looks at the keys; returns at once.

    :param notes: the :class:`mhri.core.doctor.facts.LinkNote` of this computer
    """

    def __init__(self, notes):
        self._notes = list(notes)
        self._reach, self._keys, self._threads = {}, KeysSeen(), []
        for note in self._notes:
            if note.heard != 'yes' and note.endpoint.partition('/')[0] not in ('udp', 'quic'):
                self._start(self._knock, note.endpoint)
        if self._notes:
            self._start(self._look_at_keys)

    def _start(self, call, *words):
        self._threads.append(threading.Thread(target=call, args=words, daemon=True))
        self._threads[-1].start()

    def result(self, deadline):
        """Return (notes with how their ends answer, :class:`KeysSeen`).

        :param deadline: until when to wait for answers [s, monotonic]
        """
        for thread in self._threads:
            thread.join(max(0.0, deadline - time.monotonic()))
        reach = dict(self._reach)
        return tuple(replace(note, reach=reach.get(note.endpoint, '')) for note in self._notes), \
            self._keys

    def _knock(self, endpoint):
        host, _, port = endpoint.rpartition('/')[2].rpartition(':')
        try:
            socket.create_connection((host.strip('[]'), int(port)), _ASK_S).close()
            self._reach[endpoint] = ANSWERS
        except ConnectionRefusedError:
            self._reach[endpoint] = REFUSED
        except (socket.gaierror, UnicodeError):
            self._reach[endpoint] = UNRESOLVED
        except (OSError, OverflowError, ValueError):
            self._reach[endpoint] = SILENT

    def _look_at_keys(self):
        # Slow to import: only where there are links.
        from mhri.core.link.keys import KeysError
        from mhri.ros.link.key_folder import AUTO, find_folder, KeyFolder
        folder, problem = find_folder(AUTO) or '', ''
        authority = os.path.exists(os.path.expanduser(_AUTHORITY)) and not folder
        if folder:
            try:
                KeyFolder(folder, 'host', '').read()
            except (KeysError, OSError) as error:
                problem = str(error)
        self._keys = KeysSeen(folder, problem, authority)
