# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS graph asked for robots: one question to the master, then a knock at each door."""
import socket
import threading
import time
from dataclasses import dataclass
from typing import Tuple
from urllib.parse import urlsplit

from mhri.core.discovery import find_candidates
from mhri.ros.master_api import MasterApi

KNOCK_S = 0.3
NODES_EACH = 3


@dataclass(frozen=True)
class Found:
    """The result of looking for robots.

    ``live`` are candidates of which a node answers; ``leftovers`` are registered, but nothing
    answers (crashed, switched off, out of reach) or only parameters are left; ``refused`` have
    names that no robot can have. ``parameters`` is {namespace: nested dict} of all of them.
    """

    live: Tuple = ()
    leftovers: Tuple = ()
    refused: Tuple = ()
    parameters: dict = None
    took_s: float = 0.0


def knock(uris, timeout_s=KNOCK_S):
    """Try to connect to many node URIs at once; return the set of those that accept.

    Nobody is waited for beyond the time limit, not even a name server: a thread that hangs in one
    is left behind (daemon).
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


def look_for_robots(caller_id, ignore, known=(), api=None):
    """Look for robots (blocking; never on the GUI thread).

    The master is asked once for its whole state and all parameters, in one request, and once more
    for the addresses of the robots found, again in one request.

    :param ignore: :class:`mhri.core.discovery.IgnoreList`
    :param known: robots that are in the list already
    :param api: the :class:`MasterApi` to ask, default that of ``ROS_MASTER_URI``
    :returns: :class:`Found`
    :raises MasterError: the master cannot be reached
    """
    begun = time.monotonic()
    api = api or MasterApi(caller_id, timeout_s=5.0)
    state, parameters = api.call_many([('getSystemState',), ('getParam', '/')])
    candidates = find_candidates(state or [], parameters or {}, ignore, known)
    asked = [(candidate, node) for candidate in candidates
             for node in candidate.nodes[:NODES_EACH] if candidate.problem is None]
    uris = api.call_many([('lookupNode', node) for _, node in asked]) if asked else []
    answered = knock([uri for uri in uris if uri])
    alive = {candidate.name for (candidate, _), uri in zip(asked, uris) if uri in answered}
    return Found(
        live=tuple(item for item in candidates if item.name in alive),
        leftovers=tuple(item for item in candidates
                        if item.problem is None and item.name not in alive),
        refused=tuple(item for item in candidates if item.problem),
        parameters={item.name: (parameters or {}).get(item.name, {}) for item in candidates},
        took_s=time.monotonic() - begun)


def robot_parameters(caller_id, names):
    """Return {name: parameters below its namespace as a nested dict}, asked in one request.

    A robot that has none has {}.

    :raises MasterError: the master cannot be reached
    """
    names = list(names)
    values = MasterApi(caller_id, timeout_s=2.0).call_many(
        [('getParam', '/' + name) for name in names]) if names else []
    return {name: value if isinstance(value, dict) else {} for name, value in zip(names, values)}
