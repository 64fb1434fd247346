# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which of several publishers of one topic to listen to."""
import collections
from typing import Container, Counter, Optional

# Further names than this are counted together.
_MOST_NAMES = 20
OTHERS = 'others'


class Ownership:
    """The first to speak owns the topic, until it has gone or another one takes control."""

    def __init__(self) -> None:
        self.owner: Optional[str] = None
        self._claimed: Optional[str] = None
        self.refused: Counter[str] = collections.Counter()

    def admits(self, caller: str, connected: Container[str]) -> bool:
        """Tell whether a message counts; count it under its sender's name if it does not.

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
        """Make a node the owner as soon as it is connected, and for as long.

        :returns: whether that is a change
        """
        changed, self.owner, self._claimed = self.owner != caller, caller, caller
        return changed
