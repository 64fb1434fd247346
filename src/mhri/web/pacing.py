# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which pictures one viewer gets: the newest, no more than it draws, each robot in turn."""
from typing import Callable, Dict, List, Optional, Tuple

RATE_HZ, LOOKED_AT_HZ = 5.0, 15.0
# Pictures of one topic that are sent and not yet drawn, and bytes of all of them.
MAX_UNACKED, MAX_UNACKED_BYTES = 2, 1 << 20


class Pacing:
    """The pictures on their way to one viewer, by topic.

    :param clock: returns monotonic seconds
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._due: Dict[str, float] = {}
        self._unacked: Dict[int, Tuple[str, int]] = {}
        self._waiting: Dict[str, Tuple[int, int, bool]] = {}
        self._sent: List[float] = []
        self._thinned_at: Optional[float] = None

    def offer(self, topic: str, number: int, size: int, looked_at: bool) -> None:
        """A new picture is there: it takes the place of one of its topic that still waits.

        :param number: of the picture, ascending
        :param size: its bytes
        """
        self._waiting[topic] = number, size, looked_at

    def take(self) -> Optional[int]:
        """Return the number of the picture to send now, None if there is none to send."""
        now = self._clock()
        for topic, (number, size, looked_at) in self._waiting.items():
            unacked = [one for one in self._unacked.values() if one[0] == topic]
            total = sum(one[1] for one in self._unacked.values())
            if now < self._due.get(topic, 0.0):
                continue
            if len(unacked) >= MAX_UNACKED or total and total + size > MAX_UNACKED_BYTES:
                self._thinned_at = now
                continue
            del self._waiting[topic]
            period = 1.0 / (LOOKED_AT_HZ if looked_at else RATE_HZ)
            # A camera is not synchronised with this clock: a picture may come a little early.
            self._due[topic] = now + 0.9 * period
            self._unacked[number] = topic, size
            self._sent = [at for at in self._sent if at > now - 1.0] + [now]
            return number
        return None

    def ack(self, number: int) -> bool:
        """A picture was drawn; return whether it was on its way."""
        return self._unacked.pop(number, None) is not None

    def clear(self) -> None:
        """Nothing waits any more: the page is hidden."""
        self._waiting.clear()

    def rate_hz(self) -> float:
        """Return the pictures sent in the last second."""
        after = self._clock() - 1.0
        return float(len([at for at in self._sent if at > after]))

    def thinned(self) -> bool:
        """Return whether in the last two seconds a picture had to wait for the page to draw."""
        return self._thinned_at is not None and self._clock() - self._thinned_at < 2.0
