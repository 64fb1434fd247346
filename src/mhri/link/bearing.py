# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How much a radio bears, from what the other side says that came.

What counts is how long things wait on the way, as in LEDBAT (RFC 6817) and in Google's congestion
control (draft-ietf-rmcat-gcc-02): more than the radio carries would fill the queues in it, and
every command and pose would wait there behind pictures. Clocks need not agree: a message that takes
longer than the quickest of the last while has waited for the difference. Packets that a radio
loses say nothing about its rate, unless they are many.
"""
from collections import deque
import math
from typing import Deque, Dict, List, Tuple

from mhri.link.frames import Frame, Heard

# What is around each message on the air: IP, UDP and zenoh's own [bytes].
AROUND_BYTES = 60
# Over which time it is counted what came, and what was lost [s].
WINDOW_S, LOSS_WINDOW_S = 0.5, 2.0
# The quickest message of so many such times is the base of what waits.
_BASE_S, _BASES = 10.0, 2
# Waiting for longer is too much, for less leaves room for more [s].
QUEUE_MOST_S, QUEUE_CALM_S = 0.07, 0.03
# Of the messages; the first makes the link careful, with the second it goes down, with the third
# nothing is lost any more.
LOSSY, LOSS_MOST, LOSSLESS = 0.08, 0.5, 0.01
# With that, and while things wait, another radio is there, which bears far less.
FLOOD = 0.4
# So much of what is carried is sent from then on; less of it the first time, when the queues are
# full and nobody knows how long the way is without them. Then by such a part more each second: up
# to near what was too much, around that, and beyond it, where the part grows each second. What came
# before the first cut was whole pictures, or rather was not, and another radio bears nobody knows
# what: that is found out quickly.
CUT, FIRST_CUT = 0.85, 0.6
GROWTH, AROUND_GROWTH, BEYOND_GROWTH = 0.03, 0.015, 0.01
FIRST_GROWTH, NEW_GROWTH = 0.15, 0.5
NEAR, BEYOND = 0.85, 1.15
# Never by less than this: who has little gains on who has much, so that robots that share a radio
# come to the same [bytes/s^2].
_LEAST_GROWTH, _LEAST_FIRST = 1300.0, 3000.0
# Who has more than this gives way sooner, who has less later [bytes/s].
_MIDDLE = 30000.0
# What is not used says nothing about the radio: no more than this times what came.
_USED = 2.0
# What came in half a second varies: a cut believes no less than this part of what was sent.
_SURELY = 0.7
# What was sent before a cut is still on its way [s]; right after the first no picture joins it.
SETTLE_S, QUIET_S = 1.0, 0.5
# After the first one the queues get empty: for so long, or if that does not show, for longer, and
# until they have not become emptier for a while [s].
DRAIN_S, LONG_DRAIN_S, FELL_S = 1.0, 3.0, 0.5
# What does not wait for less after two cuts, or the first, does not wait because of what is sent:
# the way has become longer, or others fill it [s].
_FALLS_S = 0.03
# So many reports in a row say that the radio does not bear all, or one by what is lost and waits.
BAD = 3
LEAST_BYTES_PER_S = 8000.0


class Meter:
    """Counts what comes in; times are [s] of a clock that never goes back."""

    def __init__(self) -> None:
        self._session = -1
        self._came: Deque[Tuple[float, int, float]] = deque()
        self._counts: Deque[Tuple[float, int]] = deque()
        self._lost = 0
        self._numbers: Dict[str, Tuple[int, float]] = {}
        self._bases: Deque[List[float]] = deque(maxlen=_BASES)

    def note(self, topic: str, frame: Frame, size: int, now: float) -> None:
        """Take in a message that came.

        :param size: of all of it [bytes]
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
        # The numbers begin again some day; what a stream lost long ago is no news.
        gap = gap if 0 <= gap < 1000 and now - last_at < LOSS_WINDOW_S else 0
        self._counts.append((now, gap))
        self._lost += gap
        self._forget(now)

    def _forget(self, now: float) -> None:
        while self._came and self._came[0][0] < now - WINDOW_S:
            self._came.popleft()
        while self._counts and self._counts[0][0] < now - LOSS_WINDOW_S:
            self._lost -= self._counts.popleft()[1]

    def read(self, now: float) -> Heard:
        """Return what came lately; of nothing, zeros."""
        self._forget(now)
        if not self._came:
            return Heard(0.0, 0.0, 0.0)
        delays = sorted(delay_s for _, _, delay_s in self._came)
        base = min(found for _, found in self._bases)
        return Heard(sum(size for _, size, _ in self._came) / WINDOW_S,
                     delays[len(delays) // 2] - base,
                     self._lost / (self._lost + len(self._counts)))


class Bearing:
    """How many bytes a second may be sent; infinite as long as the radio bears everything.

    Begins without a limit: what comes of that shows within a second what the radio bears.
    """

    def __init__(self) -> None:
        self.bytes_per_s = math.inf
        self.loss = 0.0
        self._cut_at = self._full_at = self._fell_at = -math.inf
        self._top = self._cut_loss = self._own_loss = 0.0
        self._heard_at = -math.inf
        self._bad = 0
        # Draining after the first cut, at first without pictures; then growing by such a part each
        # second, 0 for slowly.
        self.drains, self.quiet, self._fast = False, False, 0.0
        # Of a row of cuts that did not help: how many, and what was sent before.
        self._vain, self._before = 0, math.inf
        self._waited_s = self._longer_s = self._last_s = 0.0

    @property
    def bound(self) -> bool:
        """Whether less is sent than there is."""
        return math.isfinite(self.bytes_per_s)

    def on_heard(self, heard: Heard, demand: float, now: float) -> None:
        """Take in what the other side says that came.

        :param demand: all that would be sent without a limit [bytes/s]
        """
        step_s = min(1.0, now - self._heard_at)
        self._heard_at, self.loss = now, heard.loss
        self._longer_s = min(self._longer_s, heard.queue_s)
        queue_s = heard.queue_s - self._longer_s
        # What was lost before a cut counts no more.
        most_s, calm_s = self._limits_s()
        full = queue_s > most_s or (
            heard.loss > LOSS_MOST and now - self._cut_at > LOSS_WINDOW_S + 2.0 * SETTLE_S)
        if full:
            self._full_at = now
        elif now - self._full_at > LOSS_WINDOW_S + SETTLE_S:
            # Nothing of it was lost in a full queue.
            self._own_loss += 0.1 * (heard.loss - self._own_loss)
        if not self.bound:
            self._begin(heard, full, now)
        elif self.drains:
            self._drain(heard, now)
        elif full and heard.loss > FLOOD and now - self._cut_at > SETTLE_S:
            self._first_cut(heard, now)
        elif full:
            # On a long way it takes a while until what waits gets less.
            falls = queue_s < self._last_s and now - self._cut_at < 2.0 * SETTLE_S
            if now - self._cut_at >= SETTLE_S and not falls:
                self._again(heard, queue_s, now)
        elif queue_s < calm_s and now - self._cut_at > SETTLE_S:
            self._grow(heard, step_s, demand, now)
        self.quiet = self.drains and now - self._cut_at < QUIET_S
        self._last_s = queue_s

    def _limits_s(self) -> Tuple[float, float]:
        """Return what is too long to wait, and what is short [s]: for who has much, sooner."""
        scale = min(2.0, max(0.8, math.sqrt(_MIDDLE / self.bytes_per_s)))
        return QUEUE_MOST_S * scale, QUEUE_CALM_S * scale

    def _carried(self, heard: Heard) -> float:
        """Return what the radio carries, with what it loses itself [bytes/s]."""
        return heard.bytes_per_s / (1.0 - min(LOSS_MOST, self._own_loss))

    def _begin(self, heard: Heard, full: bool, now: float) -> None:
        """Look whether the radio bears everything still."""
        # For a moment it may be the computer, which loses nothing, or a radio that only loses.
        lossy = heard.loss > LOSSY
        self._bad = self._bad + (BAD if full and lossy else 1) if full or lossy else 0
        if self._bad >= BAD or heard.loss > LOSS_MOST:
            self._first_cut(heard, now)

    def _first_cut(self, heard: Heard, now: float) -> None:
        """Begin anew with what comes: what was sent was far too much."""
        self.bytes_per_s = math.inf
        self._cut(heard, now, FIRST_CUT)
        self.drains, self._waited_s = True, max(heard.queue_s, _FALLS_S + QUEUE_CALM_S)

    def _drain(self, heard: Heard, now: float) -> None:
        """See whether what waits gets less still; what was sent before may let it grow at first."""
        self._top = max(self._top, self._carried(heard))
        fell = self._fell_at > self._cut_at
        if heard.queue_s < self._waited_s - _FALLS_S:
            self._waited_s, self._fell_at = heard.queue_s, now
        elif not fell:
            self._waited_s = max(self._waited_s, heard.queue_s)
        # Others may not have begun yet, or the computer is slow: then it takes longer.
        if now - self._cut_at >= (DRAIN_S if fell else LONG_DRAIN_S) \
                and now - self._fell_at >= FELL_S:
            self._drained(heard)

    def _drained(self, heard: Heard) -> None:
        """Take what things still wait for as the length of the way."""
        if heard.queue_s > QUEUE_CALM_S:
            self._longer_s = heard.queue_s
        self.bytes_per_s = max(self.bytes_per_s, CUT * self._top)
        self.drains, self._fast = False, FIRST_GROWTH

    def _again(self, heard: Heard, queue_s: float, now: float) -> None:
        """Cut once more, or see that it does not help."""
        falls = now - self._cut_at > 2.0 * SETTLE_S or queue_s < self._waited_s - _FALLS_S
        self._vain = 0 if falls else self._vain + 1
        if not self._vain:
            self._before = self.bytes_per_s
        self._waited_s, self._fast = queue_s, 0.0
        if self._vain < 2 or queue_s <= self._limits_s()[0]:
            self._cut(heard, now, CUT)
        else:
            self._longer_s, self._vain = heard.queue_s, 0
            self.bytes_per_s, self._fast = self._before, FIRST_GROWTH

    def _cut(self, heard: Heard, now: float, part: float) -> None:
        carried = self._carried(heard)
        if now - self._cut_at > 2.0 * SETTLE_S:
            # At first it is unknown what was sent.
            self._top = self.bytes_per_s if self.bound else carried
        if self.bound:
            carried = max(carried, _SURELY * self.bytes_per_s)
        self.bytes_per_s = max(LEAST_BYTES_PER_S, part * min(carried, self.bytes_per_s))
        self._cut_at, self._bad, self._cut_loss = now, 0, heard.loss

    def _grow(self, heard: Heard, step_s: float, demand: float, now: float) -> None:
        if self._cut_loss > LOSSY and self.loss < LOSSLESS:
            # Another radio: nobody knows what it bears.
            self._cut_loss, self._fast = 0.0, NEW_GROWTH
        calm_s = now - self._cut_at - SETTLE_S
        if self._fast:
            share = self._fast
        elif self.bytes_per_s < NEAR * self._top:
            share = GROWTH
        else:
            beyond = self.bytes_per_s > BEYOND * self._top
            share = min(1.0, BEYOND_GROWTH * calm_s) if beyond else AROUND_GROWTH
        least = _LEAST_FIRST if self._fast else _LEAST_GROWTH
        grown = self.bytes_per_s + step_s * max(share * self.bytes_per_s, least)
        self.bytes_per_s = max(self.bytes_per_s, min(grown, _USED * self._carried(heard)))
        if self.bytes_per_s >= 1.2 * demand and self.loss < 0.5 * LOSSY:
            self.bytes_per_s = math.inf
