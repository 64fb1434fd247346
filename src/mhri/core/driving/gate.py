# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gate of one robot: what of the one velocity command reaches it. No ROS, no clock."""
import math

from mhri.core.driving.limits import Velocity, ZERO, clamp_keeping_curvature
from mhri.core.robots.robot_types import Limits

STALE_S = 0.5
# A robot that is selected while others are driven waits for the zero by which the mux answers, or
# for so long.
JOIN_S = 0.3


def common_limits(limits):
    """Return what every robot of a group can do: the least of each of their limits.

    :param limits: several :class:`mhri.core.robots.robot_types.Limits`
    """
    return Limits(min(one.linear_mps for one in limits), min(one.angular_rad_s for one in limits))


class GateRule:
    """Decides, for one robot, what to forward and when to send the one zero.

    Like the arbiter's, every method returns the :class:`Velocity` to send now, or None; time is
    seconds of a clock that never goes back. Closed (:meth:`close`), it never says anything again.

    :param limits: :class:`mhri.core.robots.robot_types.Limits` of the robot
    """

    def __init__(self, limits):
        self.limits = limits
        self._group = limits
        self._share = 1.0
        self._selected = False
        self._stops = set()
        self._closed = False
        self._last = ZERO
        self._last_at = None
        self._heard = ZERO
        self._heard_at = None
        self._joins_at = None
        self._held = False

    @property
    def selected(self):
        """Whether the robot is selected for control."""
        return self._selected

    @property
    def stopped(self):
        """Whether a stop is in force."""
        return bool(self._stops)

    @property
    def driving(self):
        """Whether the robot was last sent something other than zero."""
        return not self._last.is_zero()

    def hold_to(self, group, share):
        """Let the robot keep to its group from the next command on.

        :param group: :class:`mhri.core.robots.robot_types.Limits` of the group, or its own
        :param share: how much of a command is passed on, in (0, 1]
        """
        self._group, self._share = group, share

    def on_command(self, velocity, now):
        """Take in the one velocity command; return what this robot gets of it, or None."""
        self._heard, self._heard_at = velocity, now
        if velocity.is_zero() or self._joins_at is not None and now >= self._joins_at:
            self._joins_at = None
        return self._forward(velocity, now)

    def _forward(self, velocity, now):
        """Return what the robot gets of a command: nothing while anything is in the way."""
        if self._closed or self._stops or self._held or not self._selected \
                or self._joins_at is not None:
            return None
        share = self._share
        wanted = Velocity(share * velocity.linear_mps, share * velocity.angular_rad_s)
        return self._say(clamp_keeping_curvature(
            clamp_keeping_curvature(wanted, self._group), self.limits), now)

    def select(self, selected, now):
        """Select or deselect the robot; deselected, it gets one zero.

        One that is selected in the middle of a drive joins at the next zero (the mux sends one and
        waits for neutral), or after :data:`JOIN_S` where whoever drives is not our mux.
        """
        was, self._selected = self._selected, selected
        if not selected:
            self._joins_at = None
        elif not was:
            under_way = not self._heard.is_zero() and now - self._heard_at < STALE_S
            self._joins_at = now + JOIN_S if under_way else None
        if was and not selected and not self._closed and not self._stops:
            return self._say(ZERO, now)
        return None

    @property
    def waits(self):
        """Whether the robot is left out until the stick has been centred: its link was lost."""
        return self._joins_at == math.inf

    @property
    def held(self):
        """Whether nothing is sent because the robot is not heard."""
        return self._held

    def hold(self, held, now):
        """Send nothing to a robot that is not heard any more, after one zero where it was driven.

        What is sent into a link that stalls would come out, all of it, when it is back. Heard
        again in the middle of a drive, the robot waits for a zero like one that joins.
        """
        was, self._held = self._held, held
        if was and not held and not self._heard.is_zero() and self._heard_at is not None \
                and now - self._heard_at < STALE_S:
            self._joins_at = math.inf
        if held and not was and self.driving and not self._closed:
            return self._say(ZERO, now)
        return None

    def stop(self, reason, stopped, now):
        """Add or withdraw one reason to stop; the first one sends a zero, selected or not.

        :param reason: 'mux' (stop-all in force) or 'panel' (pressed here, not confirmed yet)
        """
        before = bool(self._stops)
        if stopped:
            self._stops.add(reason)
        else:
            self._stops.discard(reason)
        if stopped and not before and not self._closed:
            return self._say(ZERO, now)
        return None

    def close(self, now):
        """End: the robot is removed or the program closes; the last word is a zero."""
        if self._closed:
            return None
        self._closed = True
        return self._say(ZERO, now)

    def tick(self, now):
        """Let time pass: commands that went stale are ended by one zero; who waited joins."""
        if self._joins_at is not None and now >= self._joins_at:
            self._joins_at = None
            if now - self._heard_at < STALE_S:
                return self._forward(self._heard, now)
        if self.driving and now - self._last_at >= STALE_S and not self._closed:
            return self._say(ZERO, now)
        return None

    def next_tick(self):
        """Return when :meth:`tick` has to be called next [s], or None: not before a command."""
        if self._closed:
            return None
        if self._joins_at is not None:
            return None if self.waits else self._joins_at
        return self._last_at + STALE_S if self.driving else None

    def _say(self, velocity, now):
        self._last, self._last_at = velocity, now
        return velocity
