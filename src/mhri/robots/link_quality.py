# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the link to a robot: round trip, clock offset and loss. No ROS, no clock."""
import collections
import statistics
from typing import Deque, Optional, Tuple

from mhri.base.views import LinkFigures

ROUND_TRIPS = 5
# Windows of the minimum delay and of the loss [s].
OFFSET_WINDOW_S = 10.0
LOSS_WINDOW_S = 5.0
MAX_LOST = 500
# Beyond these a row warns. Driving by camera gets worse from 170 ms on (MacKenzie & Ware, CHI '93:
# 225 ms of lag cost 64 % of the time); two clocks 0.1 s apart upset tf and motion capture.
WARN_ROUND_TRIP_S = 0.2
WARN_LOSS = 0.05
WARN_OFFSET_S = 0.1
# Above this round trip a group slows down: half the speed at twice the round trip [s].
SLOW_ROUND_TRIP_S = 0.15
MIN_SHARE = 0.2
SHARE_STEP = 0.1


class LinkQuality:
    """Collects the measurements of one robot's link; not thread-safe, times are passed in."""

    def __init__(self) -> None:
        self._round_trips: Deque[float] = collections.deque(maxlen=ROUND_TRIPS)
        self._unanswered = 0
        self._delays: Deque[Tuple[float, float]] = collections.deque()
        self._counts: Deque[Tuple[float, int]] = collections.deque()
        self._lost = 0
        self._seq: Optional[int] = None

    def on_round_trip(self, round_trip_s: Optional[float]) -> None:
        """Handle a round trip [s]; None if there was no answer."""
        if round_trip_s is None:
            self._unanswered += 1
            if self._unanswered >= 2:
                self._round_trips.clear()
        else:
            self._unanswered = 0
            self._round_trips.append(round_trip_s)

    def on_message(self, seq: int, delay_s: Optional[float], now: float) -> None:
        """Handle one message of a stream.

        :param seq: its sequence number, which the publisher increases by one
        :param delay_s: local time of receipt minus its stamp [s]; None without a stamp
        :param now: [s], of a monotonic clock
        """
        if delay_s is not None:
            # Keep only delays in the window that are below all later ones.
            while self._delays and self._delays[-1][1] >= delay_s:
                self._delays.pop()
            self._delays.append((now, delay_s))
        gap = seq - self._seq - 1 if self._seq is not None else 0
        self._seq = seq
        # Neither a restarted publisher nor a second one counts as loss.
        gap = gap if 0 <= gap <= MAX_LOST else 0
        self._counts.append((now, gap))
        self._lost += gap
        self._forget(now)

    def _forget(self, now: float) -> None:
        while self._delays and self._delays[0][0] < now - OFFSET_WINDOW_S:
            self._delays.popleft()
        while self._counts and self._counts[0][0] < now - LOSS_WINDOW_S:
            self._lost -= self._counts.popleft()[1]

    def read(self, now: float) -> LinkFigures:
        """Return the :class:`mhri.base.views.LinkFigures` of this moment."""
        self._forget(now)
        trips = self._round_trips
        offset = None
        if self._delays and trips:
            # The fastest message took about half the fastest round trip.
            offset = min(trips) / 2.0 - self._delays[0][1]
        return LinkFigures(
            round_trip_s=statistics.median(trips) if trips else None, offset_s=offset,
            loss=self._lost / (self._lost + len(self._counts)) if self._counts else None)


class RecordedQuality(LinkQuality):
    """The link of a replayed robot: its recorded round trip.

    The arrival of the player's own messages says nothing about the recorded link.
    """

    def on_message(self, seq: int, delay_s: Optional[float], now: float) -> None:
        """Ignore it."""


def link_warning(figures: LinkFigures, dropped: bool = False) -> str:
    """Return the problems of a live link in words; '' if all is well.

    :param dropped: whether the robot's guard is dropping commands now
    """
    words = ['its guard drops late commands'] if dropped else []
    words += [figures.thinned] if figures.thinned else []
    if figures.round_trip_s is not None and figures.round_trip_s > WARN_ROUND_TRIP_S:
        words.append('slow link: {:.0f} ms round trip'.format(1e3 * figures.round_trip_s))
    if figures.loss is not None and figures.loss > WARN_LOSS:
        words.append('bad link: {:.0f} % of its messages lost'.format(100.0 * figures.loss))
    if figures.offset_s is not None and abs(figures.offset_s) > WARN_OFFSET_S:
        words.append('its clock is {:.1f} s {}: set both by chrony'.format(
            abs(figures.offset_s), 'ahead' if figures.offset_s > 0.0 else 'behind'))
    return '; '.join(words)


def link_share(round_trip_s: Optional[float]) -> float:
    """Return the fraction of a command, in tenths, for a group whose slowest link takes this long.

    :param round_trip_s: [s]; None if unknown
    """
    if round_trip_s is None or round_trip_s <= SLOW_ROUND_TRIP_S:
        return 1.0
    steps = int(SLOW_ROUND_TRIP_S / round_trip_s / SHARE_STEP + 1e-9)
    return max(MIN_SHARE, round(steps * SHARE_STEP, 1))
