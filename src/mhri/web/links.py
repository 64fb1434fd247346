# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Links to the page: who may watch, and who may drive, until when; and guessed tokens."""
from dataclasses import asdict, dataclass
import hashlib
import math
from typing import Any, Callable, Dict, Iterable, List, Optional, Tuple

from mhri.base.text import tidy_text

WATCH, DRIVE = 'watch', 'drive'
MAX_LINKS, MAX_HOURS = 64, 720.0
# Wrong tokens that one address may try within so many seconds, and addresses remembered.
TRIES, TRIES_S, MAX_ADDRESSES = 5, 60.0, 1000


class LinkError(ValueError):
    """A link cannot be given; the text says why."""


@dataclass(frozen=True)
class Link:
    """One link; ``expires_s`` is time of day [s], ``digest`` the SHA-256 of its token in hex."""

    id: str
    label: str
    role: str
    may_stop: bool
    head: bool
    expires_s: float
    digest: str


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode('utf-8', 'replace')).hexdigest()


class LinkBook:
    """The links that are given out; it knows digests of their tokens alone.

    :param new_token: returns a new secret text that may stand in a URL
    :param rows: those of :meth:`rows`, from a file; invalid ones are left out
    """

    def __init__(self, new_token: Callable[[], str], rows: Iterable[Any] = ()) -> None:
        self._new_token = new_token
        self._links: Dict[str, Link] = {}
        for row in rows:
            link = _link_of(row)
            if link and len(self._links) < MAX_LINKS:
                self._links[link.digest] = link

    def give(self, label: str, role: str, may_stop: bool, head: bool, hours: float,
             now_s: float) -> Tuple[Link, str]:
        """Return a new link and its token.

        :raises LinkError: a value is invalid, or there are too many links
        """
        if role not in (WATCH, DRIVE):
            raise LinkError('a link is to watch or to drive, not to {!r}'.format(role[:20]))
        if head and role != DRIVE:
            raise LinkError('only a link to drive may turn the head of a robot')
        if not 0.0 < hours <= MAX_HOURS:
            raise LinkError('a link is valid for up to {:g} hours'.format(MAX_HOURS))
        if len(self.alive(now_s)) >= MAX_LINKS:
            raise LinkError('there are {} links: take one back first'.format(MAX_LINKS))
        token = self._new_token()
        digest = _digest(token)
        link = Link(digest[:8], tidy_text(label, 60), role, may_stop, head,
                    now_s + hours * 3600.0, digest)
        self._links[digest] = link
        return link, token

    def find(self, token: str, now_s: float) -> Optional[Link]:
        """Return the valid link of a token, None if there is none."""
        link = self._links.get(_digest(token))
        return link if link and now_s < link.expires_s else None

    def take(self, name: str) -> bool:
        """Take back a link by its id; return whether there was one."""
        found = [digest for digest, link in self._links.items() if link.id == name]
        for digest in found:
            del self._links[digest]
        return bool(found)

    def alive(self, now_s: float) -> List[Link]:
        """Return the valid links, those given first at the beginning; forget the expired ones."""
        self._links = {digest: link for digest, link in self._links.items()
                       if now_s < link.expires_s}
        return list(self._links.values())

    def rows(self) -> List[Dict[str, Any]]:
        """Return all links as values for a file."""
        return [asdict(link) for link in self._links.values()]


def _link_of(row: Any) -> Optional[Link]:
    """Return the link of a row of a file, None if it is invalid."""
    kinds = {'id': str, 'label': str, 'role': str, 'may_stop': bool, 'head': bool,
             'expires_s': float, 'digest': str}
    valid = isinstance(row, dict) and set(row) == set(kinds) and all(
        isinstance(row[key], kind) for key, kind in kinds.items())
    return Link(**row) if valid and row['role'] in (WATCH, DRIVE) and math.isfinite(
        row['expires_s']) else None


class WrongTokens:
    """Counts wrong tokens by address; after :data:`TRIES` within a minute it may try no more.

    :param clock: returns monotonic seconds
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._tries: Dict[str, List[float]] = {}

    def may_try(self, address: str) -> bool:
        """Return whether an address may try a token now."""
        return len(self._recent(address)) < TRIES

    def add(self, address: str) -> None:
        """Count a wrong token."""
        recent = (self._recent(address) + [self._clock()])[-TRIES:]
        self._tries.pop(address, None)
        self._tries[address] = recent
        if len(self._tries) > MAX_ADDRESSES:
            del self._tries[next(iter(self._tries))]

    def _recent(self, address: str) -> List[float]:
        after = self._clock() - TRIES_S
        return [at for at in self._tries.get(address, ()) if at > after]
