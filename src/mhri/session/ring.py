# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The last half minute, kept in memory: what came before somebody pressed Record.

Messages are kept in chunks of half a second as they go to a bag, so that to keep them costs no more
than to write them. With the newest latched messages from before the ring's beginning, a bag can
begin at any chunk.
"""
from collections import deque
from typing import Any, Deque, Dict, Iterator, List, NamedTuple, Tuple

# Publisher (with its ``fields``), receipt time [ns], frame.
Message = Tuple[Any, int, bytes]


class Chunk(NamedTuple):
    """Messages that were received one after the other, at least one; ``size`` in bytes."""

    messages: List[Message]
    size: int

    @property
    def begun_ns(self) -> int:
        """When the first was received [ns]."""
        return self.messages[0][1]

    @property
    def ended_ns(self) -> int:
        """When the last was received [ns]."""
        return self.messages[-1][1]


class Latched:
    """The newest message of every latched publisher, as of some moment."""

    def __init__(self) -> None:
        self._newest: Dict[Any, bytes] = {}

    def see(self, chunk: Chunk) -> None:
        """Go on to the end of a chunk."""
        for publisher, _, frame in chunk.messages:
            if publisher.fields.get('latching') == '1':
                self._newest[publisher] = frame

    def forget(self, publisher: Any) -> None:
        """Leave out a publisher that is of no concern any more."""
        self._newest.pop(publisher, None)

    def at(self, time_ns: int) -> List[Message]:
        """Return what a bag that begins at a time [ns] has to begin with."""
        return [(publisher, time_ns, frame) for publisher, frame in self._newest.items()]


class Ring:
    """The newest chunks, at most so long [s] and so large [bytes].

    :param latched: told of every chunk that leaves the ring, also on :meth:`take`
    """

    def __init__(self, lasts_s: float, most_bytes: int, latched: Latched) -> None:
        self._lasts_ns = round(lasts_s * 1e9)
        self._most_bytes = most_bytes
        self._latched = latched
        self._chunks: Deque[Chunk] = deque()
        #: how many bytes it keeps
        self.size = 0

    def put(self, chunk: Chunk) -> None:
        """Keep a chunk, and let go what is too old or too much."""
        self._chunks.append(chunk)
        self.size += chunk.size
        while self._chunks and (self.size > self._most_bytes or
                                chunk.ended_ns - self._chunks[0].begun_ns > self._lasts_ns):
            self._let_go()

    def _let_go(self) -> None:
        chunk = self._chunks.popleft()
        self.size -= chunk.size
        self._latched.see(chunk)

    def take(self) -> Iterator[Chunk]:
        """Yield its chunks, and empty it; each has left the ring when the next one is asked for."""
        while self._chunks:
            yield self._chunks[0]
            self._let_go()
