# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether a program was awake itself, and whether it hears another one: mux and gates.

After a sleep, what it finds in its sockets is old, and the silence of others proves nothing.
"""
from typing import Optional, Tuple

# A loop that runs ten times a second has slept if it was away for this long.
SLEPT_S = 0.5
# After a sleep nothing counts for this long: by then the sockets hold nothing old.
DEAF_S = 0.3
# A message that waited no longer than this is new enough for a robot on a task.
NEW_S = 0.25
# A node that repeats its state twice a second is silent after this long.
SILENT_S = 0.9
# One that hangs has been replaced by then, if anybody looks after it
# (:mod:`mhri.graph.ros.stand_by`).
_REPLACED_S = 5.0


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


class Neighbour:
    """Knows by its heartbeat whether a node is silent.

    Times are seconds of a clock that never goes back. :meth:`beat` and :meth:`look` may be called
    on different threads.

    :param label: its name in words, e.g. ``the gates``
    """

    def __init__(self, label: str) -> None:
        self._label = label
        self._heard: Optional[Tuple[str, float]] = None
        self._looked_at: Optional[float] = None
        self.silent = False

    def beat(self, caller: str, now: float) -> None:
        """Note that the node was heard."""
        self._heard = caller, now

    def look(self, now: float) -> str:
        """Set ``silent``; call it at least every 0.4 s.

        :returns: the line to log if the node has fallen silent or is heard again, else ''
        """
        late = self._looked_at is not None and now - self._looked_at > SLEPT_S
        self._looked_at = now
        if self._heard is None:
            return ''
        caller, at = self._heard
        if late:
            self._heard = caller, now
            at = now
        was, self.silent = self.silent, now - at > SILENT_S
        if self.silent == was:
            return ''
        return '{} ({}): {}'.format(self._label, caller, 'silent for {:.1f} s'.format(
            now - at) if self.silent else 'heard again')

    def words(self, now: float) -> str:
        """Return what is known about it, in words for the diagnostics."""
        if self._heard is None:
            return 'not heard yet'
        caller, at = self._heard
        if not self.silent:
            return '{} is heard'.format(caller)
        return '{} has been silent for {:.0f} s{}'.format(
            caller, now - at, ': end it and start it again' if now - at > _REPLACED_S else '')
