# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gate of one robot: what of the one velocity command reaches it. No ROS, no clock."""
from mhri.core.limits import ZERO, clamp_keeping_curvature

STALE_S = 0.5


class GateRule:
    """Decides, for one robot, what to forward and when to send the one zero.

    Like the arbiter's, every method returns the :class:`Velocity` to send now, or None; time is
    seconds of a clock that never goes back. Closed (:meth:`close`), it never says anything again.

    :param limits: :class:`mhri.core.robot_types.Limits` of the robot
    """

    def __init__(self, limits):
        self.limits = limits
        self._selected = False
        self._stops = set()
        self._closed = False
        self._last = ZERO
        self._last_at = None

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

    def on_command(self, velocity, now):
        """Take in the one velocity command; return what this robot gets of it, or None."""
        if self._closed or self._stops or not self._selected:
            return None
        return self._say(clamp_keeping_curvature(velocity, self.limits), now)

    def select(self, selected, now):
        """Select or deselect the robot; deselected, it gets one zero."""
        was, self._selected = self._selected, selected
        if was and not selected and not self._closed and not self._stops:
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
        """Let time pass: commands that went stale are ended by one zero."""
        if self.driving and now - self._last_at >= STALE_S and not self._closed:
            return self._say(ZERO, now)
        return None

    def next_tick(self):
        """Return when :meth:`tick` has to be called next [s], or None: not before a command."""
        if self.driving and not self._closed:
            return self._last_at + STALE_S
        return None

    def _say(self, velocity, now):
        self._last, self._last_at = velocity, now
        return velocity
