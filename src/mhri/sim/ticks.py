# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The schedule of a simulated robot: steps at absolute times, and their due actions."""
import time


class Ticks:
    """A clock of equal steps at absolute times: it does not drift, and skips missed steps.

    :param step_s: the length of a step [s]
    :param clock: monotonic seconds
    :param sleep: function (seconds)
    """

    def __init__(self, step_s, clock=time.monotonic, sleep=time.sleep):
        self._step_s = step_s
        self._clock = clock
        self._sleep = sleep
        self._begun = self._last = clock()
        self._number = 0

    def wait(self):
        """Sleep until the next step; return (its number, now [s], seconds since the one before)."""
        passed = int((self._clock() - self._begun) / self._step_s)
        self._number = max(self._number, passed) + 1
        left = self._begun + self._number * self._step_s - self._clock()
        if left > 0.0:
            self._sleep(left)
        now = self._clock()
        took, self._last = now - self._last, now
        return self._number, now, took


class Due:
    """Determines the ticks at which an action of every n-th tick is due.

    If ticks are skipped, it is due at the next one.
    """

    def __init__(self, every):
        self._every = every
        self._next = 0

    def at(self, number):
        """Return whether the action is due at a tick; numbers have to increase."""
        if number < self._next:
            return False
        self._next = number - number % self._every + self._every
        return True
