# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parallel requests to many nodes, with a common time limit."""
import socket
import threading
import time
from urllib.parse import urlsplit

CONNECT_S = 0.3


class Answers:
    """Results of calls that may hang, each on its own thread.

    A thread that hangs, e.g. in a name server, is abandoned (daemon).
    """

    def __init__(self):
        self._lock = threading.Lock()
        self._answers = {}
        self._threads = []

    def ask(self, key, call, *words):
        """Start calling a function; return at once."""
        thread = threading.Thread(target=lambda: self.put(key, call(*words)), daemon=True)
        self._threads.append(thread)
        thread.start()

    def put(self, key, answer):
        """Store an answer, replacing an earlier one of the same key."""
        with self._lock:
            self._answers[key] = answer

    def by(self, deadline):
        """Return {key: answer} of the answers received by a deadline [s, monotonic]."""
        for thread in self._threads:
            thread.join(max(0.0, deadline - time.monotonic()))
        with self._lock:
            return dict(self._answers)


def connectable(uris, timeout_s=CONNECT_S):
    """Try to connect to many node URIs at once; return the set of those that accept.

    It never exceeds the time limit, not even because of a name server.
    """
    answers = Answers()
    for uri in set(uris):
        answers.ask(uri, _accepts, uri, timeout_s)
    found = answers.by(time.monotonic() + timeout_s + 0.1)
    return {uri for uri, accepts in found.items() if accepts}


def _accepts(uri, timeout_s):
    try:
        parts = urlsplit(uri)
        socket.create_connection((parts.hostname, parts.port), timeout_s).close()
    except (OSError, ValueError):
        return False
    return True
