# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The registrations that a ROS master loses if it restarts while its nodes keep running.

Most nodes register only once, so nodes that start later would not find them.
"""
from dataclasses import dataclass
from typing import Collection, Dict, List, Mapping, Sequence, Tuple

# The calls that register each part of getSystemState, in its order.
_METHODS = ('registerPublisher', 'registerSubscriber', 'registerService')
Rows = Sequence[Tuple[str, Sequence[str]]]


@dataclass(frozen=True)
class MasterState:
    """The registrations of a master.

    :param run: identifies one run of the master
    :param state: publishers, subscribers, services: [(name, nodes)] each, from getSystemState
    :param types: {topic: type}
    :param uris: {node: its address}, {service: its address}
    """

    run: object
    state: Sequence[Rows]
    types: Mapping[str, str]
    uris: Mapping[str, str]

    def nodes(self) -> List[str]:
        """Return the names of all nodes."""
        return sorted({node for rows in self.state for _, nodes in rows for node in nodes})


def registrations(known: MasterState, now: MasterState, alive: Collection[str], own: str
                  ) -> Dict[str, List[Tuple[str, ...]]]:
    """Return {node: master calls} that register the nodes that a new master has lost.

    Subscribers come first, so that the master informs them of the publishers that follow. Nodes
    listed by the new master have registered themselves.

    :param alive: responding addresses
    :param own: the calling node, which registers itself
    """
    spoken = set(now.nodes()) | {own}
    calls: Dict[str, List[Tuple[str, ...]]] = {}
    for number in (1, 0, 2):
        for name, nodes in known.state[number]:
            for node in nodes:
                uri = known.uris.get(node, '')
                if node in spoken or not uri or uri not in alive:
                    continue
                row = (_METHODS[number], name, known.types.get(name, '*'), uri)
                if number == 2:
                    row = (_METHODS[number], name, known.uris.get(name, ''), uri)
                calls.setdefault(node, []).append(row)
    return calls
