# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""When a simulated robot does what: steps at absolute times, and what is due at which of them."""
import time


class Ticks:
    """A clock of equal steps at absolute times: it does not drift, and steps missed are skipped.

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
    """Tells which of the ticks are the turn of something that comes at every n-th of them.

    Where ticks are skipped, the turn that was missed is taken at the next one.
    """

    def __init__(self, every):
        self._every = every
        self._next = 0

    def at(self, number):
        """Tell whether it is due at the tick of this number, which only ever grows."""
        if number < self._next:
            return False
        self._next = number - number % self._every + self._every
        return True
