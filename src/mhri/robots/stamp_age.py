# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the delay of stamped messages from a robot whose clock may be off by any amount."""
from typing import Optional

# Stamps below this [s since 1970] are simulated time, or from a clock that was never set.
SET_SINCE_S = 1e9
# Rate of forgetting the minimum delay [s/s], since clocks drift: 0.05 % is more than the drift of
# any quartz, and far less than a creeping delay.
LEAK = 5e-4
# After a clock was set back delays are unknown for this long [s].
SETTLE_S = 1.0


def delay_of(received_s: float, stamp_s: float) -> Optional[float]:
    """Return the time from a stamp to the receipt of its message [s], by two clocks.

    :param received_s: by the local clock [s since 1970]
    :returns: None if the stamp is not real time: see :data:`SET_SINCE_S`
    """
    return None if stamp_s < SET_SINCE_S <= received_s else received_s - stamp_s


class StampAge:
    """Compares the delay of each message with the minimum delay so far.

    The minimum delay (time of receipt minus stamp) is the clock offset plus the fastest transit. A
    message is late by the excess over it. Not thread-safe; times of receipt are seconds of a
    monotonic clock.
    """

    def __init__(self) -> None:
        # Of the previous message; None before the first: then the other fields are meaningless.
        self._stamp_s: Optional[float] = None
        self._least_s = self._now = self._settled_at = 0.0

    def late_s(self, stamp_s: Optional[float], now: float) -> Optional[float]:
        """Handle one message; return how late it is [s, >= 0].

        :param stamp_s: if None, or below :data:`SET_SINCE_S`, the result is 0
        :returns: None if unknown: for :data:`SETTLE_S` after the first message, and after one
            stamped earlier than its predecessor
        """
        if stamp_s is None or stamp_s < SET_SINCE_S:
            return 0.0
        delay_s = now - stamp_s
        if self._stamp_s is None or stamp_s < self._stamp_s:
            self._least_s, self._settled_at = delay_s, now + SETTLE_S
        else:
            self._least_s = min(delay_s, self._least_s + LEAK * (now - self._now))
        self._stamp_s, self._now = stamp_s, now
        return delay_s - self._least_s if now >= self._settled_at else None

    def since_s(self, stamp_s: float, now: float) -> float:
        """Return the age of a stamp of that clock, minus the fastest transit [s].

        :returns: 0 if that is unknown, as in simulated time
        """
        if self._stamp_s is None or stamp_s < SET_SINCE_S:
            return 0.0
        return max(0.0, now - stamp_s - self._least_s)
