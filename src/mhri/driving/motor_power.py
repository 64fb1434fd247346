# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's motor power: what to tell the robot next, and what is known about it."""
from typing import Optional

# Words for the state. Empty: nobody has asked for anything, or the power was restored.
UNTOUCHED = ''
CUT_ASKED = 'cut asked'
CUT_SENT = 'cut sent'        # handed to the robot, which has no way to confirm it
CUT = 'cut'                  # the robot has confirmed it
RESTORE_ASKED = 'restore asked'
FAILED = 'failed: {}'

RETRY_S = 1.0
# After this long a robot that cannot be told to power up is left alone: nobody still waits for it.
RESTORE_FOR_S = 10.0


class MotorPowerRule:
    """Decides what to tell one robot; time is seconds of a clock that never goes back.

    To cut the power it keeps trying until the robot has been told, and tells every new listener
    again. To restore it, it tries for :data:`RESTORE_FOR_S`. It never restores power unasked.
    """

    def __init__(self) -> None:
        self._cut: Optional[bool] = None
        self._pending = False
        self._due_at = 0.0
        self._asked_at = 0.0
        self.state = UNTOUCHED

    @property
    def is_cut(self) -> bool:
        """Whether the power should stay cut."""
        return bool(self._cut)

    def ask(self, cut: bool, now: float) -> None:
        """Take in what is wanted: cut (True) or restore (False)."""
        if cut and self._cut and not self._pending:
            return
        self._cut, self._pending = cut, True
        self._due_at = self._asked_at = now
        self.state = CUT_ASKED if cut else RESTORE_ASKED

    def due(self, now: float) -> Optional[bool]:
        """Return what to tell the robot now: True (cut), False (restore) or None (nothing)."""
        return self._cut if self._pending and now >= self._due_at else None

    def wait_s(self, now: float) -> Optional[float]:
        """Return how long :meth:`due` will return None by itself [s]; None: until asked."""
        return max(0.0, self._due_at - now) if self._pending else None

    def on_told(self, cut: bool, confirmed: bool, now: float) -> None:
        """Take in that the robot was told.

        :param confirmed: whether the robot has confirmed it
        """
        if self._is_overtaken(cut, now):
            return
        self._pending = False
        self.state = (CUT if confirmed else CUT_SENT) if cut else UNTOUCHED

    def _is_overtaken(self, cut: bool, now: float) -> bool:
        """Tell whether something else is wanted by now; that is then told once more, last."""
        if cut == self._cut:
            return False
        self._pending, self._due_at, self._asked_at = True, now, now
        return True

    def on_failed(self, cut: bool, problem: object, now: float) -> None:
        """Take in why the robot could not be told; it is tried again later."""
        if self._is_overtaken(cut, now):
            return
        self.state = FAILED.format(problem)
        self._due_at = now + RETRY_S
        self._pending = cut or now - self._asked_at < RESTORE_FOR_S

    def tell_again(self, now: float) -> None:
        """Take in that a new listener has come, which does not know about a cut."""
        if self._cut:
            self._pending, self._due_at = True, now
