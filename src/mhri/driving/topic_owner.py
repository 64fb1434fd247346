# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Selection of one publisher of a topic, and detection of latched messages."""
from typing import AbstractSet, Any, Callable, Dict, Hashable, List, Optional, Sequence, Set


class TopicOwner:
    """The first publisher owns the topic, until it has gone or another one takes control.

    A refused publisher gets it only by taking control or after a restart: it must not drive by
    waiting for the owner to go. An owner displaced by a node that took control gets it back once
    another node takes control.
    """

    def __init__(self) -> None:
        self.owner: Optional[str] = None
        self._claimed = ''
        self._displaced: Optional[str] = None
        self._refused: Set[str] = set()

    def admits(self, caller: str, connected: Callable[[], AbstractSet[str]]) -> bool:
        """Return whether a message counts.

        :param caller: the node that sent it
        :param connected: returns all nodes connected as publishers; the caller may not be among
            them yet
        """
        if caller == self.owner and not self._refused and self._claimed in ('', caller):
            return True  # no other publisher: a command need not wait for the connections
        there = connected() | {caller}
        self._refused &= there
        if self._claimed in there:
            self._displace(self._claimed)
        elif (self.owner is None or self.owner not in there) and caller not in self._refused:
            self.owner = caller
        if caller != self.owner:
            self._refused.add(caller)
        return caller == self.owner

    def take(self, caller: str, connected: AbstractSet[str]) -> bool:
        """Make a node the owner for as long as it is connected.

        :returns: whether the owner has changed
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

    def kept(self) -> List[Any]:
        """Return the state for the next process, as JSON values."""
        return [self.owner, self._claimed, self._displaced, sorted(self._refused)]

    def restore(self, kept: Sequence[Any]) -> None:
        """Restore the result of :meth:`kept` of the previous process."""
        self.owner, self._claimed, self._displaced, refused = kept
        self._refused = set(refused)

    def _displace(self, caller: str) -> None:
        if caller != self.owner:
            self._displaced = self._displaced or self.owner
            self.owner = caller


class LiveMessages:
    """Distinguishes live messages from latched ones published before the connection.

    The first message on a connection whose publisher latches may have been published long ago.
    """

    def __init__(self) -> None:
        self._links: Dict[Hashable, object] = {}

    def is_live(self, sender: Hashable, link: object, latches: bool) -> bool:
        """Return whether a message counts.

        :param link: the connection it arrived on
        :param latches: whether its publisher latches
        """
        known = self._links.get(sender) is link
        self._links[sender] = link
        return known or not latches

    def forget(self, sender: Hashable) -> None:
        """Handle the loss of a sender."""
        self._links.pop(sender, None)
