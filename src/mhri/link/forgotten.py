# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a master that was restarted no longer knows of the nodes that live on.

Most nodes register once and never look back; who looks for them later, does not find them.
"""
from dataclasses import dataclass
from typing import Collection, Dict, List, Mapping, Sequence, Tuple

# Of getSystemState, in its order, with what registers each.
_METHODS = ('registerPublisher', 'registerSubscriber', 'registerService')
Rows = Sequence[Tuple[str, Sequence[str]]]


@dataclass(frozen=True)
class Known:
    """What a master knew.

    :param run: tells one run of the master from the next
    :param state: publishers, subscribers, services: [(name, nodes)] each, as getSystemState says
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


def registrations(known: Known, now: Known, alive: Collection[str], own: str
                  ) -> Dict[str, List[Tuple[str, ...]]]:
    """Return {node: calls of the master} that give a new master the nodes that it does not know.

    Subscribers come first, so that the master tells them of the publishers that follow. A node that
    the new master knows speaks for itself.

    :param alive: addresses that answer
    :param own: the node that asks, which registers itself
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
