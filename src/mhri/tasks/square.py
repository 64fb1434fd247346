# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task square: drives a square by odometry, and reports its final error."""
import math
from typing import List, Optional, Tuple

from mhri.base.geometry import beside, Pose
from mhri.tasks.base import (
    DONE, Field, REQUIRED, RUNNING, Senses, shown, Start, Step, Task, TaskKind, Values, way,
    wrapped)
from mhri.tasks.goto import Goto, SPEED, TIMEOUT_S


class Square(Task):
    """Four sides by odometry; each corner is reported when it is reached.

    :param number: number of rounds
    """

    def __init__(self, start: Start, side_m: float, number: int, speed_mps: float) -> None:
        self._start = start
        self._side_m = side_m
        self._number = number
        self._speed_mps = speed_mps
        self._begun: Optional[Tuple[Pose, Optional[Pose]]] = None
        self._legs: List[Goto] = []
        self._corner = 0

    def step(self, senses: Senses) -> Step:
        """Return the next step towards the next corner."""
        if self._begun is None:
            self._begun = (senses.odometry, senses.captured)
            self._legs = self._lay(senses.odometry)
        done = self._legs[0].from_pose(senses, senses.odometry)
        left_m = (done.left_m or 0.0) + self._side_m * (len(self._legs) - 1)
        if done.state != DONE:
            text = 'corner {} of {}: {}'.format(self._corner + 1, 4 * self._number, done.text)
            return Step(done.velocity, done.state, text, left_m)
        self._legs.pop(0)
        self._corner += 1
        said = 'corner {}: {}'.format(self._corner, shown(senses.odometry))
        if senses.captured is not None:
            said += '; by motion capture {}'.format(shown(senses.captured))
        if self._legs:
            return Step(state=RUNNING, text=said, left_m=left_m, said=(said,))
        error = self._error(senses)
        return Step(state=DONE, text=error, left_m=0.0, said=(said, error))

    def _lay(self, pose: Pose) -> List[Goto]:
        """Return the legs of all rounds: ahead, then to the left each time."""
        side, legs = self._side_m, []
        corners = ((side, 0.0), (side, side), (0.0, side), (0.0, 0.0))
        for _ in range(self._number):
            for turns, corner in enumerate(corners, 1):
                heading = wrapped(pose.heading_rad + 0.5 * math.pi * turns)
                legs.append(Goto(self._start, *beside(pose, *corner), heading, self._speed_mps,
                                 within_m=0.03))
        return legs

    def _error(self, senses: Senses) -> str:
        """Report how far from its start the robot ended, by each measurement."""
        assert self._begun is not None
        words = ['by odometry ' + _apart(self._begun[0], senses.odometry)]
        if self._begun[1] is not None and senses.captured is not None:
            words.append('by motion capture ' + _apart(self._begun[1], senses.captured))
        return 'it ended {} from its start'.format(', '.join(words))


def _apart(one: Pose, other: Pose) -> str:
    return '{:.3f} m and {:.1f} degrees'.format(
        way(one, other.x_m, other.y_m),
        math.degrees(abs(wrapped(other.heading_rad - one.heading_rad))))


def make(values: Values, start: Start) -> Square:
    """Start."""
    return Square(start, values.number('side'), int(values.number('number')),
                  values.number('speed'))


ROW = TaskKind(
    'square', 'Square', 'to the left, by odometry; reports each corner, and the final error',
    (Field('side', 'm', 'length of a side', REQUIRED, 0.2, 100.0),
     Field('number', '', 'rounds', 1.0, 1.0, 100.0, whole=True), SPEED, TIMEOUT_S), make)
