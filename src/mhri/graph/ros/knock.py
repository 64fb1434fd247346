# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether nodes answer at all."""
import socket
import threading
import time
from urllib.parse import urlsplit

KNOCK_S = 0.3


def knock(uris, timeout_s=KNOCK_S):
    """Try to connect to many node URIs at once; return the set of those that accept.

    It waits for nobody beyond the time limit, not even a name server: it leaves a thread that hangs
    in one behind (daemon).
    """
    answered, lock, threads = set(), threading.Lock(), []

    def one(uri):
        """Try one address."""
        try:
            parts = urlsplit(uri)
            socket.create_connection((parts.hostname, parts.port), timeout_s).close()
        except (OSError, ValueError):
            return
        with lock:
            answered.add(uri)

    for uri in set(uris):
        thread = threading.Thread(target=one, args=(uri,), daemon=True)
        thread.start()
        threads.append(thread)
    deadline = time.monotonic() + timeout_s + 0.1
    for thread in threads:
        thread.join(max(0.0, deadline - time.monotonic()))
    with lock:
        return set(answered)
