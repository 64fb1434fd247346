# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A link that delays or loses items."""
import collections
from typing import Callable, Deque, Generic, List, Tuple, TypeVar

Item = TypeVar('Item')


class DelayLine(Generic[Item]):
    """Delays items in order, or drops them; not thread-safe.

    :param chance: function that returns a number from 0 up to but not including 1
    """

    def __init__(self, chance: Callable[[], float]) -> None:
        self._chance = chance
        self._kept: Deque[Tuple[float, Item]] = collections.deque()

    def put(self, item: Item, now: float, delay_s: float, loss: float) -> bool:
        """Add an item at a time [s]; return False if it is lost.

        :param loss: the share that is lost, 0 to 1
        """
        if loss and self._chance() < loss:
            return False
        # The order is kept, as in TCP: items sent after the end of a delay wait for earlier ones.
        due = max(now + delay_s, self._kept[-1][0] if self._kept else now)
        self._kept.append((due, item))
        return True

    def take(self, now: float) -> List[Item]:
        """Return the items that are due, oldest first."""
        due = []
        while self._kept and self._kept[0][0] <= now:
            due.append(self._kept.popleft()[1])
        return due

    def __len__(self) -> int:
        """Return the number of items in transit."""
        return len(self._kept)
