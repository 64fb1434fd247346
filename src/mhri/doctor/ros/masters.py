# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor looks for other masters than the configured one: those that programs here use."""
import glob
import os
import threading
import time
from urllib.parse import urlsplit

from mhri.doctor.facts import Master, SILENT
from mhri.doctor.system import MODE
from mhri.graph.ros.knock import knock
from mhri.graph.ros.master_api import MasterApi, MasterError

DEFAULT_PORT = 11311
LIMIT_S = 0.3
MOST = 16
_VARIABLE = b'ROS_MASTER_URI='
_PROGRAMS = (b'rosmaster', b'roscore', b'roslaunch')
_PORT = (b'-p', b'--port')


def parse_uri(uri):
    """Return the :class:`Master` of a URI, with the URI's problem."""
    try:
        parts = urlsplit(uri.strip())
        host, port = parts.hostname or '', parts.port
    except ValueError as error:
        return Master(uri, '', 0, SILENT, uri_problem=str(error))
    if parts.scheme != 'http' or not host or uri != uri.strip():
        return Master(uri, host, port or 0, SILENT, uri_problem='it has the form '
                      'http://<address>:{}'.format(DEFAULT_PORT))
    if port is None:
        return Master(uri, host, 0, SILENT, uri_problem='it names no port; the usual one is '
                      '{}'.format(DEFAULT_PORT))
    return Master(uri, host, port)


def uris_in_use(folder='/proc'):
    """Return the master URIs that programs on this computer were started with.

    Of other users' programs it sees only masters, and only if their port is an argument.

    :param folder: where the kernel lists processes; only Linux has one
    """
    found = {}
    for path in glob.glob(os.path.join(folder, '[0-9]*')):
        for line in _words(path, 'environ'):
            if line.startswith(_VARIABLE):
                found[line[len(_VARIABLE):].decode('utf-8', 'replace')] = True
        words = _words(path, 'cmdline')
        if any(os.path.basename(word) in _PROGRAMS for word in words[:2]):
            found.update(('http://localhost:{}'.format(port.decode()), True)
                         for flag, port in zip(words, words[1:])
                         if flag in _PORT and port.isdigit())
    return list(found)


def _words(path, name):
    """Return a process's arguments or environment, [] if it is another user's, or has ended."""
    try:
        with open(os.path.join(path, name), 'rb') as file:
            return file.read().split(b'\0')
    except OSError:
        return []


def _others(master, computer, uris):
    """Return the URIs of other masters, each master once."""
    def key(item):
        return ('' if computer.is_own(item.host) else item.host, item.port)

    found = {key(master): ''}
    usual = ['http://{}:{}'.format(host, DEFAULT_PORT)
             for host in (master.host, 'localhost') if host]
    for uri in sorted(uris) + usual:
        other = parse_uri(uri)
        if not other.uri_problem:
            found.setdefault(key(other), uri.rstrip('/'))
    return [uri for uri in found.values() if uri][:MOST]


def look_elsewhere(master, computer, caller_id, only_with_mux=False, uris=None):
    """Return the URIs of other masters that answer, those with a mux first (blocking, 0.4 s).

    It tries those that programs on this computer use, and one at the usual port.

    :param master: the :class:`Master` that did not serve
    :param computer: :class:`mhri.doctor.facts.Computer`
    :param only_with_mux: leave out those without a mux
    :param uris: the URIs to ask, default those in use
    """
    answers, threads = {}, []

    def ask(uri):
        """Note whether a master has a running mux; nothing if no master answers."""
        try:
            api = MasterApi(caller_id, LIMIT_S, uri)
            muxes = dict(api.call('getSystemState')[0]).get(MODE, ())
            nodes = api.call_many([('lookupNode', name) for name in muxes]) if muxes else []
        except (MasterError, ValueError, TypeError):
            return
        answers[uri] = bool(knock([node for node in nodes if node], LIMIT_S))

    for uri in _others(master, computer, uris_in_use() if uris is None else uris):
        threads.append(threading.Thread(target=ask, args=(uri,), daemon=True))
        threads[-1].start()
    deadline = time.monotonic() + LIMIT_S + 0.1
    for thread in threads:
        thread.join(max(0.0, deadline - time.monotonic()))
    found = dict(answers)
    return tuple(sorted((uri for uri in found if found[uri] or not only_with_mux),
                        key=lambda uri: (not found[uri], uri)))
