# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Estimates the rate that a radio carries, from the reports of the receiver.

It measures queuing delay, like LEDBAT (RFC 6817) and Google's congestion control
(draft-ietf-rmcat-gcc-02): sending more than the radio carries would fill its queues, where commands
and poses would wait behind pictures. Clocks need not be synchronized: the additional delay of a
message over the fastest recent one is queuing. Loss does not indicate the rate unless it is high.
"""
from collections import deque
import math
from typing import Deque, Dict, List, Tuple

from mhri.link.frames import Frame, LinkStats

# Overhead of each message on the air: IP, UDP and zenoh [bytes].
AROUND_BYTES = 60
# Windows for the received rate and for loss [s].
WINDOW_S, LOSS_WINDOW_S = 0.5, 2.0
# The baseline of the delay is the fastest message of this number of periods of this length [s].
_BASE_S, _BASES = 10.0, 2
# A delay above the first reduces the rate; below the second the rate may grow [s].
MAX_QUEUE_S, LOW_QUEUE_S = 0.07, 0.03
# Loss above the first makes the estimator careful, above the second it reduces the rate; below the
# third the radio counts as free of loss.
LOSSY, MAX_LOSS, LOSSLESS = 0.08, 0.5, 0.01
# More loss than this, with delay, indicates a far slower radio.
FLOOD = 0.4
# A cut sends this fraction of the carried rate; the first cut is deeper, since the queues are full
# and the delay without them is unknown. Then the rate grows by these fractions per second: below
# the rate that was too high, around it, and beyond it, where the fraction itself grows each second.
# After the first cut and on a different radio it grows faster, since little is known.
CUT, FIRST_CUT = 0.85, 0.6
GROWTH, AROUND_GROWTH, BEYOND_GROWTH = 0.03, 0.015, 0.01
FIRST_GROWTH, NEW_GROWTH = 0.15, 0.5
NEAR, BEYOND = 0.85, 1.15
# Minimum growth: slow flows catch up with fast ones, so that robots that share a radio converge to
# equal rates [bytes/s^2].
_MIN_GROWTH, _MIN_FIRST = 1300.0, 3000.0
# Faster flows than this reduce their rate at shorter delays, slower ones at longer [bytes/s].
_MIDDLE = 30000.0
# Unused capacity is not verified: the limit grows to at most this multiple of the received rate.
_USED = 2.0
# The rate in half a second varies: a cut starts from at least this fraction of the limit.
_SURELY = 0.7
# Time after a cut with earlier messages in transit; time without pictures after the first cut [s].
SETTLE_S, QUIET_S = 1.0, 0.5
# After the first cut the queues drain for this time, or for longer if no drop is seen, and until
# the delay has stopped falling for a while [s].
DRAIN_S, LONG_DRAIN_S, FELL_S = 1.0, 3.0, 0.5
# If the delay has not fallen by this after two cuts, our sending does not cause it: the path has
# become longer, or other traffic fills it [s].
_FALLS_S = 0.03
# Number of consecutive bad reports that start the limit; one with both loss and delay suffices.
BAD = 3
MIN_BYTES_PER_S = 8000.0


class Meter:
    """Measures rate, delay and loss of received messages; times are [s] of a monotonic clock."""

    def __init__(self) -> None:
        self._session = -1
        self._came: Deque[Tuple[float, int, float]] = deque()
        self._counts: Deque[Tuple[float, int]] = deque()
        self._lost = 0
        self._numbers: Dict[str, Tuple[int, float]] = {}
        self._bases: Deque[List[float]] = deque(maxlen=_BASES)

    def note(self, topic: str, frame: Frame, size: int, now: float) -> None:
        """Record a received message.

        :param size: size of the whole message [bytes]
        """
        if frame.session != self._session:
            self._session = frame.session
            self._numbers.clear()
            self._bases.clear()
            self._came.clear()
        delay_s = now - frame.stamp_s
        if not self._bases or now - self._bases[-1][0] > _BASE_S:
            self._bases.append([now, delay_s])
        self._bases[-1][1] = min(self._bases[-1][1], delay_s)
        self._came.append((now, size + AROUND_BYTES, delay_s))
        last, last_at = self._numbers.get(topic, (frame.number - 1, now))
        self._numbers[topic] = frame.number, now
        gap = frame.number - last - 1
        # Numbers wrap around, and an old gap in a stream is not recent loss.
        gap = gap if 0 <= gap < 1000 and now - last_at < LOSS_WINDOW_S else 0
        self._counts.append((now, gap))
        self._lost += gap
        self._forget(now)

    def _forget(self, now: float) -> None:
        while self._came and self._came[0][0] < now - WINDOW_S:
            self._came.popleft()
        while self._counts and self._counts[0][0] < now - LOSS_WINDOW_S:
            self._lost -= self._counts.popleft()[1]

    def read(self, now: float) -> LinkStats:
        """Return recent statistics; zeros if nothing was received."""
        self._forget(now)
        if not self._came:
            return LinkStats(0.0, 0.0, 0.0)
        delays = sorted(delay_s for _, _, delay_s in self._came)
        base = min(found for _, found in self._bases)
        return LinkStats(sum(size for _, size, _ in self._came) / WINDOW_S,
                         delays[len(delays) // 2] - base,
                         self._lost / (self._lost + len(self._counts)))


class RateEstimator:
    """The limit of the rate [bytes/s]; infinite while the radio carries everything.

    It starts without a limit: within a second the reports show the rate that the radio carries.
    """

    def __init__(self) -> None:
        self.bytes_per_s = math.inf
        self.loss = 0.0
        self._cut_at = self._full_at = self._fell_at = -math.inf
        self._top = self._cut_loss = self._own_loss = 0.0
        self._stats_at = -math.inf
        self._bad = 0
        # Draining after the first cut, at first without pictures; then growing by this fraction per
        # second, 0 for slow growth.
        self.drains, self.quiet, self._fast = False, False, 0.0
        # Number of consecutive cuts without effect, and the limit before them.
        self._vain, self._before = 0, math.inf
        self._waited_s = self._longer_s = self._last_s = 0.0

    @property
    def bound(self) -> bool:
        """Whether the rate is limited."""
        return math.isfinite(self.bytes_per_s)

    def on_stats(self, stats: LinkStats, demand: float, now: float) -> None:
        """Handle a report of the receiver.

        :param demand: rate that would be sent without a limit [bytes/s]
        """
        step_s = min(1.0, now - self._stats_at)
        self._stats_at, self.loss = now, stats.loss
        self._longer_s = min(self._longer_s, stats.queue_s)
        queue_s = stats.queue_s - self._longer_s
        # Losses from before a cut no longer count.
        most_s, calm_s = self._limits_s()
        full = queue_s > most_s or (
            stats.loss > MAX_LOSS and now - self._cut_at > LOSS_WINDOW_S + 2.0 * SETTLE_S)
        if full:
            self._full_at = now
        elif now - self._full_at > LOSS_WINDOW_S + SETTLE_S:
            # No queue is full, so the radio itself causes this loss.
            self._own_loss += 0.1 * (stats.loss - self._own_loss)
        if not self.bound:
            self._begin(stats, full, now)
        elif self.drains:
            self._drain(stats, now)
        elif full and stats.loss > FLOOD and now - self._cut_at > SETTLE_S:
            self._first_cut(stats, now)
        elif full:
            # On a long path the delay decreases late.
            falls = queue_s < self._last_s and now - self._cut_at < 2.0 * SETTLE_S
            if now - self._cut_at >= SETTLE_S and not falls:
                self._again(stats, queue_s, now)
        elif queue_s < calm_s and now - self._cut_at > SETTLE_S:
            self._grow(stats, step_s, demand, now)
        self.quiet = self.drains and now - self._cut_at < QUIET_S
        self._last_s = queue_s

    def _limits_s(self) -> Tuple[float, float]:
        """Return the limits of a long and of a short delay [s]; lower for fast flows."""
        scale = min(2.0, max(0.8, math.sqrt(_MIDDLE / self.bytes_per_s)))
        return MAX_QUEUE_S * scale, LOW_QUEUE_S * scale

    def _carried(self, stats: LinkStats) -> float:
        """Return the rate that the radio carries, including its own losses [bytes/s]."""
        return stats.bytes_per_s / (1.0 - min(MAX_LOSS, self._own_loss))

    def _begin(self, stats: LinkStats, full: bool, now: float) -> None:
        """Check whether the radio still carries everything."""
        # Delay alone may be caused by a busy computer, loss alone by the radio itself.
        lossy = stats.loss > LOSSY
        self._bad = self._bad + (BAD if full and lossy else 1) if full or lossy else 0
        if self._bad >= BAD or stats.loss > MAX_LOSS:
            self._first_cut(stats, now)

    def _first_cut(self, stats: LinkStats, now: float) -> None:
        """Start over from the received rate: far too much was sent."""
        self.bytes_per_s = math.inf
        self._cut(stats, now, FIRST_CUT)
        self.drains, self._waited_s = True, max(stats.queue_s, _FALLS_S + LOW_QUEUE_S)

    def _drain(self, stats: LinkStats, now: float) -> None:
        """Wait until the delay stops falling; messages in transit may increase it at first."""
        self._top = max(self._top, self._carried(stats))
        fell = self._fell_at > self._cut_at
        if stats.queue_s < self._waited_s - _FALLS_S:
            self._waited_s, self._fell_at = stats.queue_s, now
        elif not fell:
            self._waited_s = max(self._waited_s, stats.queue_s)
        # It takes longer if other robots have not started to drain yet, or on a slow computer.
        if now - self._cut_at >= (DRAIN_S if fell else LONG_DRAIN_S) \
                and now - self._fell_at >= FELL_S:
            self._drained(stats)

    def _drained(self, stats: LinkStats) -> None:
        """Treat the remaining delay as that of the path."""
        if stats.queue_s > LOW_QUEUE_S:
            self._longer_s = stats.queue_s
        self.bytes_per_s = max(self.bytes_per_s, CUT * self._top)
        self.drains, self._fast = False, FIRST_GROWTH

    def _again(self, stats: LinkStats, queue_s: float, now: float) -> None:
        """Cut again, or conclude that cutting does not help."""
        falls = now - self._cut_at > 2.0 * SETTLE_S or queue_s < self._waited_s - _FALLS_S
        self._vain = 0 if falls else self._vain + 1
        if not self._vain:
            self._before = self.bytes_per_s
        self._waited_s, self._fast = queue_s, 0.0
        if self._vain < 2 or queue_s <= self._limits_s()[0]:
            self._cut(stats, now, CUT)
        else:
            self._longer_s, self._vain = stats.queue_s, 0
            self.bytes_per_s, self._fast = self._before, FIRST_GROWTH

    def _cut(self, stats: LinkStats, now: float, part: float) -> None:
        carried = self._carried(stats)
        if now - self._cut_at > 2.0 * SETTLE_S:
            # At first the sent rate is unknown.
            self._top = self.bytes_per_s if self.bound else carried
        if self.bound:
            carried = max(carried, _SURELY * self.bytes_per_s)
        self.bytes_per_s = max(MIN_BYTES_PER_S, part * min(carried, self.bytes_per_s))
        self._cut_at, self._bad, self._cut_loss = now, 0, stats.loss

    def _grow(self, stats: LinkStats, step_s: float, demand: float, now: float) -> None:
        if self._cut_loss > LOSSY and self.loss < LOSSLESS:
            # The radio has changed, and its rate is unknown.
            self._cut_loss, self._fast = 0.0, NEW_GROWTH
        calm_s = now - self._cut_at - SETTLE_S
        if self._fast:
            share = self._fast
        elif self.bytes_per_s < NEAR * self._top:
            share = GROWTH
        else:
            beyond = self.bytes_per_s > BEYOND * self._top
            share = min(1.0, BEYOND_GROWTH * calm_s) if beyond else AROUND_GROWTH
        least = _MIN_FIRST if self._fast else _MIN_GROWTH
        grown = self.bytes_per_s + step_s * max(share * self.bytes_per_s, least)
        self.bytes_per_s = max(self.bytes_per_s, min(grown, _USED * self._carried(stats)))
        if self.bytes_per_s >= 1.2 * demand and self.loss < 0.5 * LOSSY:
            self.bytes_per_s = math.inf
