# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detection that a program was suspended: afterwards, the messages in its sockets are old."""

# A loop that runs ten times a second was suspended if it paused for this long [s].
SLEPT_S = 0.5
# After a suspension messages are discarded for this long [s]; then the sockets hold no old ones.
DEAF_S = 0.3
# Maximum waiting time of a message for a robot on a task [s].
NEW_S = 0.25


class SleepDetector:
    """Detects by its own beat that the program was suspended (SIGSTOP, a debugger, system suspend).

    Stamps do not help: they may be missing, or come from another computer's clock.

    :param now: the time of creation [s], of a clock that runs while the program is suspended
    """

    def __init__(self, now: float) -> None:
        self._beat_at = now
        self._deaf_until = now

    def beat(self, now: float) -> None:
        """Store that the loop has run; call it ten times a second."""
        self._beat_at = now

    def slept(self, now: float) -> bool:
        """Return whether the program was suspended, once per suspension; call it first."""
        if now - self._beat_at < SLEPT_S:
            return False
        self._beat_at = now
        self._deaf_until = now + DEAF_S
        return True

    def discards_backlog(self, now: float) -> bool:
        """Return whether a message received now may have been sent before a suspension."""
        return now < self._deaf_until

    def is_new(self, now: float) -> bool:
        """Return whether a message received now is newer than :data:`NEW_S`."""
        return not self.discards_backlog(now) and now - self._beat_at < NEW_S
