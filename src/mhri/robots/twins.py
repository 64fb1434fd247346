# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether two computers are one robot: both would be driven at once, each on its own way."""
from typing import Collection, Dict, Iterable, Mapping, Optional, Set

# Two guards are told apart within this time [s]: each echoes ten times a second.
TURNS_S = 2.0


def twins(odometry: Iterable[Mapping[str, str]], listeners: Mapping[str, str]) -> Set[str]:
    """Return the nodes, or network addresses, that are a robot each; empty for at most one.

    A base tells of its motion and reads its commands. So these are the nodes that publish one and
    the same topic of odometry and read velocity; or, where several nodes are one robot, the
    computers that do. A recorder, a player, a screen, or a robot's second computer does one of it
    at most.

    :param odometry: for each topic {caller id: network address} of its publishers
    :param listeners: {caller id: network address} of the nodes that read velocity
    """
    for publishers in odometry:
        nodes = set(publishers) & set(listeners)
        hosts = set(publishers.values()) & set(listeners.values())
        for found in (nodes, hosts):
            if len(found) > 1:
                return found
    return set()


class GuardTurns:
    """Notices two guards that echo in turn; times are [s] of a clock that never goes back.

    A guard that was started anew has another run in its tokens, and the old one never comes back.
    """

    def __init__(self) -> None:
        self._heard_at: Dict[str, float] = {}
        self._last = ''
        self._turned_at: Optional[float] = None

    def on_token(self, token: str, now: float) -> None:
        """Take in the token of an echo, ``<run>-<number>``."""
        run = token.partition('-')[0]
        if run != self._last and now - self._heard_at.get(run, -TURNS_S) < TURNS_S:
            self._turned_at = now
        if len(self._heard_at) > 100:
            self._heard_at.clear()
        self._last, self._heard_at[run] = run, now

    def two(self, now: float) -> bool:
        """Tell whether two guards have echoed in turn just now."""
        return self._turned_at is not None and now - self._turned_at < TURNS_S


def listed(names: Collection[str]) -> str:
    """Return some names as words."""
    return ' and '.join(sorted(names)[:4])
