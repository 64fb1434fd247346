# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which of several publishers of one topic to listen to."""
from typing import Container, Optional


class Ownership:
    """The first to speak owns the topic, until it has gone or another one takes control."""

    def __init__(self) -> None:
        self.owner: Optional[str] = None
        self._claimed: Optional[str] = None

    def admits(self, caller: str, connected: Container[str]) -> bool:
        """Tell whether a message counts.

        :param caller: the node that sent it
        :param connected: all nodes that are connected as publishers
        """
        if self._claimed in connected:
            self.owner = self._claimed
        elif self.owner is None or self.owner not in connected:
            self.owner = caller
        return caller == self.owner

    def take(self, caller: str) -> bool:
        """Make a node the owner as soon as it is connected, and for as long.

        :returns: whether that is a change
        """
        changed, self.owner, self._claimed = self.owner != caller, caller, caller
        return changed
