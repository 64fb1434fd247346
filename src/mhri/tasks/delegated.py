# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A goal that a robot's own navigation (move_base) drives to: begun, watched and cancelled here.

That navigation speaks to the robot itself, so nothing of it passes the gates: whatever ends a task
cancels the goal there, and the robot gets zeros through the gates as after any task.
"""
from dataclasses import replace
import math
from typing import Optional, Tuple

import numpy as np

from mhri.base.limits import Velocity, ZERO
from mhri.base.mocap import Pose
from mhri.driving.gate import OPERATOR, TASK
from mhri.tasks.base import (
    beside, BLOCKED, Body, DONE, ENDS, FAILED, RUNNING, Senses, shown, Target, turn_to, WAITING,
    way, within)
from mhri.tasks.fence import depths, is_inside
from mhri.tasks.run import ENDED, Facts, missing_senses, READYING, RobotRun, UNDER_WAY

# So much nearer to the fence than before is no error of measurement [m].
_NEARER_M = 0.02


class Errand:
    """What a robot's own navigation can be told; each call returns at once."""

    def is_ready(self) -> bool:
        """Tell whether it is heard, and hears us."""
        raise NotImplementedError

    def begin(self, by_odometry: Pose, in_frame: Optional[Pose]) -> None:
        """Send it to a pose.

        :param by_odometry: in the frame of the robot's odometry
        :param in_frame: the same in that of the map, None where that is not known
        """
        raise NotImplementedError

    def look(self) -> Tuple[str, str]:
        """Return (task state, sentence) of what was begun."""
        raise NotImplementedError

    def cancel(self) -> None:
        """End what was begun; nothing where that has ended."""
        raise NotImplementedError


class DelegatedRun(RobotRun):
    """The run of a goal by a robot's own navigation.

    States are those of :class:`mhri.tasks.run.RobotRun` without ``joining``; nothing is to be
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
        """Whether its velocities are those of :meth:`tick`."""
        return self.phase == ENDED

    def end(self, state: str, text: str, now_s: float) -> None:
        """End it, unless it has ended, here and at the robot's navigation."""
        if self.phase != ENDED:
            self._errand.cancel()
        super().end(state, text, now_s)

    def tick(self, facts: Facts) -> Velocity:
        """Let time pass: begin it, watch it, end it."""
        if self.phase == ENDED:
            return ZERO
        # No task reaches the gates meanwhile, so a robot obeys its operator or nobody.
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
            self.end(FAILED, 'its goal lies outside of the fence', facts.now_s)
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
                text += ', {:.2f} m beside the goal'.format(self.left_m)
            self.end(state, text, facts.now_s)
        elif self._leaves(senses):
            self.end(BLOCKED, 'it is at the fence, at {}'.format(shown(senses.pose)), facts.now_s)
        else:
            self.state = state
            self.text = text if state == WAITING else '{}; {:.1f} m to go'.format(
                text, self.left_m)

    def _leaves(self, senses: Senses) -> bool:
        """Tell whether it gets nearer to a fence that it touches, or further off outside."""
        if not len(senses.fence):
            return False
        depth_m = float(depths(senses.fence, np.array([[senses.pose.x_m, senses.pose.y_m]]))[0])
        self._depth_m = max(self._depth_m, depth_m)
        return depth_m < min(self._body.radius_m, self._depth_m - _NEARER_M)
