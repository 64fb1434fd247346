# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task replay: repeats a recorded drive by its poses; reports the deviation.

The robot drives by odometry, as recorded, and backwards where the recorded drive did.
"""
from dataclasses import replace
import math
from typing import List, Optional, Sequence, Tuple

import numpy as np

from mhri.base.geometry import beside, Pose, within
from mhri.base.limits import Velocity
from mhri.sensors.brake import MARGIN_M
from mhri.tasks.base import (
    DONE, Field, Senses, Start, Step, Task, TaskKind, TEXT, Values, WAITING, way, wrapped)
from mhri.tasks.goto import Goto, SPEED, TIMEOUT_S
from mhri.tasks.pilot import Pilot

HERE, THERE = BEGINS = ('here', 'there')
# Minimum distance of the poses of a drive [m], and their maximum number.
STEP_M, MAX_PLACES = 0.05, 20000
# Tolerance of passing a pose, and of reaching the last one [m].
_PASSED_M, _REACHED_M = 0.12, 0.03
# Maximum part of a drive to leave out because of an obstacle [m].
_SKIPS_M = 1.5


def thinned(poses: Sequence[Pose]) -> Tuple[Pose, ...]:
    """Return the poses of a drive at a minimum spacing, including the last one."""
    kept: List[Pose] = []
    for pose in poses:
        if not kept or way(kept[-1], pose.x_m, pose.y_m) >= STEP_M:
            kept.append(pose)
    if len(kept) > 1 and way(kept[-1], poses[-1].x_m, poses[-1].y_m) > 0.0:
        kept.append(poses[-1])
    elif kept:
        kept[-1] = poses[-1]
    return tuple(kept)


def laid(drive: Sequence[Pose], begin: Pose) -> Tuple[Pose, ...]:
    """Return a drive transformed so that it starts at a pose."""
    first = drive[0]
    turn = begin.heading_rad - first.heading_rad
    return tuple(Pose(*beside(begin, *within(first, pose)),
                      heading_rad=wrapped(pose.heading_rad + turn)) for pose in drive)


class _Off:
    """The deviation of a robot from a drive, by one measurement."""

    def __init__(self, drive: Sequence[Pose], by: str) -> None:
        self._places = np.array([(pose.x_m, pose.y_m) for pose in drive])
        self._by = by
        self._seen: List[float] = []
        self._end_m = math.nan

    def see(self, pose: Pose) -> None:
        start = self._places[:-1] if len(self._places) > 1 else self._places
        along = (self._places[1:] if len(self._places) > 1 else self._places) - start
        gap = np.array((pose.x_m, pose.y_m)) - start
        share = np.clip((gap * along).sum(axis=1) / np.maximum((along ** 2).sum(axis=1), 1e-12),
                        0.0, 1.0)
        self._seen.append(float(np.hypot(*(gap - share[:, None] * along).T).min()))

        self._end_m = way(pose, *self._places[-1])

    def words(self) -> str:
        return 'by {} {:.3f} m at most, {:.3f} m on average, {:.3f} m at the end'.format(
            self._by, max(self._seen), sum(self._seen) / len(self._seen), self._end_m)


class Replay(Task):
    """Drives through the poses of a drive in order.

    :param drive: its poses by odometry, at least two
    :param begin: HERE: the drive starts where the robot is; THERE: it first drives to its start
    """

    def __init__(self, start: Start, drive: Sequence[Pose], begin: str, speed_mps: float) -> None:
        self._pilot = Pilot(start.body, speed_mps)
        self._room_m = start.body.radius_m + MARGIN_M
        self._drive = thinned(drive)
        first = self._drive[0]
        self._way_there = Goto(start, first.x_m, first.y_m, first.heading_rad, speed_mps,
                               by_odometry=True) if begin == THERE else None
        self._places: List[Pose] = []
        self._back: List[bool] = []
        self._left: List[float] = []
        self._next = 0
        self._arrived = False
        self._off: List[_Off] = []

    def step(self, senses: Senses) -> Step:
        """Return the next step towards the next pose."""
        if self._way_there is not None:
            there = self._way_there.step(senses)
            if there.state != DONE:
                return replace(there, text='to where the drive began: ' + there.text)
            self._way_there, text = None, 'the drive begins'
            self._begin(senses, self._drive)
            return Step(text=text, said=(text,))
        if not self._off:
            self._begin(senses, laid(self._drive, senses.odometry))
        self._measure(senses)
        return self._follow(senses)

    def _begin(self, senses: Senses, places: Tuple[Pose, ...]) -> None:
        self._places, self._back = list(places), _backwards(places)
        self._off = [_Off(places, 'odometry')]
        if senses.captured is not None:
            # Poses of the drive relative to the robot, by odometry.
            seen = [beside(senses.captured, *within(senses.odometry, pose)) for pose in places]
            self._off.append(_Off([Pose(x, y, 0.0) for x, y in seen], 'motion capture'))
        left = [0.0]
        for one, two in zip(places[:0:-1], places[-2::-1]):
            left.append(left[-1] + way(one, two.x_m, two.y_m))
        self._left = left[::-1]

    def _measure(self, senses: Senses) -> None:
        for off, pose in zip(self._off, (senses.odometry, senses.captured)):
            if pose is not None:
                off.see(pose)

    def _follow(self, senses: Senses) -> Step:
        pose = senses.odometry
        while self._next < len(self._places) - 1 and self._is_passed(pose):
            self._next += 1
        place, last = self._places[self._next], self._next == len(self._places) - 1
        near_m = way(pose, place.x_m, place.y_m)
        if last and (self._arrived or near_m < _REACHED_M):
            return self._turn(pose, place)
        left_m = near_m + self._left[self._next]
        aim = self._free_place(senses)
        velocity = None if aim is None else self._towards(senses, aim, last)
        if velocity is None:
            return Step(state=WAITING, left_m=left_m, text='an obstacle is on its way')
        return Step(velocity, left_m=left_m, text='{:.1f} m of the drive to go'.format(left_m))

    def _is_passed(self, pose: Pose) -> bool:
        """Return whether the next pose is passed; at a turning point, whether it was reached."""
        turns = self._back[self._next] != self._back[self._next + 1]
        place = self._places[self._next]
        return way(pose, place.x_m, place.y_m) < (_REACHED_M if turns else _PASSED_M)

    def _free_place(self, senses: Senses) -> Optional[Pose]:
        """Return the next pose, or one soon after it if that is blocked; None if all are."""
        for number in range(self._next, len(self._places)):
            place = self._places[number]
            if self._left[self._next] - self._left[number] > _SKIPS_M:
                return None
            off = senses.points - within(senses.odometry, place)
            if not (np.hypot(*off.T) < self._room_m).any():
                self._next = number
                return place
        return None

    def _towards(self, senses: Senses, place: Pose, last: bool) -> Optional[Velocity]:
        if not self._back[self._next]:
            return self._pilot.towards(senses, senses.odometry, place.x_m, place.y_m, rest=last)
        pose = senses.odometry
        turned = Pose(pose.x_m, pose.y_m, wrapped(pose.heading_rad + math.pi))
        velocity = self._pilot.towards(replace(senses, points=-senses.points), turned, place.x_m,
                                       place.y_m, rest=last)
        return velocity and Velocity(-velocity.linear_mps, velocity.angular_rad_s)

    def _turn(self, pose: Pose, place: Pose) -> Step:
        """Return the step of the final turn, then the deviation."""
        self._arrived = True
        velocity = self._pilot.turned(pose, place.heading_rad)
        if velocity is not None:
            return Step(velocity, left_m=0.0, text='turns to the final heading')
        text = 'it was off ' + '; '.join(off.words() for off in self._off)
        return Step(state=DONE, left_m=0.0, text=text, said=(text,))


def _backwards(places: Sequence[Pose]) -> List[bool]:
    """Return for each pose whether the drive reached it backwards."""
    back = [within(one, two)[0] < 0.0 for one, two in zip(places, places[1:])]
    return back[:1] + back


def make(values: Values, start: Start) -> Replay:
    """Start with the drive of a bag, else with the newest part of the robot's own trail.

    :raises ValueError: there is no drive
    """
    drive = start.drive
    if not values.text('bag'):
        seconds = values.number('seconds')
        drive = tuple(pose for pose, age_s in zip(start.trail, start.trail_ages_s)
                      if age_s <= seconds)
    if len(drive) < 2:
        raise ValueError('nothing to replay: ' + (
            'in the bag it does not move' if values.text('bag') else
            'it did not move within the last {:g} s; or name a bag'.format(seconds)))
    return Replay(start, drive, values.text('begin'), values.number('speed'))


ROW = TaskKind(
    'replay', 'Replay', 'repeats a recorded drive by its poses; reports the deviation', (
        Field('bag', '', 'file of the recording; else the robot\'s own trail', '', kind=TEXT),
        Field('topic', '', 'of the bag: odometry or poses; else the robot\'s odometry', '',
              kind=TEXT),
        Field('seconds', 's', 'newest part of its own trail', 60.0, 1.0, 86400.0),
        Field('begin', '', 'here: where it is; there: where the drive began, by odometry',
              HERE, kind=TEXT, choices=BEGINS),
        SPEED, TIMEOUT_S), make)
