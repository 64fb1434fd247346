# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who of several publishers of one topic is listened to."""
import collections
from typing import Container, Counter, Optional

# More names than this are counted under one word.
_MOST_NAMES = 20
OTHERS = 'others'


class Ownership:
    """The first who speaks owns the topic, until it has gone or another one takes control."""

    def __init__(self) -> None:
        self.owner: Optional[str] = None
        self._claimed: Optional[str] = None
        self.refused: Counter[str] = collections.Counter()

    def admits(self, caller: str, connected: Container[str]) -> bool:
        """Tell whether a message counts; one that does not is counted under its sender's name.

        :param caller: the node that sent it
        :param connected: all nodes that are connected as publishers
        """
        if self._claimed in connected:
            self.owner = self._claimed
        elif self.owner is None or self.owner not in connected:
            self.owner = caller
        if caller == self.owner:
            return True
        known = caller in self.refused or len(self.refused) < _MOST_NAMES
        self.refused[caller if known else OTHERS] += 1
        return False

    def take(self, caller: str) -> bool:
        """Make a node the owner, as soon and as long as it is connected.

        :returns: whether that is a change
        """
        changed, self.owner, self._claimed = self.owner != caller, caller, caller
        return changed
