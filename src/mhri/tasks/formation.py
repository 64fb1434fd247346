# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task formation: keeps a slot in a line, column or wedge around a leader, also in bends.

Slots are relative to the path of the leader, not to its heading, so that a leader that turns on the
spot does not swing the formation around.
"""
from dataclasses import dataclass, replace
import math
from typing import List, Optional, Tuple

import numpy as np

from mhri.base.geometry import beside, Pose
from mhri.base.limits import Velocity
from mhri.tasks.base import (
    circles, Corners, Field, LOST, REQUIRED, Senses, Start, Step, Task, TaskKind, TEXT, Values,
    WAITING, way, Where)
from mhri.tasks.hold import ROW as HOLD
from mhri.tasks.pilot import Pilot

LINE, COLUMN, WEDGE = SHAPES = ('line', 'column', 'wedge')
_STEP_M, _MAX_PLACES = 0.05, 4000
# Length of path that determines its direction; longer for slots further to the side [m].
_CHORD_M, _CHORD_PER_M = 0.2, 0.5
# Look-ahead beyond its slot [m]; at a larger distance it drives to the slot itself.
_AHEAD_M, _NEAR_M = 0.45, 0.6
# Gain of the speed on the distance to its slot [1/s].
_CATCH_UP = 1.0
# Smoothing of the speed of its slot [s]; below this speed it counts as stopped [m/s].
_SMOOTH_S, _STANDS_MPS = 0.3, 0.03
# Tolerance at a stopped slot [m]; beyond the second one it drives there again.
_THERE_M, _LEFT_M = 0.06, 0.12
# A robot ahead of its slot turns back only after this time, since its leader may drive on [s].
_WAITS_S = 2.0
# Laser points nearer to a robot than this belong to it [m].
_SEEN_WITHIN_M = 0.15


class LeaderPath:
    """The path driven by a leader, extended straight to the back."""

    def __init__(self) -> None:
        self._places: List[Tuple[float, float]] = []
        self._first: Optional[Pose] = None
        self._newest: Optional[Pose] = None

    def add(self, pose: Pose) -> None:
        """Add a pose of the leader; the part that it backs over is removed."""
        if self._first is None:
            self._first = pose
            self._places.append((pose.x_m, pose.y_m))
        while len(self._places) > 1 and way(pose, *self._places[-2]) < math.dist(
                *self._places[-2:]):
            self._places.pop()
        if way(pose, *self._places[-1]) > _STEP_M:
            self._places.append((pose.x_m, pose.y_m))
            del self._places[:-_MAX_PLACES]
        self._newest = pose

    def at(self, behind_m: float) -> Tuple[float, float]:
        """Return the position (x, y) [m] at a distance behind the leader along its path."""
        assert self._newest is not None and self._first is not None
        here = (self._newest.x_m, self._newest.y_m)
        for place in reversed(self._places):
            step_m = math.dist(here, place)
            if step_m >= behind_m:
                share = behind_m / step_m if step_m else 0.0
                return (here[0] + share * (place[0] - here[0]),
                        here[1] + share * (place[1] - here[1]))
            behind_m -= step_m
            here = place
        back = Pose(here[0], here[1], self._first.heading_rad)
        return beside(back, -behind_m, 0.0)

    def pose(self, behind_m: float, left_m: float) -> Pose:
        """Return the pose at a distance behind the leader along its path, and to the left."""
        chord_m = max(_CHORD_M, _CHORD_PER_M * abs(left_m))
        begin_m = max(0.0, behind_m - 0.5 * chord_m)
        ahead, back = self.at(begin_m), self.at(begin_m + chord_m)
        heading = math.atan2(ahead[1] - back[1], ahead[0] - back[0])
        middle = Pose(*self.at(behind_m), heading_rad=heading)
        return Pose(*beside(middle, 0.0, left_m), heading_rad=heading)


@dataclass(frozen=True)
class Slot:
    """A slot of a formation: behind the leader along its path, and to its left [m]."""

    behind_m: float
    left_m: float


def slot_of(shape: str, spacing_m: float, place: int) -> Slot:
    """Return the slot of a team's robot; in line and wedge the first goes left, the next right.

    :param spacing_m: between centres
    :param place: index of the robot
    """
    if shape == COLUMN:
        return Slot(spacing_m * (place + 1), 0.0)
    rank, side = place // 2 + 1, 1.0 if place % 2 == 0 else -1.0
    if shape == LINE:
        return Slot(0.0, side * spacing_m * rank)
    each_m = spacing_m * math.sqrt(0.5) * rank
    return Slot(each_m, side * each_m)


class Formation(Task):
    """Keeps a slot beside or behind a leader.

    :param leader: its name
    """

    def __init__(self, start: Start, leader: str, slot: Slot, speed_mps: float) -> None:
        self._leader = leader
        self.pass_by = (leader,) + start.team
        self._slot = slot
        self._pilot = Pilot(start.body, speed_mps)
        self._path = LeaderPath()
        self._last: Optional[Tuple[float, Pose]] = None
        self._speed_mps = self._moved_s = 0.0
        self._there = False

    def step(self, senses: Senses) -> Step:
        """Return the next step towards the slot."""
        leader = senses.others.get(self._leader)
        if leader is None:
            return Step(state=LOST, text='the position of {} is unknown'.format(self._leader))
        self._path.add(leader.pose)
        slot = self._path.pose(self._slot.behind_m, self._slot.left_m)
        self._update_speed(slot, senses.now_s)
        off_m = way(senses.pose, slot.x_m, slot.y_m)
        velocity = self._moving(senses, slot, off_m) if self._speed_mps > _STANDS_MPS \
            else self._standing(senses, slot, off_m)
        if velocity is None:
            return Step(state=WAITING, left_m=off_m, text='an obstacle is between it and its place')
        return Step(velocity, left_m=off_m, text='in formation with {}, {:.2f} m off'.format(
            self._leader, off_m))

    def _update_speed(self, slot: Pose, now_s: float) -> None:
        """Measure the forward speed of the slot."""
        if self._last is not None and now_s > self._last[0]:
            before, passed_s = self._last[1], now_s - self._last[0]
            speed = _ahead(before, slot) / passed_s
            self._speed_mps += (speed - self._speed_mps) * min(1.0, passed_s / _SMOOTH_S)
        self._moved_s = now_s if self._last is None else self._moved_s
        self._last = (now_s, slot)

    def _moving(self, senses: Senses, slot: Pose, off_m: float) -> Optional[Velocity]:
        self._there, self._moved_s = False, senses.now_s
        behind_m = _ahead(senses.pose, slot, slot.heading_rad)
        most = max(0.0, self._speed_mps + _CATCH_UP * behind_m)
        far = off_m > _NEAR_M and behind_m > 0.0
        aim = (slot.x_m, slot.y_m) if far else beside(
            slot, max(0.0, -behind_m) + _AHEAD_M, 0.0)
        # In formation it ignores the others, which move on; the brake still stops for them.
        seen = senses if far else replace(senses, points=_without(senses, self.pass_by))
        velocity = self._pilot.towards(seen, senses.pose, *aim, rest=False)
        if velocity is None:
            return None
        return Velocity(min(most, velocity.linear_mps), velocity.angular_rad_s)

    def _standing(self, senses: Senses, slot: Pose, off_m: float) -> Optional[Velocity]:
        self._there = off_m < (_LEFT_M if self._there else _THERE_M)
        if senses.now_s - self._moved_s < _WAITS_S and _ahead(
                senses.pose, slot, slot.heading_rad) < 0.0:
            return Velocity()
        if self._there:
            return self._pilot.turned(senses.pose, slot.heading_rad) or Velocity()
        return self._pilot.towards(senses, senses.pose, slot.x_m, slot.y_m)


def _ahead(pose: Pose, place: Pose, heading_rad: Optional[float] = None) -> float:
    """Return how far a position is ahead of a pose along a heading [m]."""
    heading = pose.heading_rad if heading_rad is None else heading_rad
    return (place.x_m - pose.x_m) * math.cos(heading) + (place.y_m - pose.y_m) * math.sin(heading)


def _without(senses: Senses, names: Tuple[str, ...]) -> np.ndarray:
    """Return the laser points except those of some robots, an array (n, 2) in its frame [m]."""
    points, others = senses.points, [
        senses.others[name] for name in set(names) & set(senses.others)]
    for x_m, y_m, radius_m in circles(senses.pose, others):
        points = points[np.hypot(points[:, 0] - x_m, points[:, 1] - y_m)
                        > radius_m + _SEEN_WITHIN_M]
    return points


def make(values: Values, start: Start) -> Formation:
    """Start.

    :raises ValueError: the leader is one of the team
    """
    leader = values.text('leader')
    if leader in start.team:
        raise ValueError('{} leads: start the others alone'.format(leader))
    slot = slot_of(values.text('shape'), values.number('spacing'), start.place)
    return Formation(start, leader, slot, values.number('speed'))


def slots(values: Values, count: int, where: Where) -> Corners:
    """Return the slots around the present pose of the leader, assuming a straight path."""
    leader = where(values.text('leader'))
    if leader is None:
        return ()
    found = (slot_of(values.text('shape'), values.number('spacing'), number)
             for number in range(count))
    return tuple(beside(leader, -slot.behind_m, slot.left_m) for slot in found)


ROW = TaskKind(
    'formation', 'Formation', 'in line, column or wedge with a leader; keeps its spacing in bends',
    (Field('leader', '', 'name of the robot at the centre of the line or at the head', REQUIRED,
           kind=TEXT),
     Field('shape', '', 'line, column or wedge', WEDGE, kind=TEXT, choices=SHAPES),
     Field('spacing', 'm', 'between centres', 0.8, 0.4, 10.0),
     Field('speed', 'm/s', 'maximum speed', 0.4, 0.02, 2.0), HOLD.fields[1]),
    make, needs_place=True, slots=slots)
