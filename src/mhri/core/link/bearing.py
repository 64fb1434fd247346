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

from mhri.core.link.frames import Frame, Heard

# What is around each message on the air: IP, UDP and zenoh's own [bytes].
AROUND_BYTES = 60
# Over which time it is counted what came, and what was lost [s].
WINDOW_S, LOSS_WINDOW_S = 0.5, 2.0
# The quickest message of so many such times is the base of what waits.
_BASE_S, _BASES = 10.0, 2
# Waiting for longer is too much, for less leaves room for more [s].
QUEUE_MOST_S, QUEUE_CALM_S = 0.07, 0.03
# Of the messages; the first makes the link careful, with the second it goes down.
LOSSY, LOSS_MOST = 0.08, 0.5
# So much of what came is sent from then on; then by such a part more each second: up to near what
# was too much, around that, and beyond it, where the part grows each second. What came before the
# first cut was whole pictures, or rather was not: up to the second it is made up for quickly.
CUT, GROWTH, AROUND_GROWTH, BEYOND_GROWTH, FIRST_GROWTH = 0.85, 0.05, 0.015, 0.01, 1.0
NEAR, BEYOND = 0.85, 1.15
# What was sent before a cut is still on its way [s].
SETTLE_S = 1.0
# What does not wait for less after two cuts does not wait because of what is sent: the way has
# become longer, or others fill it [s].
_FALLS_S = 0.03
# So many reports in a row say that the radio does not bear all.
BAD = 3
LEAST_BYTES_PER_S = 8000.0
_LEAST_GROWTH = 1000.0


class Meter:
    """Counts what comes in; times are [s] of a clock that never goes back."""

    def __init__(self) -> None:
        self._session = -1
        self._came: Deque[Tuple[float, int, float]] = deque()
        self._counts: Deque[Tuple[float, int]] = deque()
        self._lost = 0
        self._numbers: Dict[str, int] = {}
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
        gap = frame.number - self._numbers.get(topic, frame.number - 1) - 1
        self._numbers[topic] = frame.number
        # The numbers begin again some day.
        gap = gap if 0 <= gap < 1000 else 0
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
        self._cut_at = -math.inf
        self._top = 0.0
        self._heard_at = -math.inf
        self._bad = 0
        self._first = False
        # Of a row of cuts that did not help: how many, and what was sent before.
        self._vain, self._before = 0, math.inf
        self._waited_s = self._longer_s = 0.0

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
        full = queue_s > QUEUE_MOST_S or heard.loss > LOSS_MOST
        if not self.bound:
            # For a moment it may be the computer.
            self._bad = self._bad + 1 if full or heard.loss > LOSSY else 0
            if self._bad >= BAD:
                self._cut(heard, now)
                self._first = True
        elif full:
            if now - self._cut_at >= SETTLE_S:
                self._again(heard, queue_s, now)
        elif queue_s < QUEUE_CALM_S and now - self._cut_at > SETTLE_S:
            self._grow(step_s, demand, now)

    def _again(self, heard: Heard, queue_s: float, now: float) -> None:
        """Cut once more, or see that it does not help."""
        falls = now - self._cut_at > 2.0 * SETTLE_S or queue_s < self._waited_s - _FALLS_S
        self._vain = 0 if falls else self._vain + 1
        if not self._vain:
            self._before = self.bytes_per_s
        self._waited_s, self._first = queue_s, False
        if self._vain < 2 or queue_s <= QUEUE_MOST_S:
            self._cut(heard, now)
        else:
            self._longer_s, self._vain = heard.queue_s, 0
            self.bytes_per_s, self._first = self._before, True

    def _cut(self, heard: Heard, now: float) -> None:
        if now - self._cut_at > 2.0 * SETTLE_S:
            # At first it is unknown what was sent.
            self._top = self.bytes_per_s if self.bound else heard.bytes_per_s
        self.bytes_per_s = max(LEAST_BYTES_PER_S,
                               CUT * min(heard.bytes_per_s, self.bytes_per_s))
        self._cut_at, self._bad = now, 0

    def _grow(self, step_s: float, demand: float, now: float) -> None:
        calm_s = now - self._cut_at - SETTLE_S
        if self._first:
            share = FIRST_GROWTH
        elif self.bytes_per_s < NEAR * self._top:
            share = GROWTH
        else:
            beyond = self.bytes_per_s > BEYOND * self._top
            share = min(1.0, BEYOND_GROWTH * calm_s) if beyond else AROUND_GROWTH
        grown = self.bytes_per_s + step_s * max(share * self.bytes_per_s, _LEAST_GROWTH)
        # Nobody knows what a radio bears beyond what it was given.
        self.bytes_per_s = max(self.bytes_per_s, min(grown, 2.0 * demand))
        if self.bytes_per_s >= 1.5 * demand and self.loss < 0.5 * LOSSY:
            self.bytes_per_s = math.inf
