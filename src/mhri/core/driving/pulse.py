# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether the mux itself was awake: what it finds in its sockets after a sleep is old."""

# A loop that comes round ten times a second and was away for so long has slept.
SLEPT_S = 0.5
# After it, this long nothing counts: by then the sockets hold nothing from before.
DEAF_S = 0.3
# A message that waited no longer than this is new enough for a robot on a task.
NEW_S = 0.25


class Pulse:
    """Knows from its own beat whether the program was stopped (SIGSTOP, a debugger, a suspend).

    Stamps cannot tell: they may be missing, or come from the clock of another computer.

    :param now: the time of creation [s], of a clock that goes on while the program is stopped
    """

    def __init__(self, now: float) -> None:
        self._beat_at = now
        self._deaf_until = now

    def beat(self, now: float) -> None:
        """Note that the loop has come round; call it ten times a second."""
        self._beat_at = now

    def slept(self, now: float) -> bool:
        """Tell, once for each sleep, that there was one; to be asked before anything is done."""
        if now - self._beat_at < SLEPT_S:
            return False
        self._beat_at = now
        self._deaf_until = now + DEAF_S
        return True

    def deaf(self, now: float) -> bool:
        """Tell whether what is heard now may have been said before a sleep."""
        return now < self._deaf_until

    def is_new(self, now: float) -> bool:
        """Tell whether a message heard now is newer than :data:`NEW_S`."""
        return not self.deaf(now) and now - self._beat_at < NEW_S
