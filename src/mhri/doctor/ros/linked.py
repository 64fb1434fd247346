# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor looks at links to robots on masters of their own: their ends, and the keys here."""
from dataclasses import replace
import os
import socket
import ssl
import threading
import time

from mhri.doctor.facts import (
    ANSWERS, EARLY, KeysSeen, REFUSED, RUN_OUT, SILENT, UNRESOLVED, UNTIMELY, UNWELCOME)

# Through which the authority's own computer is known.
_AUTHORITY = '~/.config/mhri/authority/authority.pem'
_ASK_S = 0.8
_IMPORTING = threading.Lock()
# What OpenSSL says of another end's certificate (X509_V_ERR_...), and that end of the own one.
_THEIRS = {9: EARLY, 10: RUN_OUT, 7: UNWELCOME, 19: UNWELCOME, 20: UNWELCOME, 21: UNWELCOME}
_OURS = (('CERTIFICATE_EXPIRED', UNTIMELY), ('UNKNOWN_CA', UNWELCOME), ('DECRYPT_ERROR', UNWELCOME))


def taken(connection, folder):
    """Return how another end takes the key here, and this one its key; :data:`ANSWERS` for well.

    :param connection: a socket that is connected to it, with a timeout
    :param folder: with the keys of this computer
    """
    own, its_key, authority = (os.path.join(folder, name)
                               for name in ('own.pem', 'own.key', 'authority.pem'))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    # The name in a certificate is that of the robot, not its address.
    context.check_hostname = False
    try:
        context.load_cert_chain(own, its_key)
        context.load_verify_locations(authority)
        with context.wrap_socket(connection) as secured:
            # Whether the key here is taken comes a moment later.
            secured.recv(1)
    except ssl.SSLCertVerificationError as error:
        return _THEIRS.get(error.verify_code, ANSWERS)
    except ssl.SSLError as error:
        return next((found for words, found in _OURS if words in str(error.reason)), ANSWERS)
    except OSError:
        pass  # it says nothing: it waits for us
    return ANSWERS


def _keys_there():
    """Return (the module of the keys, the folder with those of this computer or '')."""
    # Slow to import: only where there are links. Not by two threads at once: one might get half.
    with _IMPORTING:
        from mhri.link.ros import key_folder
    return key_folder, key_folder.find_folder(key_folder.AUTO) or ''


class LinkLook:
    """Asks the ends of the links that hear nobody, and looks at the keys; returns at once.

    :param notes: the :class:`mhri.doctor.facts.LinkNote` of this computer
    :param ask_s: how long each may take to answer [s]
    """

    def __init__(self, notes, ask_s=_ASK_S):
        self._notes, self._ask_s = list(notes), ask_s
        self._reach, self._keys, self._threads = {}, KeysSeen(), []
        for note in self._notes:
            if note.heard != 'yes' and note.endpoint.partition('/')[0] not in ('udp', 'quic'):
                self._start(self._knock, note.endpoint, note.secret)
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
        if self._keys.problem:
            # Then that is what the robots say.
            reach.update({end: ANSWERS for end, found in reach.items() if found == UNTIMELY})
        return tuple(replace(note, reach=reach.get(note.endpoint, '')) for note in self._notes), \
            self._keys

    def _knock(self, endpoint, secret):
        host, _, port = endpoint.rpartition('/')[2].rpartition(':')
        try:
            with socket.create_connection((host.strip('[]'), int(port)), self._ask_s) as connection:
                self._reach[endpoint] = ANSWERS
                folder = _keys_there()[1] if secret else None
                if folder:
                    self._reach[endpoint] = taken(connection, folder)
        except ConnectionRefusedError:
            self._reach[endpoint] = REFUSED
        except (socket.gaierror, UnicodeError):
            self._reach[endpoint] = UNRESOLVED
        except (OSError, OverflowError, ValueError):
            self._reach[endpoint] = SILENT

    def _look_at_keys(self):
        key_folder, folder = _keys_there()
        problem = ''
        authority = os.path.exists(os.path.expanduser(_AUTHORITY)) and not folder
        if folder:
            try:
                key_folder.KeyFolder(folder, 'host', '').read()
            except (key_folder.KeysError, OSError) as error:
                problem = str(error)
        self._keys = KeysSeen(folder, problem, authority)
