# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The proof of a stop: a robot is called stopped only when its own odometry reads standstill."""
from mhri.core.screen.views import (
    PROOF_NOT_CONFIRMED, PROOF_STOPPED, PROOF_WAITING, ProofView)

READINGS = 3
PATIENCE_S = 2.0
HEARING_S = 1.0


class StopProof:
    """Follows one robot from the moment of a stop; time is seconds of a clock that never goes back.

    States::

        WAITING        -> STOPPED        READINGS readings of standstill in a row
        WAITING        -> NOT_CONFIRMED  it still moves after PATIENCE_S, or nothing was heard from
                                         it for HEARING_S
        STOPPED        -> NOT_CONFIRMED  it moves again, or falls silent
        NOT_CONFIRMED  -> STOPPED        READINGS readings of standstill in a row

    The time given is that of the first reading of the row. One reading alone proves nothing: it may
    have been under way since before the stop. Where the robot was not heard for HEARING_S on the
    way to that reading it may have stood still long before, and the words say so: what comes first
    after a silence may be old.

    :param now: when the zero was sent
    """

    def __init__(self, now):
        self._begun = now
        self._heard = now
        self._run = 0
        self._run_began = now
        self._speed = None
        self.state = PROOF_WAITING
        self._stopped_ms = None
        # Whether nobody can tell when the robot came to rest: it was not heard all the while.
        self._unseen = False

    def on_motion(self, motion, now):
        """Take in one reading of the robot's odometry, received at ``now``."""
        silent = now - self._heard > HEARING_S
        if silent:
            self._run = 0
            if self._stopped_ms is None:
                self._unseen = True
        self._heard = now
        self._speed = motion
        if not motion.is_standstill():
            self._run = 0
            self._stopped_ms = None
            if self.state == PROOF_STOPPED:
                self.state = PROOF_NOT_CONFIRMED
            return
        if self._run == 0:
            self._run_began = now
        self._run += 1
        if self._run >= READINGS and self.state != PROOF_STOPPED:
            self.state = PROOF_STOPPED
            if self._stopped_ms is None:
                self._stopped_ms = max(0.0, (self._run_began - self._begun) * 1000.0)

    def view(self, now):
        """Let time pass and return the :class:`ProofView` of this moment."""
        silent = now - self._heard > HEARING_S
        late = self.state == PROOF_WAITING and now - self._begun > PATIENCE_S
        if silent or late:
            self.state = PROOF_NOT_CONFIRMED
            self._run = 0 if silent else self._run
        return ProofView(self.state, self._words(silent))

    @property
    def stopped_ms(self):
        """Time from the stop to the first reading of standstill [ms]; None while it moves."""
        return self._stopped_ms

    def _words(self, silent):
        if self.state == PROOF_STOPPED:
            if self._unseen:
                return 'standstill seen after {:.1f} s'.format(self._stopped_ms / 1000.0)
            return 'stopped in {:.0f} ms'.format(self._stopped_ms)
        if self.state == PROOF_WAITING:
            return 'stopping'
        if silent:
            return 'NOT CONFIRMED: it cannot be heard'
        if self._speed.is_standstill():
            return 'NOT CONFIRMED: at rest for less than {} readings'.format(READINGS)
        return 'NOT CONFIRMED: moves at {:.2f} m/s, {:.2f} rad/s'.format(
            abs(self._speed.linear_mps), abs(self._speed.angular_rad_s))
