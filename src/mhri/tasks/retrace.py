# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task return: drives to a mark, or back along the robot's own trail, by odometry."""
import math
from typing import List, Optional, Sequence, Tuple

import numpy as np

from mhri.base.config import shown
from mhri.base.geometry import Pose
from mhri.tasks.base import (
    Corners, DONE, Field, MARK, Senses, Start, Step, Task, TaskKind, TEXT, Values, WAITING, way,
    Where, wrapped)
from mhri.tasks.goto import Goto, SPEED, spread, TIMEOUT_S
from mhri.tasks.pilot import Pilot

# Distance of the points of a trail [m], and their maximum number; the oldest are dropped.
STEP_M, MAX_PLACES = 0.1, 5000
# Tolerance of passing a point, and of reaching the last one [m].
PASSED_M, THERE_M = 0.2, 0.06
# Loops that close within this distance are cut on the way back [m].
CUT_M = 0.15


class Trail:
    """The trail of a robot, in the frame of its odometry."""

    def __init__(self) -> None:
        self._places: List[Pose] = []
        self._times: List[float] = []

    def add(self, pose: Pose, now_s: float = 0.0) -> None:
        """Add a pose; a jump (of restarted odometry) starts a new trail."""
        if self._places:
            moved_m = way(self._places[-1], pose.x_m, pose.y_m)
            if moved_m < STEP_M:
                return
            if moved_m > 1.0:
                self._places.clear()
                self._times.clear()
        self._places.append(pose)
        self._times.append(now_s)
        del self._places[:-MAX_PLACES], self._times[:-MAX_PLACES]

    def places(self) -> Tuple[Pose, ...]:
        """Return its points, the oldest first."""
        return tuple(self._places)

    def ages_s(self, now_s: float) -> Tuple[float, ...]:
        """Return the age of each point [s]."""
        return tuple(now_s - at_s for at_s in self._times)


class Path(Task):
    """Drives along points in order.

    :param places: (x, y) [m]
    :param heading_rad: final heading, None: any
    :param by_odometry: whether they are in the frame of odometry, not in that of the pose
    """

    def __init__(self, start: Start, places: Corners, speed_mps: float,
                 heading_rad: Optional[float] = None, by_odometry: bool = False,
                 passed_m: float = PASSED_M) -> None:
        self._pilot = Pilot(start.body, speed_mps)
        self._places = list(places)
        self._heading_rad = heading_rad
        self._by_odometry = by_odometry
        self._passed_m = passed_m

    def step(self, senses: Senses) -> Step:
        """Return the next step towards the next point."""
        pose = senses.odometry if self._by_odometry else senses.pose
        while len(self._places) > 1 and way(pose, *self._places[0]) < self._passed_m:
            self._places.pop(0)
        last = len(self._places) == 1
        near_m = way(pose, *self._places[0])
        if last and near_m < THERE_M:
            velocity = None if self._heading_rad is None \
                else self._pilot.turned(pose, self._heading_rad)
            if velocity is None:
                return Step(state=DONE, left_m=0.0, text='arrived')
            return Step(velocity, left_m=0.0, text='turns to its heading')
        left_m = near_m + sum(math.dist(*pair) for pair in zip(self._places, self._places[1:]))
        velocity = self._pilot.towards(senses, pose, *self._places[0], rest=last)
        if velocity is None:
            return Step(state=WAITING, left_m=left_m, text='an obstacle is on its way')
        return Step(velocity, left_m=left_m, text='{:.1f} m to go'.format(left_m))


def make(values: Values, start: Start) -> Task:
    """Start: to a mark, side by side, or back along the trail without its loops.

    :raises ValueError: there is no such mark, or the robot has no trail
    """
    if values.text('mark'):
        mark = start.marks.get(values.text('mark'))
        if mark is None:
            raise ValueError('there is no mark {}; there are: {}'.format(
                shown(values.text('mark')), ', '.join(sorted(start.marks)) or 'none'))
        return Goto(start, *spread(mark, start.place), mark.heading_rad, values.number('speed'))
    most_m, trail, gone_m = values.number('distance'), list(reversed(start.trail)), 0.0
    if not trail:
        raise ValueError('it has no trail yet, since it has not moved')
    kept = [trail[0]]
    for pose in trail[1:]:
        gone_m += way(kept[-1], pose.x_m, pose.y_m)
        if most_m and gone_m > most_m:
            break
        kept.append(pose)
    places = without_loops([(pose.x_m, pose.y_m) for pose in kept],
                           min(CUT_M, start.body.radius_m))
    return Path(start, places, values.number('speed'),
                wrapped(kept[-1].heading_rad), by_odometry=True)


def without_loops(places: Sequence[Tuple[float, float]], cut_m: float) -> Corners:
    """Return a path without loops: after each point, skip to the last one within a distance [m].

    Thus the robot stays within that distance of its own path.
    """
    kept, number, all_places = [places[0]], 0, np.array(places)
    while number < len(places) - 1:
        apart = np.hypot(*(all_places[number + 1:] - all_places[number]).T)
        number += 1 + int(np.append(0, np.flatnonzero(apart <= cut_m))[-1])
        kept.append(places[number])
    return tuple(kept)


def slots(values: Values, count: int, where: Where) -> Corners:
    """Return the goals of a team [m]: side by side at the mark; () without one."""
    mark = where(MARK + values.text('mark')) if values.text('mark') else None
    return tuple(spread(mark, number) for number in range(count)) if mark else ()


ROW = TaskKind(
    'return', 'Return', 'to a mark, or back along its own trail to where it was first seen',
    (Field('mark', '', 'name of a mark; default: along its trail, by odometry', '', kind=TEXT,
           needs_place=True),
     Field('distance', 'm', 'maximum distance to go back, 0 for all of it', 0.0, 0.0, 10000.0),
     SPEED, TIMEOUT_S), make, slots=slots)
