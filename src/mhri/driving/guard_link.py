# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The host's end of the link to the guard on a robot (``utils/remote/mhri_guard``).

The guard sends echoes, each with a new token; a command carries the token of the newest echo, and
the guard obeys it while that token is recent. Both use ``frame_id``,
``<session>:<number>:<token>``: the sender, the number of the command (in an echo: of the last one
obeyed), and the token. While stop-all is in force, the session of a command ends in ``!``; while
the stop is latched on the robot, the token of an echo ends in ``!``.

A zero without ``!`` that answers an echo sent after the stop releases it; until then the guard
drops everything else. So a gate sends zeros until :attr:`GuardLink.stop_confirmed` is false.
"""
from dataclasses import dataclass
import math
import re
from typing import Optional, Tuple

from mhri.base.brake_view import ON
from mhri.base.reasons import NO_SCAN, SLOWS, UNSEEN

# An echo comes every 0.1 s; three in a row may be lost.
ECHO_S = 0.35
_ID = re.compile(r'([A-Za-z0-9_-]{1,32})(!?):([0-9]{1,15}):([A-Za-z0-9_-]{0,32})(!?)\Z')
_STATE = re.compile(r'(brake|way|back_after):([a-z0-9_.]{1,12})\Z')
_ALSO = re.compile(r'also:(/[A-Za-z0-9_/]{1,60})\Z')
_SESSION = re.compile(r'[A-Za-z0-9_-]{1,32}\Z')
# Number of the last command of a session, above any other. The guard obeys none after it.
_LAST = 10 ** 15 - 1
# The session of an echo before any command was obeyed.
_NOBODY = '-'


def format_id(session: str, number: int, token: str, stop: bool = False) -> str:
    """Return the frame_id of a command; with an empty token it is valid only as a stop."""
    return '{}{}:{}:{}'.format(session, '!' if stop else '', number, token)


def parse_id(text: str) -> Optional[Tuple[str, int, str, bool]]:
    """Return (session, number, token, stop) of a frame_id, or None if it is not one.

    ``stop`` is true for a command that stops and for an echo of a robot that is stopped.
    """
    found = _ID.match(text)
    if found is None:
        return None
    session, stop, number, token, latched = found.groups()
    return session, int(number), token, bool(stop or latched)


@dataclass(frozen=True)
class GuardState:
    """The autonomous functions that a guard reports.

    ``brake`` is '' without a brake, else a state of :mod:`mhri.driving.stick_brake`;
    ``free_way_m`` is the distance to the obstacle that slows the robot down [m], NaN without one;
    ``back_after_s`` is the time without a link after which it drives the robot back [s], 0 for
    never; ``also`` are the other nodes that send commands to the robot.
    """

    brake: str = ''
    free_way_m: float = math.nan
    back_after_s: float = 0.0
    also: Tuple[str, ...] = ()


def read_state(text: str) -> GuardState:
    """Parse a guard's report, e.g. "brake:slows way:0.60 back_after:10".

    Unreadable parts are ignored; a brake in an unknown state counts as one without a scan.
    """
    words = text[:500].split()
    found = {part.group(1): part.group(2) for part in map(_STATE.match, words) if part}
    also = tuple(part.group(1) for part in map(_ALSO.match, words) if part)
    brake = found.get('brake', '')
    return GuardState(brake if brake in ('', ON, SLOWS, UNSEEN) else NO_SCAN,
                      _number(found.get('way'), math.nan), _number(found.get('back_after'), 0.0),
                      also)


def _number(text: Optional[str], otherwise: float) -> float:
    try:
        return float(text) if text else otherwise
    except ValueError:
        return otherwise


class GuardLink:
    """The link to the guard of one robot; times are seconds of a monotonic clock.

    :param session: identifies this run of the sender: new at each start, at most 32 characters of
        ``A-Za-z0-9_-``
    :raises ValueError: the session is invalid
    """

    def __init__(self, session: str) -> None:
        if not _SESSION.match(session) or session == _NOBODY:
            raise ValueError('the session is {!r}: give at most 32 of A-Z, a-z, 0-9, _ and -'
                             .format(session))
        self._session = session
        # Numbers of the last command and of the last stop.
        self._number = self._stop_number = 0
        self._token = ''
        self._echo_at: Optional[float] = None
        #: the session of the newest echo
        self.speaker = ''
        self.obeyed_number = 0
        self.displaced = False
        self.stop_confirmed = False
        #: whether that stop is from this session; after a later command it is another sender's
        self.stop_is_own = False

    def on_echo(self, frame_id: str, now: float) -> bool:
        """Handle the frame_id of an echo; return False and change nothing if it is invalid."""
        echo = parse_id(frame_id)
        if echo is None or not echo[2]:
            return False
        self.speaker, number, self._token, self.stop_confirmed = echo
        self._echo_at = now
        ours = self.speaker == self._session
        self.displaced = not ours and self.speaker != _NOBODY and (
            self.displaced or self.obeyed_number > 0)
        self.obeyed_number = number if ours else 0
        self.stop_is_own = self.stop_confirmed and ours and number <= self._stop_number
        return True

    def alive(self, now: float) -> bool:
        """Return whether an echo came within the last 0.35 s."""
        return self._echo_at is not None and now - self._echo_at <= ECHO_S

    @property
    def token(self) -> str:
        """The token of the newest echo, '' before the first."""
        return self._token

    def next_id(self, stop: bool) -> str:
        """Return the frame_id for the next command, which must then be sent.

        Its token is empty before the first echo; then the guard obeys only a stop.
        """
        self._number += 1
        if stop:
            self._stop_number = self._number
        return format_id(self._session, self._number, self._token, stop)

    def last_id(self, stop: bool) -> str:
        """Return the frame_id for the last command of this session, sent when this program ends.

        The guard obeys no further command of the session.
        """
        return format_id(self._session, _LAST, self._token, stop)
