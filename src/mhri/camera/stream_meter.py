# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rate and bandwidth of a stream over the last seconds."""
from collections import deque
from typing import Deque, Tuple

WINDOW_S = 2.0
_MAX_MESSAGES = 2000


class StreamMeter:
    """Counts received messages; not thread-safe, times are passed in."""

    def __init__(self, window_s: float = WINDOW_S) -> None:
        self._window_s = window_s
        self._came: Deque[Tuple[float, int]] = deque()
        self._bytes = 0

    def add(self, now: float, size: int) -> None:
        """Count a message of this size [bytes]."""
        self._came.append((now, size))
        self._bytes += size
        self._prune(now)

    def set_window(self, window_s: float) -> None:
        """Set the length of the window [s]."""
        self._window_s = window_s

    def _prune(self, now: float) -> None:
        while self._came and (self._came[0][0] < now - self._window_s
                              or len(self._came) > _MAX_MESSAGES):
            self._bytes -= self._came.popleft()[1]

    def read(self, now: float) -> Tuple[float, float]:
        """Return (messages per second, bits per second); the rate is 0 below two messages."""
        self._prune(now)
        if not self._came:
            return 0.0, 0.0
        first, last = self._came[0][0], self._came[-1][0]
        # From the first to the last message; when the stream ends, the rate falls at once.
        span = max(last - first, now - first - 2.0 * (last - first) / max(1, len(self._came) - 1))
        if len(self._came) < 2 or span <= 0.0:
            return 0.0, 8.0 * self._came[0][1] / self._window_s
        rate = (len(self._came) - 1) / span
        return rate, 8.0 * rate * self._bytes / len(self._came)
