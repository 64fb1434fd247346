# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task follow: keeps a distance behind a leader, on the leader's trail; also in chains."""
import math
from typing import List, Tuple

from mhri.base.limits import Velocity
from mhri.tasks.base import (
    Field, LOST, REQUIRED, Senses, Start, Step, Task, TaskKind, TEXT, Values, WAITING, way)
from mhri.tasks.hold import ROW as HOLD
from mhri.tasks.pilot import Pilot

_STEP_M, _AHEAD_M = 0.05, 0.25
# Gain of the speed on the distance error [1/s].
_CATCH_UP = 0.8
# It drives on when the distance exceeds the set one by this [m].
_SLACK_M = 0.05


class Follow(Task):
    """Follows the trail of a leader without cutting corners.

    :param leader: its name
    :param distance_m: distance to keep along the trail
    """

    def __init__(self, start: Start, leader: str, distance_m: float, speed_mps: float) -> None:
        self._leader = leader
        self.pass_by = (leader,)
        self._distance_m = distance_m
        self._speed_mps = min(speed_mps, start.body.limits.linear_mps)
        self._pilot = Pilot(start.body, speed_mps)
        self._trail: List[Tuple[float, float]] = []

    def step(self, senses: Senses) -> Step:
        """Return the next step after the leader."""
        leader = senses.others.get(self._leader)
        if leader is None:
            return Step(state=LOST, text='the position of {} is unknown'.format(self._leader))
        pose, place = senses.pose, (leader.pose.x_m, leader.pose.y_m)
        if not self._trail or way(leader.pose, *self._trail[-1]) > _STEP_M:
            self._trail.append(place)
        self._trail = self._trail[-2000:]
        while len(self._trail) > 1 and way(pose, *self._trail[0]) < _AHEAD_M:
            self._trail.pop(0)
        gap_m = self._gap(pose.x_m, pose.y_m, place)
        over_m = gap_m - self._distance_m
        if over_m < _SLACK_M:
            return Step(text='{:.1f} m behind {}'.format(gap_m, self._leader),
                        left_m=max(0.0, over_m))
        velocity = self._pilot.towards(senses, pose, *self._trail[0], rest=False)
        text = 'target {:.1f} m, {:.1f} m behind {}'.format(self._distance_m, gap_m, self._leader)
        if velocity is None:
            return Step(state=WAITING, left_m=over_m,
                        text='an obstacle is between it and its leader')
        most = min(velocity.linear_mps, _CATCH_UP * over_m)
        return Step(Velocity(most, velocity.angular_rad_s), text=text, left_m=over_m)

    def _gap(self, x_m: float, y_m: float, leader: Tuple[float, float]) -> float:
        """Return the distance to the leader along the trail [m]."""
        corners = [(x_m, y_m)] + self._trail + [leader]
        return sum(math.dist(*pair) for pair in zip(corners, corners[1:]))


def make(values: Values, start: Start) -> Follow:
    """Start: the first of a team follows the leader, each other robot the one before it.

    :raises ValueError: a robot cannot follow itself
    """
    leader = start.team[start.place - 1] if start.place else values.text('leader')
    if leader == start.robot:
        raise ValueError('it cannot follow itself')
    return Follow(start, leader, values.number('distance'), values.number('speed'))


ROW = TaskKind(
    'follow', 'Follow', 'keeps a distance behind a leader; several robots in a chain',
    (Field('leader', '', 'name of the robot that the first one follows', REQUIRED, kind=TEXT),
     Field('distance', 'm', 'between centres, along the trail', 0.8, 0.3, 10.0),
     Field('speed', 'm/s', 'maximum speed', 0.3, 0.02, 2.0), HOLD.fields[1]),
    make, needs_place=True)
