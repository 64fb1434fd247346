# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which namespaces of a ROS graph are robots: the rules of "Look for Connected Bots"."""
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Optional, Tuple

from mhri.core.config import parse_yaml
from mhri.core.names import name_problem


@dataclass(frozen=True)
class IgnoreList:
    """What is never a robot: shell patterns (``*``, ``?``) of node names and of namespaces."""

    nodes: Tuple[str, ...] = ()
    namespaces: Tuple[str, ...] = ()

    def covers(self, node, namespace):
        """Tell whether a node (with leading slash) or its namespace (without) is ignored."""
        return (any(fnmatchcase(node, pattern) for pattern in self.nodes)
                or any(fnmatchcase(namespace, pattern) for pattern in self.namespaces))


@dataclass(frozen=True)
class Candidate:
    """A namespace that looks like a robot.

    ``robot_type`` is its parameter, None where it has none; ``nodes`` are the nodes registered
    under it, none where only its parameters are left; ``problem`` says why it cannot be added.
    """

    name: str
    robot_type: Optional[str] = None
    nodes: Tuple[str, ...] = ()
    problem: Optional[str] = None


def parse_ignore_list(text, origin):
    """Return the :class:`IgnoreList` of a YAML text.

    :raises ConfigError: names the file and the key that is wrong
    """
    section = parse_yaml(text, origin)
    ignore = IgnoreList(section.texts('nodes', ()), section.texts('namespaces', ()))
    section.close()
    return ignore


def nodes_of(system_state):
    """Return the names of all nodes in the answer of the master's ``getSystemState``, sorted."""
    return sorted({node for group in system_state for _, nodes in group for node in nodes})


def find_candidates(system_state, parameters, ignore, known=()):
    """Return the robots of a graph, sorted by name.

    A namespace is a robot if it has a ``robot_type``, or nodes under it that are neither ignored
    nor under a known robot. Nodes without a namespace (``/mux``) are never robots.

    :param system_state: publishers, subscribers, services as the master lists them
    :param parameters: all parameters as one nested dict
    :param ignore: :class:`IgnoreList`
    :param known: names of the robots that are in the list already; they are left out
    """
    members = {}
    for node in nodes_of(system_state):
        namespace, _, rest = node.lstrip('/').partition('/')
        if rest and not ignore.covers(node, namespace):
            members.setdefault(namespace, []).append(node)
    types = {name: str(value['robot_type']) for name, value in parameters.items()
             if isinstance(value, dict) and 'robot_type' in value}
    found = []
    for name in sorted(set(members) | set(types)):
        if name not in known and not ignore.covers('/' + name, name):
            found.append(Candidate(name, types.get(name), tuple(members.get(name, ())),
                                   name_problem(name)))
    return found
