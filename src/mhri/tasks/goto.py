# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task goto: drives to a position, and turns to a heading there."""
import math
from typing import Optional, Tuple

from mhri.base.geometry import beside, Pose
from mhri.tasks.acts import ACT, read_acts
from mhri.tasks.base import (
    Act, BLOCKED, Corners, DONE, FAILED, Field, FRAME, REQUIRED, Senses, Start, Step, Target, Task,
    TaskKind, Values, WAITING, way, Where)
from mhri.tasks.fence import is_inside
from mhri.tasks.pilot import Pilot

SPEED = Field('speed', 'm/s', 'maximum speed', 0.2, 0.02, 2.0)
TIMEOUT_S = Field('timeout', 's', 'timeout, 0 for none', 120.0, 0.0, 86400.0)
# Tolerance of reaching the goal [m]; it counts as left beyond the larger one.
WITHIN_M = 0.05
# Without this progress [m] for this time [s] the way counts as blocked.
PROGRESS_M, STUCK_S = 0.1, 25.0
# Distance between the robots of a team [m].
SPREAD_M = 0.7


class Goto(Task):
    """Drives to one position.

    :param heading_rad: final heading, None: any
    :param rest: whether to come to rest there
    :param by_odometry: whether the position is in the frame of odometry, not in that of the pose
    :param acts: the accessories to use there
    """

    def __init__(self, start: Start, x_m: float, y_m: float, heading_rad: Optional[float],
                 speed_mps: float, rest: bool = True, within_m: float = WITHIN_M,
                 by_odometry: bool = False, acts: Tuple[Act, ...] = ()) -> None:
        self._pilot = Pilot(start.body, speed_mps)
        self._place = (x_m, y_m)
        self._heading_rad = heading_rad
        self._rest = rest
        self._within_m = within_m
        self._by_odometry = by_odometry
        self._acts = acts
        self._there = False
        self._nearest_m = math.inf
        self._nearer_at = -math.inf

    def step(self, senses: Senses) -> Step:
        """Return the next step towards the position."""
        if not self._by_odometry and not is_inside(senses.fence, *self._place):
            return Step(state=FAILED, text='its goal is outside the fence')
        return self.from_pose(senses, senses.odometry if self._by_odometry else senses.pose)

    def from_pose(self, senses: Senses, pose: Pose) -> Step:
        """Return the next step from a pose in the frame of the position."""
        left_m = way(pose, *self._place)
        self._there = self._there or left_m <= self._within_m
        if self._there:
            return self._turn(pose, left_m)
        if left_m < self._nearest_m - PROGRESS_M or self._nearer_at == -math.inf:
            self._nearest_m, self._nearer_at = left_m, senses.now_s
        if senses.now_s - self._nearer_at > STUCK_S:
            return Step(state=BLOCKED, left_m=left_m, text='it came no nearer to its goal for '
                        '{:.0f} s: {:.1f} m are left'.format(STUCK_S, left_m))
        velocity = self._pilot.towards(senses, pose, *self._place, rest=self._rest)
        if velocity is None:
            return Step(state=WAITING, left_m=left_m, text='no way around what is in front of it')
        return Step(velocity, left_m=left_m, text='{:.1f} m to go'.format(left_m))

    def _turn(self, pose: Pose, left_m: float) -> Step:
        velocity = None if self._heading_rad is None \
            else self._pilot.turned(pose, self._heading_rad)
        if velocity is None:
            return Step(state=DONE, left_m=left_m, acts=self._acts,
                        text='arrived, {:.2f} m off'.format(left_m))
        return Step(velocity, left_m=left_m, text='turns to its heading')


def spread(place: Pose, number: int) -> Tuple[float, float]:
    """Return the goal of one robot of a team, side by side across the heading [m].

    :param number: its index in the team
    """
    # 0, 1, -1, 2, -2 ... to the left and right of the place.
    aside = SPREAD_M * ((number + 1) // 2) * (1.0 if number % 2 else -1.0)
    return beside(place, 0.0, aside)


def _middle(values: Values) -> Pose:
    """Return the goal of a team."""
    return Pose(values.number('x'), values.number('y'), values.maybe('heading') or 0.0)


def slots(values: Values, count: int, _: Where) -> Corners:
    """Return the goals of a team [m]; () by odometry, since each robot has its own."""
    return () if values.by_odometry() else tuple(
        spread(_middle(values), number) for number in range(count))


def target_of(values: Values, start: Start) -> Target:
    """Return the goal of one robot of a team."""
    place = spread(_middle(values), start.place)
    return Target(*place, heading_rad=values.maybe('heading'), by_odometry=values.by_odometry())


def make(values: Values, start: Start) -> Goto:
    """Start; a team ends side by side across the heading, one of them at the position."""
    target = target_of(values, start)
    return Goto(start, target.x_m, target.y_m, target.heading_rad, values.number('speed'),
                by_odometry=target.by_odometry,
                acts=read_acts(values.text('act'), 1, start.accessories).get(0, ()))


ROW = TaskKind(
    'goto', 'Go to', 'to a place, around a single thing in the way; several robots side by side',
    (Field('x', 'm', 'ahead of where its frame begins', REQUIRED, -1000.0, 1000.0),
     Field('y', 'm', 'to the left of where its frame begins', REQUIRED, -1000.0, 1000.0),
     Field('heading', 'rad', 'final heading', None, -7.0, 7.0), SPEED, FRAME,
     ACT, TIMEOUT_S),
    make, needs_place=True, slots=slots)
