# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which of several publishers of one topic to listen to."""
from typing import AbstractSet, Optional, Set


class Ownership:
    """The first to speak owns the topic, until it has gone or another one takes control.

    Whoever was refused gets it only by taking control, or once it was started anew: it must not
    drive by waiting for the owner to go. An owner that somebody displaced by taking control has it
    back once another one takes control.
    """

    def __init__(self) -> None:
        self.owner: Optional[str] = None
        self._claimed: Optional[str] = None
        self._displaced: Optional[str] = None
        self._refused: Set[str] = set()

    def admits(self, caller: str, connected: AbstractSet[str]) -> bool:
        """Tell whether a message counts.

        :param caller: the node that sent it
        :param connected: all nodes that are connected as publishers, this one among them
        """
        self._refused &= connected
        if self._claimed in connected and self._claimed is not None:
            self._displace(self._claimed)
        elif (self.owner is None or self.owner not in connected) and caller not in self._refused:
            self.owner = caller
        if caller != self.owner:
            self._refused.add(caller)
        return caller == self.owner

    def take(self, caller: str, connected: AbstractSet[str]) -> bool:
        """Make a node the owner as soon as it is connected, and for as long.

        :returns: whether the owner is another one now
        """
        before = self.owner
        if self._displaced is not None and caller != self.owner:
            self.owner, self._displaced = self._displaced, None
            self._refused.discard(self.owner)
        self._claimed = caller
        self._refused.discard(caller)
        if caller in connected:
            self._displace(caller)
        return self.owner != before

    def _displace(self, caller: str) -> None:
        if caller != self.owner:
            self._displaced = self._displaced or self.owner
            self.owner = caller
