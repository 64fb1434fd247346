# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A request that has been sent and not been granted yet."""
import time


class Pending:
    """Bridges the time from a click to the answer, so that a control neither flickers nor lies.

    The value asked for is shown until the actual one agrees, or for at most ``timeout_s``; then the
    actual one is shown again, whatever was clicked.

    :param timeout_s: how long a request may stay unanswered [s]
    :param clock: function returning seconds that never go back
    """

    def __init__(self, timeout_s, clock=time.monotonic):
        self.timeout_s = timeout_s
        self._clock = clock
        self._value = None
        self._until = None

    @property
    def value(self):
        """The value asked for and not granted yet, or None."""
        return self._value

    def ask(self, value):
        """Take note that a value has been asked for."""
        self._value = value
        self._until = self._clock() + self.timeout_s

    def drop(self):
        """Forget the request."""
        self._value = self._until = None

    def settle(self, actual):
        """Return the value to show, given the actual one; forgets what is granted or too old."""
        if self._until is not None and (actual == self._value or self._clock() >= self._until):
            self.drop()
        return actual if self._until is None else self._value


class Pace:
    """Lets through one of many updates: at most one in ``period_s``.

    :param clock: function returning seconds that never go back
    """

    def __init__(self, period_s, clock=time.monotonic):
        self._period_s = period_s
        self._clock = clock
        self._next = None

    def due(self):
        """Tell whether an update may pass now; True counts as passed."""
        now = self._clock()
        if self._next is not None and now < self._next:
            return False
        self._next = now + self._period_s
        return True
