# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rule of one robot's gate: whom the robot obeys, and when it stands. No ROS, no clock.

A robot obeys one thing: the operator while it is checked, else its task, else nothing. States and
what leads out of them::

    IDLE      obeys nobody                       checked -> JOINING or OPERATOR, task -> TASK
    JOINING   checked, waits for a zero of the   a zero is commanded -> OPERATOR
              mux: the stick is centred
    OPERATOR  passes on the operator's command   unchecked -> IDLE, command stale -> JOINING
    TASK      passes on its task's command       checked, task silent -> IDLE
    HELD      the robot is not heard, nothing    heard again -> where it belongs, centred first
              is sent
    STOPPED   stop-all is in force               released -> where it belongs, centred first
    CLOSED    the robot was removed              (nothing)

Every way out of OPERATOR and TASK sends a zero, and so does every change of whom it obeys. STOPPED
sends one to every robot, checked or not. A robot that joins while anything is driving waits for
neutral; something is driving if the last command heard was not zero.
"""
import math
from typing import Callable, Optional, Sequence

from mhri.base.limits import clamp_keeping_curvature, Velocity, ZERO
from mhri.base.robot_types import Limits

IDLE, JOINING, OPERATOR, TASK = 'idle', 'joining', 'operator', 'task'
HELD, STOPPED, CLOSED = 'held', 'stopped', 'closed'
STATES = (IDLE, JOINING, OPERATOR, TASK, HELD, STOPPED, CLOSED)

# A command or a task older than this is no longer obeyed [s].
STALE_S = 0.5

# What is left of a velocity at a time [s].
Brake = Callable[[Velocity, float], Velocity]


def common_limits(limits: Sequence[Limits]) -> Limits:
    """Return what every robot of a group can do: the lowest of each of their limits.

    :param limits: several :class:`mhri.base.robot_types.Limits`
    """
    return Limits(min(one.linear_mps for one in limits), min(one.angular_rad_s for one in limits))


class GateRule:
    """Decides, for one robot, what to forward and when to send a zero.

    Every method that may change what the robot should do returns the :class:`Velocity` to send
    now, or None; time is seconds of a clock that never goes back. After :meth:`close` it never
    says anything again.

    :param limits: :class:`mhri.base.robot_types.Limits` of the robot
    :param command: the operator's last command, None before the first; then something may be
        driving, and the robot waits for neutral
    :param brake: applied to what the operator commands, and again as time passes; what tasks
        command has been braked where they are run
    """

    def __init__(self, limits: Limits, command: Optional[Velocity] = None,
                 brake: Brake = lambda velocity, _: velocity) -> None:
        self.limits = limits
        self._brake = brake
        # What it may do in its group.
        self._most = limits
        self._share = 1.0
        self._state = IDLE
        self._checked = False
        self._stopped = False
        self._held = False
        # The robot must not move before the operator's command has been zero once (its task's
        # command or silence, for the task).
        self._command = command
        self._centre = self._driven()
        self._task_rests = False
        self._command_at = self._task_at = -math.inf
        # What was sent last, and what that was before the brake.
        self._last = self._wanted = ZERO

    @property
    def state(self) -> str:
        """One of :data:`STATES`."""
        return self._state

    @property
    def checked(self) -> bool:
        """Whether the operator in control has checked the robot."""
        return self._checked

    @property
    def sent(self) -> Velocity:
        """The :class:`Velocity` last sent."""
        return self._last

    @property
    def obeys(self) -> str:
        """Whom the robot obeys: OPERATOR, TASK or '' for nobody."""
        if self._checked and self._state != CLOSED:
            return OPERATOR
        return TASK if self._state == TASK else ''

    @property
    def stands(self) -> str:
        """Why the robot is kept still: STOPPED, HELD, JOINING, or '' for no reason."""
        return self._state if self._state in (STOPPED, HELD, JOINING) else ''

    def hold_to(self, group: Limits, share: float) -> None:
        """Hold the robot to its group's pace from the next command on.

        :param group: :class:`mhri.base.robot_types.Limits` of the group, or its own
        :param share: fraction of a command that is passed on, in (0, 1]
        """
        self._most, self._share = common_limits((group, self.limits)), share

    def on_command(self, velocity: Velocity, now: float) -> Optional[Velocity]:
        """Take in the operator's command; return what to send this robot, or None."""
        self._command, self._command_at = velocity, now
        if velocity.is_zero() and self._state != STOPPED:
            self._centre = False
            self._state = self._belongs(now)
        if self._state != OPERATOR:
            return None
        share, wanted = self._share, velocity
        if share != 1.0:
            wanted = Velocity(share * velocity.linear_mps, share * velocity.angular_rad_s)
        wanted = clamp_keeping_curvature(wanted, self._most)
        said = self._say(self._brake(wanted, now))
        self._wanted = wanted
        return said

    def on_task(self, velocity: Velocity, now: float) -> Optional[Velocity]:
        """Take in the command of the robot's task; return what to send the robot, or None.

        After a stop, a hold or a change of control the robot obeys its task again only once the
        task has sent a zero, or nothing for a while: nothing resumes by itself.
        """
        if velocity.is_zero() or now - self._task_at >= STALE_S:
            self._task_rests = True
        self._task_at = now
        if self._state == IDLE and self._task_rests:
            self._state = TASK
        if self._state != TASK:
            return None
        return self._say(clamp_keeping_curvature(velocity, self.limits))

    def check(self, checked: bool, now: float) -> Optional[Velocity]:
        """Start or stop obeying the operator; return the zero of the change, if any."""
        if checked == self._checked:
            return None
        self._checked = checked
        self._task_rests = False
        if checked and self._driven():
            self._centre = True
        return self._settle(now, changed=True)

    def stop(self, stopped: bool, now: float) -> Optional[Velocity]:
        """Engage or release stop-all; engaging sends every robot a zero, checked or not."""
        if stopped == self._stopped:
            return None
        self._stopped, self._task_rests = stopped, False
        self._centre = self._centre or stopped
        return self._settle(now)

    def hold(self, held: bool, now: float) -> Optional[Velocity]:
        """Stop sending to a robot that is not heard, after one zero if it was driven.

        A stalled link would deliver everything sent into it once it recovers. A robot heard again
        while anything is driving waits for neutral.
        """
        if held == self._held:
            return None
        self._held = held
        self._task_rests = False
        self._centre = self._centre or self._driven()
        return self._settle(now)

    def join(self, now: float) -> Optional[Velocity]:
        """Wait for neutral if anything is driving.

        For a robot that is newly connected, has lost its guard, or has a new mux or operator.
        """
        self._task_rests = False
        self._centre = self._centre or self._driven()
        return self._settle(now)

    def close(self, now: float) -> Optional[Velocity]:
        """End: the robot is removed or the program closes; the last command is a zero."""
        if self._state == CLOSED:
            return None
        self._state = CLOSED
        return self._say(ZERO)

    def tick(self, now: float) -> Optional[Velocity]:
        """Let time pass: one zero ends commands that went stale, and the brake looks again."""
        if self._state == OPERATOR and not self._wanted.is_zero():
            if now - self._command_at >= STALE_S:
                self._centre = True
                return self._settle(now)
            return self._brake_again(now)
        if self._state == TASK and now - self._task_at >= STALE_S:
            return self._settle(now, changed=True)
        return None

    def next_tick(self) -> Optional[float]:
        """Return when to call :meth:`tick` next [s], or None for not before a command."""
        if self._state == OPERATOR and not self._wanted.is_zero():
            return self._command_at + STALE_S
        return self._task_at + STALE_S if self._state == TASK else None

    def _brake_again(self, now: float) -> Optional[Velocity]:
        """Slow down for what has come into the way; only a new command makes it faster."""
        wanted, allowed = self._wanted, self._brake(self._wanted, now)
        if abs(allowed.linear_mps) >= abs(self._last.linear_mps):
            return None
        said = self._say(allowed)
        self._wanted = wanted
        return said

    def _driven(self) -> bool:
        """Tell whether anything may drive: the last command was not zero, or there was none."""
        return self._command is None or not self._command.is_zero()

    def _belongs(self, now: float) -> str:
        """Return the state that follows from who wants what."""
        if self._state == CLOSED:
            return CLOSED
        if self._stopped:
            return STOPPED
        if self._held:
            return HELD
        if self._checked:
            return JOINING if self._centre else OPERATOR
        on_task = self._task_rests and now - self._task_at < STALE_S
        return TASK if on_task and self._state == TASK else IDLE

    def _settle(self, now: float, changed: bool = False) -> Optional[Velocity]:
        """Go where the robot belongs; return the zero of that change, or None.

        :param changed: whether the robot obeys another now: a zero even where it stands
        """
        before, self._state = self._state, self._belongs(now)
        if self._state == STOPPED:
            zero = before != STOPPED
        elif self._state in (HELD, CLOSED):
            zero = not self._last.is_zero()
        else:
            zero = changed or self._state in (IDLE, JOINING) and not self._last.is_zero()
        return self._say(ZERO) if zero else None

    def _say(self, velocity: Velocity) -> Velocity:
        self._last = self._wanted = velocity
        return velocity
