# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task hold: stays in place, and reports being pushed."""
import math
from typing import Optional, Tuple

from mhri.base.geometry import Pose
from mhri.tasks.base import (
    DONE, Field, RUNNING, Senses, Start, Step, Task, TaskKind, Values, way, wrapped)

PUSHED_M, PUSHED_RAD = 0.03, 0.09


class Hold(Task):
    """Stands still for a while.

    :param seconds: duration, 0: until it is ended
    """

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._place: Optional[Pose] = None
        self._captured = False
        self._begun_s = 0.0
        self._pushed = False

    def step(self, senses: Senses) -> Step:
        """Stand still, and check the odometry."""
        if self._place is None:
            self._captured, self._begun_s = senses.captured is not None, senses.now_s
        # Not its pose on the map, which may be corrected meanwhile.
        pose = senses.captured if self._captured else senses.odometry
        self._place = self._place or pose
        pose = pose or self._place
        assert pose is not None and self._place is not None
        off_m = way(self._place, pose.x_m, pose.y_m)
        turn = abs(wrapped(pose.heading_rad - self._place.heading_rad))
        text = 'it stands'
        said: Tuple[str, ...] = ()
        if off_m > PUSHED_M or turn > PUSHED_RAD:
            text = 'it was pushed by {:.2f} m and {:.0f} degrees'.format(off_m, math.degrees(turn))
            said = () if self._pushed else (text,)
            self._pushed = True
        stood_s = senses.now_s - self._begun_s
        over = self._seconds and stood_s >= self._seconds
        return Step(state=DONE if over else RUNNING, text=text, said=said)


def make(values: Values, start: Start) -> Hold:
    """Start."""
    return Hold(values.number('seconds'))


ROW = TaskKind('hold', 'Hold', 'stays in place, reports being pushed', (
    Field('seconds', 's', 'for so long, 0 until it is ended', 0.0, 0.0, 86400.0),
    Field('timeout', 's', 'timeout, 0 for none', 0.0, 0.0, 86400.0)), make)
