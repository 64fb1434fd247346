# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How late a stamped message is, from a robot whose clock may be off by any amount."""
from typing import Optional

# Stamps below this [s since 1970] are simulated time, or of a clock that was never set.
SET_SINCE_S = 1e9
# The least delay seen is forgotten this fast [s/s], since two clocks run apart: 0.05 % is more
# than any quartz is off, and far less than a delay that creeps.
LEAK = 5e-4
# After a clock was set back, what was known is worthless: nothing is known for so long [s].
SETTLE_S = 1.0


def delay_of(received_s: float, stamp_s: float) -> Optional[float]:
    """Return the time from a stamp to the receipt of its message [s], by two clocks.

    :param received_s: by the clock here [s since 1970]
    :returns: None where the stamp is none of that time: see :data:`SET_SINCE_S`
    """
    return None if stamp_s < SET_SINCE_S <= received_s else received_s - stamp_s


class StampAge:
    """Compares the delay of each message with the least that there was.

    The least delay (time of receipt less stamp) is clock offset and quickest way together. What a
    message took beyond that, it is late. Not thread-safe; the times of receipt are seconds of a
    clock that never goes back.
    """

    def __init__(self) -> None:
        # Of the message before; None before any, and then the others count for nothing.
        self._stamp_s: Optional[float] = None
        self._least_s = self._now = self._settled_at = 0.0

    def late_s(self, stamp_s: Optional[float], now: float) -> Optional[float]:
        """Take in one message; return by how much it is late [s, >= 0].

        :param stamp_s: None, or below :data:`SET_SINCE_S`: nothing can be said; it counts as 0
        :returns: None where that is not known: for :data:`SETTLE_S` after the first message, and
            after one that was stamped before the one ahead of it
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
