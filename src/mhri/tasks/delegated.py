# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Starts, monitors and cancels goals of a robot's own navigation (move_base).

That navigation commands the robot directly, bypassing the mux: whatever ends a task cancels its
goal, and the robot gets zeros from the mux as after any task.
"""
from dataclasses import replace
import math
from typing import Optional, Tuple

import numpy as np

from mhri.base.geometry import beside, Pose, within
from mhri.base.limits import Velocity, ZERO
from mhri.driving.robot_rule import OPERATOR, TASK
from mhri.tasks.base import (
    BLOCKED, Body, DONE, ENDS, FAILED, RUNNING, Senses, shown, Target, turn_to, WAITING, way)
from mhri.tasks.fence import depths, is_inside
from mhri.tasks.run import ENDED, Facts, missing_senses, READYING, RobotRun, UNDER_WAY

# An approach to the fence by less than this may be noise [m].
_NEARER_M = 0.02


class Errand:
    """The interface of a robot's own navigation; each call returns at once."""

    def is_ready(self) -> bool:
        """Return whether it is connected in both directions."""
        raise NotImplementedError

    def begin(self, by_odometry: Pose, in_frame: Optional[Pose]) -> None:
        """Send the robot to a pose.

        :param by_odometry: in the frame of the robot's odometry
        :param in_frame: the same in the frame of the map, None if unknown
        """
        raise NotImplementedError

    def look(self) -> Tuple[str, str]:
        """Return (task state, sentence) of the goal."""
        raise NotImplementedError

    def cancel(self) -> None:
        """Cancel the goal, unless it has ended."""
        raise NotImplementedError


class DelegatedRun(RobotRun):
    """The run of a goal by a robot's own navigation.

    Its states are those of :class:`mhri.tasks.run.RobotRun` without ``joining``; nothing is
    published for the robot while it is under way.
    """

    def __init__(self, robot: str, target: Target, errand: Errand, body: Body, timeout_s: float,
                 now_s: float) -> None:
        super().__init__(robot, None, body, timeout_s, now_s)
        self._target = target
        self._errand = errand
        self._depth_m = -math.inf

    @property
    def drives(self) -> bool:
        """Whether the velocities of :meth:`tick` apply."""
        return self.phase == ENDED

    def end(self, state: str, text: str, now_s: float) -> None:
        """End it here and at the robot's navigation, unless it has ended."""
        if self.phase != ENDED:
            self._errand.cancel()
        super().end(state, text, now_s)

    def tick(self, facts: Facts) -> Velocity:
        """Start, monitor or end the goal."""
        if self.phase == ENDED:
            return ZERO
        # Meanwhile no task reaches the mux, so the robot is either driven by its operator or idle.
        obeys = OPERATOR if facts.obeys == OPERATOR else TASK
        end = self._reason(replace(facts, obeys=obeys, has_laser=False))
        if end is not None:
            self.end(*end, now_s=facts.now_s)
        elif self.phase == READYING:
            self._send(facts)
        elif facts.senses is not None:
            self._watch(facts, facts.senses)
        return ZERO

    def _send(self, facts: Facts) -> None:
        missing = missing_senses(replace(facts, has_laser=False))
        if not missing and not self._errand.is_ready():
            missing = 'its navigation (move_base)'
        if missing or facts.senses is None:
            self.text = 'waits for ' + missing
            return
        senses, target = facts.senses, self._target
        if not target.by_odometry and not is_inside(senses.fence, target.x_m, target.y_m):
            self.end(FAILED, 'its goal is outside the fence', facts.now_s)
            return
        own = senses.odometry if target.by_odometry else senses.pose
        heading = target.heading_rad
        if heading is None:
            heading = own.heading_rad + turn_to(own, target.x_m, target.y_m)
        goal = Pose(target.x_m, target.y_m, heading)
        turn = senses.odometry.heading_rad - own.heading_rad
        self._errand.begin(Pose(*beside(senses.odometry, *within(own, goal)),
                                heading_rad=heading + turn),
                           None if target.by_odometry else goal)
        self.phase, self.state, self._phase_s = UNDER_WAY, RUNNING, facts.now_s
        self.text = 'its own navigation (move_base) drives it'

    def _watch(self, facts: Facts, senses: Senses) -> None:
        pose = senses.odometry if self._target.by_odometry else senses.pose
        self.left_m = way(pose, self._target.x_m, self._target.y_m)
        state, text = self._errand.look()
        if state in ENDS:
            if state == DONE:
                text += ', {:.2f} m off'.format(self.left_m)
            self.end(state, text, facts.now_s)
        elif self._leaves(senses):
            self.end(BLOCKED, 'it is at the fence, at {}'.format(shown(senses.pose)), facts.now_s)
        else:
            self.state = state
            self.text = text if state == WAITING else '{}; {:.1f} m to go'.format(
                text, self.left_m)

    def _leaves(self, senses: Senses) -> bool:
        """Return whether the robot approaches a fence it touches, or moves further outside."""
        if not len(senses.fence):
            return False
        depth_m = float(depths(senses.fence, np.array([[senses.pose.x_m, senses.pose.y_m]]))[0])
        self._depth_m = max(self._depth_m, depth_m)
        return depth_m < min(self._body.radius_m, self._depth_m - _NEARER_M)
