# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether the mux itself was awake: after a sleep, what it finds in its sockets is old."""

# A loop that runs ten times a second has slept if it was away for this long.
SLEPT_S = 0.5
# After a sleep nothing counts for this long: by then the sockets hold nothing old.
DEAF_S = 0.3
# A message that waited no longer than this is new enough for a robot on a task.
NEW_S = 0.25


class Pulse:
    """Detects by its own beat that the program was stopped (SIGSTOP, a debugger, a suspend).

    Stamps are no help: they may be missing, or come from another computer's clock.

    :param now: the time of creation [s], of a clock that goes on while the program is stopped
    """

    def __init__(self, now: float) -> None:
        self._beat_at = now
        self._deaf_until = now

    def beat(self, now: float) -> None:
        """Note that the loop has run; call it ten times a second."""
        self._beat_at = now

    def slept(self, now: float) -> bool:
        """Tell, once for each sleep, that there was one; ask before doing anything else."""
        if now - self._beat_at < SLEPT_S:
            return False
        self._beat_at = now
        self._deaf_until = now + DEAF_S
        return True

    def deaf(self, now: float) -> bool:
        """Tell whether a message heard now may have been sent before a sleep."""
        return now < self._deaf_until

    def is_new(self, now: float) -> bool:
        """Tell whether a message heard now is newer than :data:`NEW_S`."""
        return not self.deaf(now) and now - self._beat_at < NEW_S
