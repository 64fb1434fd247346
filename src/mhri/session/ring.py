# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A ring of the last half minute in memory, to record the time before Record was pressed.

Messages are kept in the half-second chunks that are written to bags, so that keeping them costs no
more than writing them. The newest latched messages from before the ring's beginning are kept, too,
so that a bag can begin at any chunk.
"""
from collections import deque
from typing import Any, Deque, Dict, Iterator, List, NamedTuple, Tuple

# Publisher (with its ``fields``), receipt time [ns], frame.
Message = Tuple[Any, int, bytes]


class Chunk(NamedTuple):
    """One or more messages received in succession; ``size`` in bytes."""

    messages: List[Message]
    size: int

    @property
    def begun_ns(self) -> int:
        """The receipt time of the first message [ns]."""
        return self.messages[0][1]

    @property
    def ended_ns(self) -> int:
        """The receipt time of the last message [ns]."""
        return self.messages[-1][1]


class Latched:
    """The newest message of every latched publisher, as of one moment."""

    def __init__(self) -> None:
        self._newest: Dict[Any, bytes] = {}

    def update(self, chunk: Chunk) -> None:
        """Advance to the end of a chunk."""
        for publisher, _, frame in chunk.messages:
            if publisher.fields.get('latching') == '1':
                self._newest[publisher] = frame

    def forget(self, publisher: Any) -> None:
        """Drop a publisher that is gone."""
        self._newest.pop(publisher, None)

    def at(self, time_ns: int) -> List[Message]:
        """Return the first messages of a bag that begins at a time [ns]."""
        return [(publisher, time_ns, frame) for publisher, frame in self._newest.items()]


class Ring:
    """The newest chunks, limited in duration [s] and size [bytes].

    :param latched: updated with every chunk that leaves the ring, also on :meth:`take`
    """

    def __init__(self, lasts_s: float, most_bytes: int, latched: Latched) -> None:
        self._lasts_ns = round(lasts_s * 1e9)
        self._most_bytes = most_bytes
        self._latched = latched
        self._chunks: Deque[Chunk] = deque()
        #: current size [bytes]
        self.size = 0

    def put(self, chunk: Chunk) -> None:
        """Add a chunk; drop the oldest while a limit is exceeded."""
        self._chunks.append(chunk)
        self.size += chunk.size
        while self._chunks and (self.size > self._most_bytes or
                                chunk.ended_ns - self._chunks[0].begun_ns > self._lasts_ns):
            self._let_go()

    def _let_go(self) -> None:
        chunk = self._chunks.popleft()
        self.size -= chunk.size
        self._latched.update(chunk)

    def take(self) -> Iterator[Chunk]:
        """Yield and remove the chunks; each leaves the ring when the next one is requested."""
        while self._chunks:
            yield self._chunks[0]
            self._let_go()
