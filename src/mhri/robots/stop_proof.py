# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The proof of a stop: a robot is called stopped only when its own odometry shows standstill.

And only if that odometry followed the commands before the stop: one that reports standstill
whatever the robot does proves nothing (:class:`OdometryWitness`).
"""
import math
from typing import Optional, Tuple

from mhri.base.limits import Velocity
from mhri.base.plausible import ANGULAR_VELOCITY, BOUNDS, SPEED
from mhri.base.reasons import NO_WITNESS
from mhri.base.robot_types import SILENT_AFTER_S
from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED, PROOF_WAITING, ProofView
from mhri.robots.link import Motion, STANDSTILL_MPS, STANDSTILL_RAD_S

READINGS = 3
# Minimum time from the first reading of a row to the last [s]: in less, a creeping pose looks at
# rest.
ROW_S = 0.1
TIMEOUT_S = 2.0
# A resting pose may jitter this much.
JITTER_M = 0.001
JITTER_RAD = 0.003
POSE_WINDOW_S = 1.0
# If the round trip is unknown, a stop and its answer may take this long together [s].
UNKNOWN_ROUND_TRIP_S = 0.25
# At slower commands a robot may rightly stand still: friction, noise, the smallest step of its
# motors [m/s, rad/s].
MIN_TOLD_MPS, MIN_TOLD_RAD_S = 0.05, 0.2
# A commanded robot moves within this time [s] plus the round trip; motors have to start.
FOLLOWS_WITHIN_S = 1.0


class PoseWatch:
    """Measures the speed of a pose, regardless of the velocities reported with it."""

    def __init__(self) -> None:
        self._anchor: Optional[Tuple[float, Motion]] = None

    def speed(self, motion: Motion, now: float) -> Tuple[float, float]:
        """Handle one reading; return the speed of the pose [m/s, rad/s], zeros at rest."""
        if self._anchor is None:
            self._anchor = (now, motion)
            return 0.0, 0.0
        since, anchor = self._anchor
        took_s = max(0.0, now - since)
        moved_m = math.hypot(motion.x_m - anchor.x_m, motion.y_m - anchor.y_m)
        turned_rad = 0.0 if motion.heading_rad is None or anchor.heading_rad is None else abs(
            math.remainder(motion.heading_rad - anchor.heading_rad, 2.0 * math.pi))
        rests = (moved_m <= JITTER_M + STANDSTILL_MPS * took_s
                 and turned_rad <= JITTER_RAD + STANDSTILL_RAD_S * took_s)
        if not rests or took_s >= POSE_WINDOW_S:
            self._anchor = (now, motion)
        if rests:
            return 0.0, 0.0
        return moved_m / max(took_s, 0.01), turned_rad / max(took_s, 0.01)


class OdometryWitness:
    """Judges whether a robot's odometry follows the commands.

    It no longer does after READINGS readings in a row show standstill although the robot should
    have been moving: commanded to for FOLLOWS_WITHIN_S, all pushes since it last moved together.
    Of speed and pose, or of turning if the command is only to turn. It does again with the first
    reading that shows motion while the command is to move. Wheels that slip at a wall show motion;
    a commanded robot whose wheels are held cannot be distinguished from one whose odometry hangs.

    Times are seconds of a clock that never goes back.

    :param follows: false if that has to be seen first: it was found by its message type alone
    """

    def __init__(self, follows: bool = True) -> None:
        self.follows = follows
        self._pose = PoseWatch()
        # Since when it is commanded, and only to turn; until when it was, and when it last moved.
        self._since: Optional[float] = None
        self._only_turns = False
        self._until = self._moved_at = -math.inf
        # {only to turn: for how long in earlier pushes since it moved [s]}
        self._told_s = {False: 0.0, True: 0.0}
        self._still = 0

    def asks(self, now: float) -> bool:
        """Return whether readings count: it is commanded to move, or may move on from a push."""
        return self._since is not None \
            or now - self._until <= FOLLOWS_WITHIN_S + UNKNOWN_ROUND_TRIP_S

    def on_command(self, velocity: Velocity, now: float) -> None:
        """Handle the velocity of the robot's command; may be called at any rate."""
        goes = velocity.speed_mps >= MIN_TOLD_MPS
        turns = not goes and abs(velocity.angular_rad_s) >= MIN_TOLD_RAD_S
        if self._since is not None and (self._only_turns != turns or not (goes or turns)):
            self._told_s[self._only_turns] += now - max(self._since, self._moved_at)
            self._since, self._until = None, now
        if self._since is None and (goes or turns):
            self._since, self._only_turns = now, turns

    def on_motion(self, motion: Motion, now: float, round_trip_s: float) -> None:
        """Handle a reading of the odometry while it :meth:`asks` for one.

        :param round_trip_s: of the link to the robot [s]; NaN: unknown
        """
        if not self.asks(now) or not motion.is_possible():
            return
        pose_mps, pose_rad_s = self._pose.speed(motion, now)
        moves = abs(motion.angular_rad_s) > STANDSTILL_RAD_S or pose_rad_s > 0.0 \
            if self._only_turns else motion.speed_mps > STANDSTILL_MPS or pose_mps > 0.0
        if round_trip_s != round_trip_s:
            round_trip_s = UNKNOWN_ROUND_TRIP_S
        if moves:
            self._told_s[self._only_turns], self._still, self._moved_at = 0.0, 0, now
            self.follows = self.follows or self._since is not None
        elif self._since is not None and (
                self._told_s[self._only_turns] + now - self._since
                > FOLLOWS_WITHIN_S + round_trip_s):
            self._still += 1
            self.follows = self.follows and self._still < READINGS


class StopProof:
    """Follows one robot from the moment of a stop; time is seconds of a clock that never goes back.

    States::

        WAITING        -> STOPPED        READINGS readings of standstill in a row, over ROW_S
        WAITING        -> NOT_CONFIRMED  it still moves after TIMEOUT_S, or it was silent for
                                         ``silent_after_s``
        STOPPED        -> NOT_CONFIRMED  it moves again, or falls silent
        any            -> NOT_CONFIRMED  its odometry does not follow (:attr:`follows`)
        NOT_CONFIRMED  -> STOPPED        READINGS readings of standstill in a row, over ROW_S

    A reading of standstill has all three planar velocities near zero, a pose that does not change,
    and no impossible number. It counts from the time of its measurement, not of its arrival, and
    only if the stop had reached the robot by then. The time given is that of the first reading of
    the row. If the robot was silent for ``silent_after_s`` before that reading, it may have stood
    still long before, and the words say so.

    :param now: time at which the zero was sent
    :param round_trip_s: of the link to the robot [s], None if unknown
    :param silent_after_s: after this long the robot is silent [s]; 0: as 1
    """

    def __init__(self, now: float, round_trip_s: Optional[float] = None,
                 silent_after_s: float = SILENT_AFTER_S) -> None:
        #: whether its odometry follows the commands, see :class:`OdometryWitness`
        self.follows = True
        self._begun = now
        # Readings measured before this may be from before the stop arrived.
        self._counts_from = now + (UNKNOWN_ROUND_TRIP_S if round_trip_s is None else round_trip_s)
        self._silent_after_s = silent_after_s or SILENT_AFTER_S
        self._heard = now
        self._measured = now
        self._run = 0
        self._run_began = now
        self._pose = PoseWatch()
        self._doubt = ''
        # A creeping pose looks like rest in every other reading: keep its words for a while.
        self._crept, self._crept_at = '', -math.inf
        self.state = PROOF_WAITING
        #: time from the stop to the first reading of standstill [ms]; None while it moves
        self.stopped_ms: Optional[float] = None
        # Whether the time of its standstill is unknown, since it was silent for a while.
        self._unseen = False

    def on_motion(self, motion: Motion, now: float, late_s: Optional[float] = 0.0) -> None:
        """Handle one reading of the robot's odometry, received at ``now``.

        :param late_s: its delay in excess of the fastest message [s]; None if unknown
        """
        self._heard = now
        measured = self._measured if late_s is None else max(now - late_s, self._measured)
        if measured - self._measured > self._silent_after_s:
            self._run = 0
            if self.stopped_ms is None:
                self._unseen = True
        self._measured = measured
        self._doubt = self._moves(motion, measured)
        if self._doubt:
            self._run = 0
            self.stopped_ms = None
            if self.state == PROOF_STOPPED:
                self.state = PROOF_NOT_CONFIRMED
        elif late_s is None:
            self._run = 0
            self._doubt = 'the clock of its stamps was set back, or it was just switched on'
        elif now - late_s >= self._counts_from:
            self._rests(measured)

    def _moves(self, motion: Motion, measured: float) -> str:
        """Return why a reading does not show standstill; '' if it does."""
        if not motion.is_possible():
            return 'its odometry is not possible'
        pose_mps, pose_rad_s = self._pose.speed(motion, measured)
        if not motion.is_standstill():
            return 'moves at {:.2f} m/s, {:.2f} rad/s'.format(
                motion.speed_mps, abs(motion.angular_rad_s))
        if pose_mps or pose_rad_s:
            self._crept = 'its pose moves at {:.2f} m/s, {:.2f} rad/s'.format(
                min(pose_mps, BOUNDS[SPEED].greatest),
                min(pose_rad_s, BOUNDS[ANGULAR_VELOCITY].greatest))
            self._crept_at = measured
            return self._crept
        return ''

    def _rests(self, measured: float) -> None:
        """Count one reading of standstill."""
        if not self.follows:
            self._run = 0
            return
        if self._run == 0:
            self._run_began = measured
        self._run += 1
        if self._run >= READINGS and measured - self._run_began >= ROW_S \
                and self.state != PROOF_STOPPED:
            self.state = PROOF_STOPPED
            if self.stopped_ms is None:
                self.stopped_ms = max(0.0, (self._run_began - self._begun) * 1000.0)

    def view(self, now: float) -> ProofView:
        """Check for time-outs, and return the :class:`ProofView` of this moment."""
        old = now - self._measured > self._silent_after_s
        late = self.state == PROOF_WAITING and now - self._begun > TIMEOUT_S
        if not self.follows:
            self.stopped_ms = None
        if old or late or not self.follows:
            self.state = PROOF_NOT_CONFIRMED
            self._run = 0 if old else self._run
        return ProofView(self.state, self._words(now))

    def _words(self, now: float) -> str:
        if self.state == PROOF_STOPPED and self.stopped_ms is not None:
            if self._unseen:
                return 'standstill seen after {:.1f} s'.format(self.stopped_ms / 1000.0)
            return 'stopped in {:.0f} ms'.format(self.stopped_ms)
        if self.state == PROOF_WAITING:
            return 'stopping'
        if now - self._heard > self._silent_after_s:
            return 'NOT CONFIRMED: no odometry arrives'
        if not self.follows:
            return 'NOT CONFIRMED: ' + NO_WITNESS
        if self._doubt:
            return 'NOT CONFIRMED: ' + self._doubt
        if now - self._measured > self._silent_after_s:
            return 'NOT CONFIRMED: what it says is {:.1f} s old'.format(now - self._measured)
        if self._measured - self._crept_at < POSE_WINDOW_S:
            return 'NOT CONFIRMED: ' + self._crept
        return 'NOT CONFIRMED: at rest for less than {} readings'.format(READINGS)
