# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The links and viewers of the page as the operator's screen shows them."""
from dataclasses import dataclass
from datetime import datetime
from typing import Dict, Tuple

WATCH, WATCH_STOP, DRIVE = 'watch', 'watch_stop', 'drive'
#: what a link allows: {choice: (its words, role of ``mhri/GiveLink``, may_stop)}
CHOICES: Dict[str, Tuple[str, str, bool]] = {
    WATCH: ('Watch', 'watch', False), WATCH_STOP: ('Watch, with STOP', 'watch', True),
    DRIVE: ('Drive', 'drive', True)}
#: how long a link is valid: {hours: words}
HOURS: Dict[int, str] = {1: '1 hour', 12: '12 hours', 168: '7 days'}
USUAL_HOURS = 12
NOT_RUNNING = 'Off. Start mhri with "web:=true" to watch it on a phone, tablet or headset.'
NO_VIEWERS = 'nobody is watching'


@dataclass(frozen=True)
class LinkView:
    """A link; ``expires_s`` is its end [s since 1970]."""

    id: str
    label: str
    role: str
    may_stop: bool
    head: bool
    expires_s: float

    def words(self, now_s: float) -> str:
        """Return what it allows, and until when: "Watch, with STOP, until 15:41"."""
        words = next((text for text, *allowed in CHOICES.values()
                      if allowed == [self.role, self.may_stop]), self.role.capitalize())
        return ', '.join(filter(None, (
            words, 'turns the camera' if self.head else '',
            'until ' + clock_text(self.expires_s, now_s))))


@dataclass(frozen=True)
class ViewerView:
    """An open page; ``since_s`` is when it was opened [s since 1970]."""

    id: str
    label: str
    address: str
    since_s: float
    holds: bool
    thinned: bool

    def words(self, now_s: float) -> str:
        """Return where it is, since when, and what is special: "10.0.0.7, since 14:02"."""
        return ', '.join(filter(None, (
            self.address, 'since ' + clock_text(self.since_s, now_s),
            'DRIVES' if self.holds else '',
            'slow: gets fewer pictures' if self.thinned else '')))


@dataclass(frozen=True)
class WebView:
    """The state of the page's server; ``there`` is whether it is running."""

    there: bool = False
    address: str = ''
    problem: str = ''
    links: Tuple[LinkView, ...] = ()
    viewers: Tuple[ViewerView, ...] = ()


def clock_text(at_s: float, now_s: float) -> str:
    """Return a time of day [s since 1970] in local time, with its date on another day."""
    at, now = datetime.fromtimestamp(at_s), datetime.fromtimestamp(now_s)
    return '{:%H:%M}'.format(at) if at.date() == now.date() else '{:%Y-%m-%d %H:%M}'.format(at)
