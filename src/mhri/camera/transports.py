# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The choice among a camera's topics: compressed first, raw if there is nothing else."""
import math
from typing import Iterable, List, Mapping, NamedTuple, Optional, Set, Tuple

from mhri.camera.image_message import COMPRESSED_TYPE, RAW_TYPE
from mhri.camera.images import DEPTH, RGB

#: topic on which a screen relays the pictures that it receives, as ``mhri/SeenPicture``
PICTURES = '/panel/pictures'
# The first picture of a topic comes within this time [s], else the next best one is received; one
# that sent pictures may pause for longer: a raw picture takes fifty times the bandwidth.
FIRST_S, SILENT_S = 1.8, 10.0
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


class Speakers:
    """Chooses the best offer of a camera that sends pictures.

    An advertised topic need not: image_transport advertises ``/compressed`` beside every picture,
    also of an encoding that it cannot compress. Times are [s] of a monotonic clock.
    """

    def __init__(self) -> None:
        self._silent: Set[str] = set()
        self._held, self._due = '', math.inf

    def hold(self, topic: str, now: float) -> None:
        """Handle that a topic is received from now on."""
        self._held, self._due = topic, now + FIRST_S

    def heard(self, topic: str, now: float) -> None:
        """Handle that a topic sends pictures."""
        self._silent.discard(topic)
        if topic == self._held:
            self._due = now + SILENT_S

    def skip(self, topic: str) -> None:
        """Handle that a topic cannot be received."""
        self._silent.add(topic)

    def choose(self, offers: Iterable[Offer], transport: str,
               now: float) -> Tuple[Optional[Offer], List[Offer]]:
        """Return (the offer to receive or None, the better ones, which are silent).

        :param transport: name of the wanted one, or 'auto'
        """
        if now >= self._due:
            self._silent.add(self._held)
        possible = [offer for offer in offers if transport in (AUTO, offer.transport)]
        for number, offer in enumerate(possible):
            if offer.topic not in self._silent or number == len(possible) - 1:
                return offer, possible[:number]
        return None, []


def may_carry(kind: str, transport: str, topic: str) -> bool:
    """Return whether a full topic belongs to a transport ('auto': to any)."""
    if transport == AUTO:
        return True
    endings = {name: ending for name, ending, _ in _TRANSPORTS[kind]}
    if endings.get(transport):
        return topic.endswith(endings[transport])
    return not topic.endswith(tuple(ending for ending in endings.values() if ending))
