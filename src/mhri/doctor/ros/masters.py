# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds other masters than the configured one: those of programs on this computer."""
import os
import time
from urllib.parse import urlsplit

import psutil

from mhri.doctor.facts import Master, SILENT
from mhri.doctor.system import MODE
from mhri.graph.ros.parallel_calls import Answers, connectable
from mhri.graph.ros.master_api import DEFAULT_PORT, MasterApi, MasterError, uri_problem

LIMIT_S = 0.3
MOST = 16
_PROGRAMS = ('rosmaster', 'roscore', 'roslaunch')
_PORT = ('-p', '--port')


def parse_uri(uri):
    """Return the :class:`Master` of a URI, with the problem of an invalid URI."""
    problem = uri_problem(uri)
    if problem:
        return Master(uri, '', 0, SILENT, uri_problem=problem)
    parts = urlsplit(uri)
    return Master(uri, parts.hostname, parts.port)


def uris_in_use():
    """Return the master URIs of the programs on this computer.

    Of other users' programs only masters are visible, and only if their port is an argument.
    """
    found = set()
    for process in psutil.process_iter(['cmdline', 'environ']):
        uri = (process.info['environ'] or {}).get('ROS_MASTER_URI')
        if uri is not None:
            # The environment of a program may hold any bytes.
            found.add(uri.encode('utf-8', 'replace').decode('utf-8'))
        words = process.info['cmdline'] or ()
        if any(os.path.basename(word) in _PROGRAMS for word in words[:2]):
            found.update('http://localhost:{}'.format(port) for flag, port in zip(words, words[1:])
                         if flag in _PORT and port.isdecimal())
    return found


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
    """Return the URIs of other responding masters, those with a mux first (blocking, 0.4 s).

    The candidates are the masters of programs on this computer, and one at the default port.

    :param master: the unsuitable :class:`Master`
    :param computer: :class:`mhri.doctor.facts.Computer`
    :param only_with_mux: whether to drop those without a mux
    :param uris: the URIs to query, default those in use
    """
    answers = Answers()
    for uri in _others(master, computer, uris_in_use() if uris is None else uris):
        answers.ask(uri, _has_mux, uri, caller_id)
    found = {uri: has_mux for uri, has_mux in answers.by(
        time.monotonic() + LIMIT_S + 0.1).items() if has_mux is not None}
    return tuple(sorted((uri for uri in found if found[uri] or not only_with_mux),
                        key=lambda uri: (not found[uri], uri)))


def _has_mux(uri, caller_id):
    """Return whether a master has a running mux, None if no master responds."""
    try:
        muxes = MasterApi(caller_id, LIMIT_S, uri).publisher_uris(MODE)
    except (MasterError, ValueError, TypeError):
        return None
    return bool(connectable(muxes, LIMIT_S))
