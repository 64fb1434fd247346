# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The choice among a camera's topics: compressed first, raw if there is nothing else."""
from typing import Iterable, List, Mapping, NamedTuple, Optional

from mhri.camera.image_message import COMPRESSED_TYPE, RAW_TYPE
from mhri.camera.images import DEPTH, RGB

#: topic on which a screen relays the pictures that it receives, as ``mhri/SeenPicture``
PICTURES = '/panel/pictures'
AUTO = 'auto'
RAW = 'raw'
# For each kind of picture: (name, suffix of the topic by image_transport, type), best first.
_TRANSPORTS = {
    RGB: (('compressed', '/compressed', COMPRESSED_TYPE), (RAW, '', RAW_TYPE)),
    DEPTH: (('compressedDepth', '/compressedDepth', COMPRESSED_TYPE), (RAW, '', RAW_TYPE)),
}


class Offer(NamedTuple):
    """A transport of a camera's picture: its name and the full topic."""

    transport: str
    topic: str


def find_offers(kind: str, topics: Iterable[str], published: Mapping[str, str]) -> List[Offer]:
    """Return the :class:`Offer` list of a camera, best first.

    A topic whose type does not match its name is left out.

    :param kind: 'rgb' or 'depth'
    :param topics: the camera's full topics in order of preference, without transport
    :param published: {topic: type} of all published topics
    """
    return [Offer(transport, topic + ending) for topic in topics
            for transport, ending, message_type in _TRANSPORTS[kind]
            if published.get(topic + ending) == message_type]


def choose_offer(offers: Iterable[Offer], transport: str) -> Optional[Offer]:
    """Return the best offer of a transport ('auto': of any), or None."""
    return next((offer for offer in offers if transport in (AUTO, offer.transport)), None)


def may_carry(kind: str, transport: str, topic: str) -> bool:
    """Return whether a full topic belongs to a transport ('auto': to any)."""
    if transport == AUTO:
        return True
    endings = {name: ending for name, ending, _ in _TRANSPORTS[kind]}
    if endings.get(transport):
        return topic.endswith(endings[transport])
    return not topic.endswith(tuple(ending for ending in endings.values() if ending))
