# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's motor power: the next request to the robot, and the known state."""
from typing import Optional

# The state, as ``power`` of mhri/RobotDrive; empty before the first request.
UNTOUCHED, CANNOT, CUT_ASKED, RESTORE_ASKED = '', 'cannot', 'cut_asked', 'restore_asked'
CUT_SENT = 'cut_sent'        # handed to the robot, which has no way to confirm it
CUT, ON, FAILED = 'cut', 'on', 'failed'

RETRY_S = 1.0
# A robot that cannot be reached is asked for this long to restore power [s].
RESTORE_FOR_S = 10.0


class MotorPowerRule:
    """Decides what to request of one robot; time is seconds of a monotonic clock.

    A cut is repeated until it has been delivered, and sent again to every new subscriber. Power is
    restored only on request, with attempts for :data:`RESTORE_FOR_S`.
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
        """Handle a request to cut (True) or restore (False) the power."""
        if cut and self._cut and not self._pending:
            return
        self._cut, self._pending = cut, True
        self._due_at = self._asked_at = now
        self.state = CUT_ASKED if cut else RESTORE_ASKED

    def due(self, now: float) -> Optional[bool]:
        """Return the request to send now: True (cut), False (restore) or None (nothing)."""
        return self._cut if self._pending and now >= self._due_at else None

    def wait_s(self, now: float) -> Optional[float]:
        """Return for how long :meth:`due` will return None [s]; None until the next request."""
        return max(0.0, self._due_at - now) if self._pending else None

    def on_delivered(self, cut: bool, confirmed: bool, now: float) -> None:
        """Handle the delivery of a request.

        :param confirmed: whether the robot has confirmed it
        """
        if self._is_overtaken(cut, now):
            return
        self._pending = False
        self.state = (CUT if confirmed else CUT_SENT) if cut else ON

    def _is_overtaken(self, cut: bool, now: float) -> bool:
        """Return whether the opposite is requested by now; if so, schedule that once more."""
        if cut == self._cut:
            return False
        self._pending, self._due_at, self._asked_at = True, now, now
        return True

    def on_failed(self, cut: bool, now: float) -> None:
        """Handle a failed delivery: try again later."""
        if self._is_overtaken(cut, now):
            return
        self.state = FAILED
        self._due_at = now + RETRY_S
        self._pending = cut or now - self._asked_at < RESTORE_FOR_S

    def resend(self, now: float) -> None:
        """Handle a new subscriber, which has not received a cut."""
        if self._cut:
            self._pending, self._due_at = True, now
