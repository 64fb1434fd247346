# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the other side of the link by its beats: round trip, clock offset, loss and ages.

Clocks need not be synchronized. Each beat echoes the newest one of the other side, which gives the
round-trip time, and the offset of the other clock to within half of it; the fastest recent echo is
used.
"""
from collections import deque
import math
from typing import Deque, Optional, Tuple

from mhri.driving.guard_link import parse_id
from mhri.link.frames import Beat, Frame

BEAT_S = 0.2
# The other side counts as gone after this silence: three consecutive beats may be lost [s].
GONE_S = 1.0
# Older commands by this estimate are not passed on to the guard [s], which also checks by its own
# clock that they contain a recent echo.
COMMAND_S = 0.3
# Without an echo for this long ages are unknown [s].
SURE_S = 10.0
_KEPT = 25


class Peer:
    """The state of the other side; times are [s] of a monotonic clock."""

    def __init__(self) -> None:
        #: the session that this side is linked with, None before the first beat
        self.session: Optional[int] = None
        self._beat_at: Optional[float] = None
        self._stamp_s = 0.0
        self._trips: Deque[Tuple[float, float, float]] = deque(maxlen=_KEPT)
        self._numbers: Deque[int] = deque(maxlen=_KEPT)

    def admits(self, session: int, now: float) -> bool:
        """Return whether to accept the beats of a session: one at a time.

        A second program of the same name is linked once the first is gone.
        """
        return session == self.session or not self.is_live(now)

    def on_beat(self, frame: Frame, beat: Beat, now: float) -> bool:
        """Handle a beat; return whether it is the first of a new session of the other side."""
        new = frame.session != self.session
        if new:
            self.session = frame.session
            self._trips.clear()
            self._numbers.clear()
        self._beat_at, self._stamp_s = now, frame.stamp_s
        self._numbers.append(frame.number)
        if beat.echo is not None:
            sent_at, held_s = beat.echo
            trip_s = now - sent_at - held_s
            if held_s >= 0.0 and 0.0 <= trip_s < SURE_S:
                self._trips.append((trip_s, frame.stamp_s + 0.5 * trip_s - now, now))
        return new

    def on_gone(self) -> None:
        """Note that the other side has left."""
        self._beat_at = None

    def echo(self, now: float) -> Optional[Tuple[float, float]]:
        """Return the echo for the next own beat."""
        return None if self._beat_at is None else (self._stamp_s, now - self._beat_at)

    def is_live(self, now: float) -> bool:
        """Return whether the other side is present."""
        return self._beat_at is not None and now - self._beat_at <= GONE_S

    def silence_s(self, now: float) -> float:
        """Return the time since the last beat of the other side [s]; infinite before the first."""
        return math.inf if self._beat_at is None else now - self._beat_at

    def age_s(self, frame: Frame, now: float) -> Optional[float]:
        """Return the age of a message [s], within half a round trip; None if unknown."""
        if frame.session != self.session or not self._trips or now - self._trips[-1][2] > SURE_S:
            return None
        return max(0.0, now + min(self._trips)[1] - frame.stamp_s)

    def round_trip_s(self) -> float:
        """Return the median of the last round trips [s]; NaN without any."""
        trips = sorted(trip_s for trip_s, _, _ in self._trips)
        return trips[len(trips) // 2] if trips else math.nan

    def loss(self) -> float:
        """Return the fraction of the last beats that were lost, from 0 to 1; NaN if too few."""
        if len(self._numbers) < 5:
            return math.nan
        sent = max(self._numbers) - min(self._numbers) + 1
        return 1.0 - len(set(self._numbers)) / sent


def held_s(said_at: float, now: float) -> float:
    """Return how long a command was delayed on its own computer before the link [s].

    Both arguments are times of day of that computer. The result is 0 if they are implausible, e.g.
    because the clock was set: a command with a longer delay contains no recent echo of the guard.
    """
    held = now - said_at
    return held if 0.0 <= held <= SURE_S else 0.0


def may_pass(frame_id: str, age_s: Optional[float]) -> bool:
    """Return whether to pass a command from the link on to the guard.

    Stops always pass. The guard checks all others again, by its own lease.

    :param frame_id: of the command, see :mod:`mhri.driving.guard_link`
    :param age_s: of the command, None if unknown
    """
    command = parse_id(frame_id)
    return command is not None and (command[3] or age_s is not None and age_s <= COMMAND_S)
