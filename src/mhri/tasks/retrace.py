# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task return: to a mark, or back along the robot's own trail, by odometry."""
import math
from typing import List, Optional, Sequence, Tuple

import numpy as np

from mhri.base.config import shown
from mhri.base.mocap import Pose
from mhri.tasks.base import (
    Corners, DONE, Field, MARK, Senses, Start, Step, Task, TaskKind, TEXT, Values, WAITING, way,
    Where, wrapped)
from mhri.tasks.goto import Goto, SPEED, spread, TIMEOUT_S
from mhri.tasks.pilot import Pilot

# Places of a trail are this far apart [m], and so many at most: the oldest go.
STEP_M, MOST_PLACES = 0.1, 5000
# A place counts as passed when the robot is this near [m]; the last one as reached.
PASSED_M, THERE_M = 0.2, 0.06
# Where a trail comes so near to itself again, what lies between is left out on the way back [m].
CUT_M = 0.15


class Trail:
    """Where a robot has been, in the frame of its odometry."""

    def __init__(self) -> None:
        self._places: List[Pose] = []
        self._times: List[float] = []

    def add(self, pose: Pose, now_s: float = 0.0) -> None:
        """Take in a pose; one that leaps (its odometry began anew) begins the trail anew."""
        if self._places:
            moved_m = way(self._places[-1], pose.x_m, pose.y_m)
            if moved_m < STEP_M:
                return
            if moved_m > 1.0:
                self._places.clear()
                self._times.clear()
        self._places.append(pose)
        self._times.append(now_s)
        del self._places[:-MOST_PLACES], self._times[:-MOST_PLACES]

    def places(self) -> Tuple[Pose, ...]:
        """Return them, the oldest first."""
        return tuple(self._places)

    def ages_s(self, now_s: float) -> Tuple[float, ...]:
        """Return how long ago it was at each of them [s]."""
        return tuple(now_s - at_s for at_s in self._times)


class Path(Task):
    """Drives along places one after the other.

    :param places: (x, y) [m], the first one first
    :param heading_rad: to look at in the end, None: as it comes
    :param by_odometry: they are in the frame of odometry, not in that of the pose
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
        """Return what leads to the next place."""
        pose = senses.odometry if self._by_odometry else senses.pose
        while len(self._places) > 1 and way(pose, *self._places[0]) < self._passed_m:
            self._places.pop(0)
        last = len(self._places) == 1
        near_m = way(pose, *self._places[0])
        if last and near_m < THERE_M:
            velocity = None if self._heading_rad is None \
                else self._pilot.turned(pose, self._heading_rad)
            if velocity is None:
                return Step(state=DONE, left_m=0.0, text='it is there')
            return Step(velocity, left_m=0.0, text='turns to its heading')
        left_m = near_m + sum(math.dist(*pair) for pair in zip(self._places, self._places[1:]))
        velocity = self._pilot.towards(senses, pose, *self._places[0], rest=last)
        if velocity is None:
            return Step(state=WAITING, left_m=left_m, text='something is on its way')
        return Step(velocity, left_m=left_m, text='{:.1f} m to go'.format(left_m))


def make(values: Values, start: Start) -> Task:
    """Begin: to a mark, side by side, or with the newest place of the trail, without its loops.

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
        raise ValueError('it has no trail yet: nobody has seen it move')
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
    """Return a way with each loop left out: from a place on to the last that is so near to it [m].

    So a robot drives where it has been, and beside it by no more than that.
    """
    kept, number, all_places = [places[0]], 0, np.array(places)
    while number < len(places) - 1:
        apart = np.hypot(*(all_places[number + 1:] - all_places[number]).T)
        number += 1 + int(np.append(0, np.flatnonzero(apart <= cut_m))[-1])
        kept.append(places[number])
    return tuple(kept)


def slots(values: Values, count: int, where: Where) -> Corners:
    """Return where the robots of a team end [m]: side by side at the mark; none without one."""
    mark = where(MARK + values.text('mark')) if values.text('mark') else None
    return tuple(spread(mark, number) for number in range(count)) if mark else ()


ROW = TaskKind(
    'return', 'Return', 'to a mark, or back along its own trail to where it was first seen',
    (Field('mark', '', 'name of a mark; else along its trail, by odometry', '', kind=TEXT,
           needs_place=True),
     Field('distance', 'm', 'go back by no more than this, 0 for all of it', 0.0, 0.0, 10000.0),
     SPEED, TIMEOUT_S), make, slots=slots)
