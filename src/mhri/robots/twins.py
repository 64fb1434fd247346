# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detects two computers under one robot name, which would both be driven at once."""
from typing import Collection, Dict, Iterable, Mapping, Optional, Set, Tuple

from mhri.robots.discovery import is_measured

# Two guards are detected within this time [s]: each echoes ten times a second.
TURNS_S = 2.0


def twins(odometry: Iterable[Mapping[str, str]], listeners: Mapping[str, str]) -> Set[str]:
    """Return the nodes, or network addresses, that are a robot each; empty for at most one.

    The base of a robot publishes odometry and subscribes velocity. So these are the nodes that
    publish the same odometry topic and subscribe velocity; or, if a robot has several nodes, the
    computers that do. A recorder, a player, a screen, or a second computer of a robot does only
    one of the two.

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


def twins_on_graph(robot: str, published: Iterable[Tuple[str, Iterable[str]]],
                   kinds: Mapping[str, str], nodes: Collection[str]) -> Set[str]:
    """Return the nodes that are a robot each, found without its odometry; empty for at most one.

    :param published: (topic, its publishers) of the whole graph
    :param kinds: {topic: ROS type}
    :param nodes: the nodes that read its velocity
    """
    return twins(({name: name for name in names} for topic, names in published
                  if topic.startswith('/{}/'.format(robot)) and is_measured(kinds.get(topic, ''))),
                 {name: name for name in nodes})


class GuardTurns:
    """Detects two guards that echo in turn; times are [s] of a monotonic clock.

    A restarted guard has a new run in its tokens, and the old run never returns.
    """

    def __init__(self) -> None:
        self._heard_at: Dict[str, float] = {}
        self._last = ''
        self._turned_at: Optional[float] = None

    def on_token(self, token: str, now: float) -> None:
        """Handle the token of an echo, ``<run>-<number>``."""
        run = token.partition('-')[0]
        if run != self._last and now - self._heard_at.get(run, -TURNS_S) < TURNS_S:
            self._turned_at = now
        if len(self._heard_at) > 100:
            self._heard_at.clear()
        self._last, self._heard_at[run] = run, now

    def two(self, now: float) -> bool:
        """Return whether two guards have echoed in turn recently."""
        return self._turned_at is not None and now - self._turned_at < TURNS_S


def listed(names: Collection[str]) -> str:
    """Return some names as words."""
    return ' and '.join(sorted(names)[:4])
