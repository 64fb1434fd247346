# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A request that has been sent but not granted yet."""
import time

from python_qt_binding.QtCore import Qt, QTimer

NUMBERS_PERIOD_S = 0.25


class Pending:
    """Bridges the time from a click to the answer, so that a control does not flicker.

    The requested value is shown until the actual one agrees, or for at most ``timeout_s``; then the
    actual one is shown again.

    :param timeout_s: how long a request may stay unanswered [s]
    :param expired: function that shows the actual value after that time
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, timeout_s, expired=None, clock=time.monotonic):
        self.timeout_s = timeout_s
        self._clock = clock
        #: the requested value if not granted yet, or None
        self.value = None
        self._until = None
        # A coarse timer may fire before the request has expired.
        self._timer = QTimer(singleShot=True, timerType=Qt.PreciseTimer)
        if expired is not None:
            self._timer.timeout.connect(expired)

    def ask(self, value):
        """Store a requested value."""
        self.value = value
        self._until = self._clock() + self.timeout_s
        self._timer.start(round(1000 * self.timeout_s) + 20)

    def drop(self):
        """Discard the request."""
        self.value = self._until = None

    def settle(self, actual):
        """Return the value to show, given the actual one; drop a granted or expired request."""
        if self._until is not None and (actual == self.value or self._clock() >= self._until):
            self.drop()
        return actual if self._until is None else self.value


class Pace:
    """Limits the rate of updates to one per ``period_s``.

    :param period_s: by default a period for readable numbers
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, period_s=NUMBERS_PERIOD_S, clock=time.monotonic):
        self._period_s = period_s
        self._clock = clock
        self._next = None

    def due(self):
        """Return whether an update is due now; True counts as an update."""
        now = self._clock()
        if self._next is not None and now < self._next:
            return False
        self._next = now + self._period_s
        return True
