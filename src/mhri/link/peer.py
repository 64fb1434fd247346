# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The other side of the link as its beats show it: round trip, clock, loss, and the age of things.

Clocks need not agree. Each beat echoes the newest one of the other side, so a round trip is known,
and with it the offset of the other clock to half of that; the quickest of the last ones counts.
"""
from collections import deque
import math
from typing import Deque, Optional, Tuple

from mhri.driving.guard_link import parse_id
from mhri.link.frames import Beat, Frame

BEAT_S = 0.2
# Three beats in a row may be lost before the other side counts as gone.
GONE_S = 1.0
# A command that is older by that estimate is not passed on to the guard, which sees by its own
# clock that it answers a young echo [s].
COMMAND_S = 0.3
# Without an echo for so long nobody knows how old anything is [s].
SURE_S = 10.0
_KEPT = 25


class Peer:
    """What is known of the other side; times are [s] of a clock that never goes back."""

    def __init__(self) -> None:
        self._session: Optional[int] = None
        self._heard_at: Optional[float] = None
        self._stamp_s = 0.0
        self._trips: Deque[Tuple[float, float, float]] = deque(maxlen=_KEPT)
        self._numbers: Deque[int] = deque(maxlen=_KEPT)

    def on_beat(self, frame: Frame, beat: Beat, now: float) -> bool:
        """Take in a beat; return whether it is the first of another run of the other side."""
        new = frame.session != self._session
        if new:
            self._session = frame.session
            self._trips.clear()
            self._numbers.clear()
        self._heard_at, self._stamp_s = now, frame.stamp_s
        self._numbers.append(frame.number)
        if beat.echo is not None:
            sent_at, held_s = beat.echo
            trip_s = now - sent_at - held_s
            if held_s >= 0.0 and 0.0 <= trip_s < SURE_S:
                self._trips.append((trip_s, frame.stamp_s + 0.5 * trip_s - now, now))
        return new

    def echo(self, now: float) -> Optional[Tuple[float, float]]:
        """Return what the next own beat echoes."""
        return None if self._heard_at is None else (self._stamp_s, now - self._heard_at)

    def heard(self, now: float) -> bool:
        """Tell whether the other side is there."""
        return self._heard_at is not None and now - self._heard_at <= GONE_S

    def silence_s(self, now: float) -> float:
        """Return how long the other side was not heard [s]; infinite before its first beat."""
        return math.inf if self._heard_at is None else now - self._heard_at

    def age_s(self, frame: Frame, now: float) -> Optional[float]:
        """Return how old a message is [s], good to half a round trip; None if nobody knows."""
        if frame.session != self._session or not self._trips or now - self._trips[-1][2] > SURE_S:
            return None
        return max(0.0, now + min(self._trips)[1] - frame.stamp_s)

    def round_trip_s(self) -> float:
        """Return the median of the last round trips [s], NaN without any."""
        trips = sorted(trip_s for trip_s, _, _ in self._trips)
        return trips[len(trips) // 2] if trips else math.nan

    def loss(self) -> float:
        """Return the share of the last beats that did not come, from 0 to 1; NaN for too few."""
        if len(self._numbers) < 5:
            return math.nan
        sent = max(self._numbers) - min(self._numbers) + 1
        return 1.0 - len(set(self._numbers)) / sent


def held_s(said_at: float, now: float) -> float:
    """Return how long a command was held on its own computer before it came to the link [s].

    Both are times of day of that computer. Where they cannot be, as the clock was set, it is 0:
    what is older than this can tell answers no question of the guard any more.
    """
    held = now - said_at
    return held if 0.0 <= held <= SURE_S else 0.0


def may_pass(frame_id: str, age_s: Optional[float]) -> bool:
    """Tell whether a command that came over the link goes on to the guard.

    A stop always does. The guard judges the rest once more, by its own lease.

    :param frame_id: of the command, see :mod:`mhri.driving.guard_link`
    :param age_s: of the command, None if nobody knows
    """
    command = parse_id(frame_id)
    return command is not None and (command[3] or age_s is not None and age_s <= COMMAND_S)
