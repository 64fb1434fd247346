# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Examines links to robots with their own master: the endpoints, and the keys here."""
from dataclasses import replace
import os
import socket
import ssl
import threading

from mhri.doctor.facts import (
    ANSWERS, EARLY, KeysSeen, REFUSED, RUN_OUT, SILENT, UNRESOLVED, UNTIMELY, UNWELCOME)

# This file identifies the authority's own computer.
_AUTHORITY = '~/.config/mhri/authority/authority.pem'
_ASK_S = 0.8
_IMPORTING = threading.Lock()
# OpenSSL's verdict on the peer's certificate (X509_V_ERR_...), and the peer's on the own one.
_THEIRS = {9: EARLY, 10: RUN_OUT, 7: UNWELCOME, 19: UNWELCOME, 20: UNWELCOME, 21: UNWELCOME}
_OURS = (('CERTIFICATE_EXPIRED', UNTIMELY), ('UNKNOWN_CA', UNWELCOME), ('DECRYPT_ERROR', UNWELCOME))


def taken(connection, folder):
    """Return why peer or this computer rejects the other's key; :data:`ANSWERS` if accepted.

    :param connection: a socket connected to the peer, with a timeout
    :param folder: with the keys of this computer
    """
    own, its_key, authority = (os.path.join(folder, name)
                               for name in ('own.pem', 'own.key', 'authority.pem'))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    # Certificates contain the name of the robot, not its address.
    context.check_hostname = False
    try:
        context.load_cert_chain(own, its_key)
        context.load_verify_locations(authority)
        with context.wrap_socket(connection) as secured:
            # The peer rejects the own key only after the handshake.
            secured.recv(1)
    except ssl.SSLCertVerificationError as error:
        return _THEIRS.get(error.verify_code, ANSWERS)
    except ssl.SSLError as error:
        return next((found for words, found in _OURS if words in str(error.reason)), ANSWERS)
    except OSError:
        pass  # no alert in time: the peer accepted the key
    return ANSWERS


def _keys_there():
    """Return (the module of the keys, the folder with those of this computer or '')."""
    # Slow to import, so only if there are links. Locked: a second thread might get a partial one.
    with _IMPORTING:
        from mhri.link.ros import key_folder
    return key_folder, key_folder.find_folder(key_folder.AUTO) or ''


def ask_links(answers, notes, ask_s=_ASK_S):
    """Test the endpoints of silent links, and examine the keys; return at once.

    :param answers: :class:`mhri.graph.ros.parallel_calls.Answers`, which collects the results
    :param notes: each :class:`mhri.doctor.facts.LinkNote` of this computer
    :param ask_s: timeout of each endpoint [s]
    """
    for note in notes:
        if note.heard != 'yes':
            answers.ask(note.endpoint, _request, answers, note.endpoint, note.secret, ask_s)
    if notes:
        answers.ask(KeysSeen, _look_at_keys)


def linked_of(notes, found):
    """Return (notes with the responses of their endpoints, :class:`KeysSeen`).

    :param found: the results so far
    """
    keys = found.get(KeysSeen, KeysSeen())
    if keys.problem:
        # Robots reject the key for the same problem.
        found = {end: ANSWERS if answer == UNTIMELY else answer for end, answer in found.items()}
    return tuple(replace(note, reach=found.get(note.endpoint, '')) for note in notes), keys


def _request(answers, endpoint, secret, ask_s):
    host, _, port = endpoint.rpartition('/')[2].rpartition(':')
    try:
        with socket.create_connection((host.strip('[]'), int(port)), ask_s) as connection:
            # In case the test of the keys takes longer than the deadline.
            answers.put(endpoint, ANSWERS)
            folder = _keys_there()[1] if secret else None
            return taken(connection, folder) if folder else ANSWERS
    except ConnectionRefusedError:
        return REFUSED
    except (socket.gaierror, UnicodeError):
        return UNRESOLVED
    except (OSError, OverflowError, ValueError):
        return SILENT


def _look_at_keys():
    key_folder, folder = _keys_there()
    problem = cause = ''
    authority = os.path.exists(os.path.expanduser(_AUTHORITY)) and not folder
    if folder:
        try:
            key_folder.KeyFolder(folder, 'host', '').read()
        except key_folder.KeysError as error:
            problem, cause = str(error), error.cause
        except OSError as error:
            problem = str(error)
    return KeysSeen(folder, problem, authority, cause)
