# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rule of one accessory of one robot: when it acts, and when it is ended. No ROS, no clock.

A moving part is driving: it may act under the conditions under which its robot may
(:class:`mhri.driving.accessories.Accessories` decides), and every end of these conditions ends it.
What is held acts while its value is repeated: silent for 0.25 s, it is released. After an end it
acts again only once it was released: at neutral, or silent for as long.
"""
import math
from typing import Optional, Sequence, Tuple

from mhri.base.accessories import (
    Accessory, Act, ACTION, CANCEL, CANCELLED, HELD, POSITION, STOP)

# A held value that is silent for this long is released [s].
SILENT_S = 0.25
# The most values of a report that count.
_MAX_VALUES = 8


class AccessoryRule:
    """Decides what one accessory of one robot is sent; time is seconds of a monotonic clock.

    :param spec: :class:`mhri.base.accessories.Accessory`
    :param now: the time of creation [s]: what was held before has to be released first
    """

    def __init__(self, spec: Accessory, now: float) -> None:
        self.spec = spec
        #: whether a report was received
        self.known = False
        #: the choice last reported, '' for none
        self.choice = ''
        #: the values last reported
        self.value: Tuple[float, ...] = ()
        # The value it is sent now, () at rest; whether the goal of its action is under way.
        self._held: Tuple[float, ...] = ()
        self._goal = False
        # _released: the input was at neutral, or silent, since the last end.
        self._released = False
        self._asked_at, self._sent_at = now, -math.inf

    @property
    def held(self) -> bool:
        """Whether it is held away from its neutral value."""
        return bool(self._held)

    @property
    def active(self) -> bool:
        """Whether something has to be ended when the robot may no longer act."""
        return bool(self._held) or self._goal

    def act(self, choice: str, value: Sequence[float], now: float) -> Optional[Act]:
        """Handle an act that is possible and allowed; return what to send now, or None."""
        if self.spec.kind not in HELD:
            self._goal = self.spec.way == ACTION and self.spec.on_stop == CANCEL
            return Act(self.spec.key, choice)
        at_rest = not any(value)
        self._released = at_rest or not self.waits(now)
        self._asked_at = now
        if at_rest:
            return self._end()
        if not self._released:
            return None
        began, self._held = not self._held, self.spec.scaled(value)
        return self._send(now) if began else self.tick(now)

    def waits(self, now: float) -> bool:
        """Return whether what is held has to be released before it acts."""
        return self.spec.kind in HELD and not self._released and now - self._asked_at < SILENT_S

    def skip(self, now: float) -> Optional[Act]:
        """Handle an act that is not allowed: what is held ends, and is released before it counts.

        :returns: what to send now, or None
        """
        self._asked_at = now
        return self.end()

    def end(self) -> Optional[Act]:
        """End it, since its robot may no longer act; return what to send now, or None."""
        self._released = False
        return self._end()

    def _end(self) -> Optional[Act]:
        if self._goal:
            self._goal = False
            return Act(self.spec.key, CANCELLED, ends=True)
        if not self._held:
            return None
        self._held = ()
        return self._final()

    def _final(self) -> Optional[Act]:
        """Return what ends a motion: the neutral value, or the position last reported."""
        if self.spec.mode != POSITION:
            return Act(self.spec.key, value=self.spec.neutral, ends=True)
        # A neutral value would swing it; without a report, it goes on to the position it was sent.
        return Act(self.spec.key, value=self.value, ends=True) if self.known and len(
            self.value) == HELD[self.spec.kind] and self.spec.on_stop == STOP else None

    def tick(self, now: float) -> Optional[Act]:
        """Handle the passage of time: repeat a held value, or release it; return what to send."""
        if not self._held:
            return None
        if now - self._asked_at >= SILENT_S:
            self._released = True
            return self._end()
        return self._send(now) if now - self._sent_at >= 1.0 / self.spec.rate_hz else None

    def next_tick(self) -> Optional[float]:
        """Return when to call :meth:`tick` next [s], None if it is not urgent."""
        return min(self._sent_at + 1.0 / self.spec.rate_hz,
                   self._asked_at + SILENT_S) if self._held else None

    def _send(self, now: float) -> Act:
        self._sent_at = now
        return Act(self.spec.key, value=self._held)

    def on_report(self, value: Sequence[float], choice: str = '') -> bool:
        """Store what the robot reports; return whether it is news.

        A position that is not a number is none: a stop must not send it back.
        """
        if self.spec.kind in HELD and not all(map(math.isfinite, value)):
            value = ()
        before = self.known, self.value, self.choice
        self.known, self.value, self.choice = True, tuple(value[:_MAX_VALUES]), choice
        return before != (self.known, self.value, self.choice)

    def on_finished(self) -> None:
        """Handle the end of the goal of its action: nothing is left to cancel."""
        self._goal = False


def choice_of(spec: Accessory, values: Sequence[object]) -> str:
    """Return the choice that sends the first of some reported values, '' for none."""
    return next((word for word, fields in spec.choices
                 if [value for _, value in fields[:1]] == list(values[:1])), '')
