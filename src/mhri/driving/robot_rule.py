# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rule of one robot: which commander it obeys, and when it stops. No ROS, no clock.

A robot obeys one commander: the operator while it is selected, else its task, else none. Its state
is the first of these whose condition holds (:data:`PRECEDENCE`)::

    CLOSED          the robot was removed, or the program ends
    STOPPED         stop-all is in force
    STOPPED_ALONE   this robot was stopped
    HELD            nothing may be sent to it: it is silent, unsupervised, or present twice
    JOINING         it is selected, and waits until the operator's command has been zero once
    OPERATOR        it is selected, and passes on the operator's command
    TASK            it passes on its task's command
    IDLE            it obeys no commander

Every change of commander, and every end of motion, sends a zero at once and more at 20 Hz for
0.5 s (:data:`ZERO_ON_ENTRY`); while it is HELD it gets only the first. A robot that joins while
anything is driven waits for neutral; anything is driven if the operator's last command was nonzero.
"""
import math
from typing import Callable, Optional, Sequence, Tuple

from mhri.base.limits import clamp_keeping_curvature, Velocity, ZERO
from mhri.base.reasons import JOINING, STOPPED, STOPPED_ALONE
from mhri.base.robot_types import common_limits, Limits
from mhri.driving.arbiter import REPEAT_HZ, ZEROS_S

# STOPPED, STOPPED_ALONE and JOINING are reasons as well.
IDLE, OPERATOR, TASK, HELD, CLOSED = 'idle', 'operator', 'task', 'held', 'closed'
STATES = (CLOSED, STOPPED, STOPPED_ALONE, HELD, JOINING, OPERATOR, TASK, IDLE)
# Whether entering a state sends a zero: always, only if the last velocity was nonzero, or never.
ALWAYS, IF_MOVING, NEVER = 'always', 'if_moving', 'never'
ZERO_ON_ENTRY = {CLOSED: ALWAYS, STOPPED: ALWAYS, STOPPED_ALONE: ALWAYS, HELD: IF_MOVING,
                 JOINING: IF_MOVING, OPERATOR: NEVER, TASK: NEVER, IDLE: IF_MOVING}

# A task silent for this long is no longer obeyed [s].
TASK_STALE_S = 0.25
_PERIOD_S = 1.0 / REPEAT_HZ

# Returns a velocity reduced by the brake at a time [s].
Brake = Callable[[Velocity, float], Velocity]


class RobotRule:
    """Decides, for one robot, what to pass on and when to send a zero.

    Every method that may change the robot's motion returns the :class:`Velocity` to send now, or
    None; time is seconds of a monotonic clock. After :meth:`close` only the last zeros follow.

    :param limits: :class:`mhri.base.robot_types.Limits` of the robot
    :param command: the operator's last command, None before the first; then other robots may be
        driven, and this one waits for neutral
    :param brake: applied to the operator's commands, and again as time passes; commands of tasks
        are braked where the tasks run
    """

    def __init__(self, limits: Limits, command: Optional[Velocity] = None,
                 brake: Brake = lambda velocity, _: velocity) -> None:
        self.limits = limits
        self._brake = brake
        # Its limits within its group.
        self._most = limits
        self._share = 1.0
        self._state = IDLE
        self._held_by = ''
        # _centre: the robot must not move before the operator's command has been zero once.
        # _task_rests: its task has left it out, or was silent, so it may be obeyed again.
        self._selected = self._stopped = self._alone = self._closed = self._task_rests = False
        self._command = command
        self._centre = self._driven()
        self._task_at = -math.inf
        # The last velocity sent, and the same before the brake.
        self._last = self._wanted = ZERO
        self._zeros_until = self._zero_at = -math.inf

    @property
    def state(self) -> str:
        """One of :data:`STATES`."""
        return self._state

    @property
    def selected(self) -> bool:
        """Whether the operator in control has selected the robot."""
        return self._selected

    @property
    def stopped(self) -> bool:
        """Whether stop-all or its own stop is in force, also once it is closed."""
        return self._stopped or self._alone

    @property
    def held_by(self) -> str:
        """Why nothing may be sent to it, in any state; '' if commands may be sent."""
        return self._held_by

    @property
    def sent(self) -> Velocity:
        """The :class:`Velocity` last sent."""
        return self._last

    @property
    def obeys(self) -> str:
        """The commander the robot obeys: OPERATOR, TASK or '' for none."""
        if self._selected and self._state != CLOSED:
            return OPERATOR
        return TASK if self._state == TASK else ''

    @property
    def stop_reason(self) -> str:
        """Why the robot must not move: STOPPED, STOPPED_ALONE, JOINING, why it is held, or ''."""
        if self._state == HELD:
            return self._held_by
        return self._state if self._state in (STOPPED, STOPPED_ALONE, JOINING) else ''

    def hold_to(self, group: Limits, share: float) -> None:
        """Set the pace of the robot's group, from the next command on.

        :param group: :class:`mhri.base.robot_types.Limits` of the group, or its own
        :param share: fraction of a command that is passed on, in (0, 1]
        """
        self._most, self._share = common_limits((group, self.limits)), share

    def on_command(self, velocity: Velocity, now: float) -> Optional[Velocity]:
        """Handle the operator's command; return what to send this robot, or None."""
        self._command = velocity
        if self._centre and velocity.is_zero() and not self._stopped:
            self._centre = False
            self._state = self._belongs(now)
        if self._state != OPERATOR:
            return None
        wanted = clamp_keeping_curvature(
            Velocity(*(self._share * part for part in velocity)), self._most)
        said = self._say(self._brake(wanted, now), now)
        self._wanted = wanted
        return said

    def on_task(self, velocity: Optional[Velocity], now: float) -> Optional[Velocity]:
        """Handle the command of the robot's task; return what to send the robot, or None.

        After a stop, a hold or a change of control the robot obeys its task again only once the
        task has left it out, or was silent for a while: nothing resumes by itself.

        :param velocity: None if the running tasks leave this robot out
        """
        if velocity is None:
            self._task_rests = True
            return None
        if now - self._task_at >= TASK_STALE_S:
            self._task_rests = True
        self._task_at = now
        if self._state == IDLE and self._task_rests:
            self._state = TASK
        if self._state != TASK:
            return None
        return self._say(clamp_keeping_curvature(velocity, self.limits), now)

    def skip_task(self, now: float) -> None:
        """Handle a task's command that does not count; only its time is stored."""
        self._task_at = now

    def select(self, selected: bool, now: float) -> Optional[Velocity]:
        """Start or stop obeying the operator; return the zero of the change, if any."""
        if selected == self._selected:
            return None
        self._selected = selected
        self._task_rests = False
        if selected and self._driven():
            self._centre = True
        return self._settle(now, changed=True)

    def stop(self, stopped: bool, alone: bool, now: float) -> Optional[Velocity]:
        """Engage or release stop-all, and this robot's own stop; return the zero, if any.

        Engaging sends the robot a zero, selected or not.
        """
        if (stopped, alone) == (self._stopped, self._alone):
            return None
        self._stopped, self._alone, self._task_rests = stopped, alone, False
        self._centre = self._centre or stopped or self._driven()
        return self._settle(now)

    def hold(self, reason: str, now: float) -> Optional[Velocity]:
        """Stop sending to the robot, after one zero if it was moving; '' resumes.

        A stalled link would deliver everything sent into it once it recovers. A robot that comes
        back while anything is driven waits for neutral.

        :param reason: a code of :mod:`mhri.base.reasons`, or ''
        """
        before, self._held_by = self._held_by, reason
        if bool(before) == bool(reason):
            return None
        return self.join(now)

    def join(self, now: float) -> Optional[Velocity]:
        """Wait for neutral if anything is driven.

        For a robot that has newly connected, lost its guard, or changed its operator.
        """
        self._task_rests = False
        self._centre = self._centre or self._driven()
        return self._settle(now)

    def begin_zeros(self, now: float) -> Velocity:
        """Return a zero now, and repeat it over time: the sender of its task has gone."""
        return self._say(ZERO, now, ending=True)

    def close(self, now: float) -> Optional[Velocity]:
        """Close the rule when the robot is removed or the program ends; return the last zero."""
        if self._closed:
            return None
        self._closed = True
        return self._settle(now)

    def tick(self, now: float) -> Optional[Velocity]:
        """Handle the passage of time: brake again, end a silent task, repeat zeros."""
        if self._state == OPERATOR and not self._wanted.is_zero():
            return self._brake_again(now)
        if self._state == TASK and now - self._task_at >= TASK_STALE_S:
            return self._settle(now, changed=True)
        if self._repeats_zeros() and self._zero_at + _PERIOD_S <= now < self._zeros_until:
            self._zero_at = now
            return ZERO
        return None

    def next_tick(self, now: float) -> Optional[float]:
        """Return when to call :meth:`tick` next [s], None if it is not urgent."""
        if self._state == TASK:
            return self._task_at + TASK_STALE_S
        again = self._zero_at + _PERIOD_S
        # After the last repetition is overdue, no further call is needed.
        return again if self._repeats_zeros() and max(again, now) < self._zeros_until else None

    def _repeats_zeros(self) -> bool:
        """Return whether this state repeats zeros after motion."""
        return self._state not in (TASK, HELD) and self._wanted.is_zero()

    def _brake_again(self, now: float) -> Optional[Velocity]:
        """Slow down for new obstacles; only a new command makes the robot faster."""
        wanted, allowed = self._wanted, self._brake(self._wanted, now)
        if allowed.speed_mps >= self._last.speed_mps:
            return None
        said = self._say(allowed, now)
        self._wanted = wanted
        return said

    def _driven(self) -> bool:
        """Return whether anything may be driven: the last command was nonzero or is unknown."""
        return self._command is None or not self._command.is_zero()

    def _belongs(self, now: float) -> str:
        """Return the first state whose condition holds."""
        return next(state for state, holds in PRECEDENCE if holds(self, now))

    def _obeys_task(self, now: float) -> bool:
        return self._state == TASK and self._task_rests and now - self._task_at < TASK_STALE_S

    def _settle(self, now: float, changed: bool = False) -> Optional[Velocity]:
        """Enter the state that applies now; return the zero of that change, or None.

        :param changed: whether its commander has changed: then send a zero even at rest
        """
        before, self._state = self._state, self._belongs(now)
        rule = ZERO_ON_ENTRY[self._state]
        zero = (rule == ALWAYS and before != self._state
                or rule == IF_MOVING and not self._last.is_zero()
                or changed and self._state in (IDLE, JOINING, OPERATOR))
        # A robot that never moved needs only one last zero.
        return self._say(ZERO, now, ending=self._state != CLOSED) if zero else None

    def _say(self, velocity: Velocity, now: float, ending: bool = False) -> Velocity:
        """Store the velocity being sent; a zero after motion, or at an end, starts the repeats."""
        if velocity.is_zero():
            if ending or not self._last.is_zero():
                self._zeros_until = now + ZEROS_S
            self._zero_at = now
        self._last = self._wanted = velocity
        return velocity


#: (state, condition) in order of precedence
PRECEDENCE: Sequence[Tuple[str, Callable[[RobotRule, float], bool]]] = (
    (CLOSED, lambda rule, now: rule._closed),
    (STOPPED, lambda rule, now: rule._stopped),
    (STOPPED_ALONE, lambda rule, now: rule._alone),
    (HELD, lambda rule, now: bool(rule._held_by)),
    (JOINING, lambda rule, now: rule._selected and rule._centre),
    (OPERATOR, lambda rule, now: rule._selected),
    (TASK, lambda rule, now: rule._obeys_task(now)),
    (IDLE, lambda rule, now: True))
