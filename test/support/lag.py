# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How late a busy computer is."""
import bisect
import threading
import time


class LagMeter:
    """How late this computer is: a thread that wants to wake up every 10 ms.

    :param slack_s: what is allowed at all times [s]
    """

    def __init__(self, slack_s):
        self._slack_s = slack_s
        self._times, self._lags = [], []
        self._done = threading.Event()
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        due = time.monotonic()
        while not self._done.is_set():
            due += 0.01
            time.sleep(max(0.0, due - time.monotonic()))
            now = time.monotonic()
            if now - due > 0.02:
                self._times.append(now)
                self._lags.append(now - due)
                due = now

    def stop(self):
        """Measure no more."""
        self._done.set()

    def slack_s(self, now):
        """Return what to allow for lateness: twice the worst of the last 3 s more than usual."""
        low = bisect.bisect_left(self._times, now - 3.0)
        high = bisect.bisect_right(self._times, now + 0.1)
        return self._slack_s + 2.0 * max(self._lags[low:high], default=0.0)
