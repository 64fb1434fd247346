# SPDX-FileCopyrightText: 2026 The lab
# SPDX-License-Identifier: BSD-3-Clause
"""The task look_around: turn once on the spot, and say how far away the nearest thing was."""
import math

from mhri.base.limits import Velocity
from mhri.tasks.base import DONE, Field, Step, Task, TaskKind, wrapped
from mhri.tasks.goto import TIMEOUT_S
import numpy as np


class LookAround(Task):
    """Turns once to the left."""

    def __init__(self, turn_rad_s):
        self.turn_rad_s = turn_rad_s
        self.left_rad = 2.0 * math.pi
        self.heading_rad = None
        self.nearest_m = math.inf

    def step(self, senses):
        """Return what the robot shall do now; called 20 times a second: never wait here."""
        heading_rad = senses.odometry.heading_rad
        if self.heading_rad is not None:
            self.left_rad -= wrapped(heading_rad - self.heading_rad)
        self.heading_rad = heading_rad
        if len(senses.points):
            self.nearest_m = min(self.nearest_m, np.hypot(*senses.points.T).min())
        if self.left_rad <= 0.0:
            return Step(state=DONE, text='nearest thing {:.2f} m away'.format(self.nearest_m))
        return Step(Velocity(0.0, self.turn_rad_s),
                    text='{:.0f} degrees to go'.format(math.degrees(self.left_rad)))


def make(values, start):
    """Begin it for one robot; a ValueError says in a sentence why this cannot be."""
    if start.body.limits.angular_rad_s < 0.1:
        raise ValueError('it turns too slowly to look around')
    return LookAround(values.number('turn'))


ROW = TaskKind(
    'look_around', 'Look around', 'turns once on the spot, and says how near the nearest thing is',
    (Field('turn', 'rad/s', 'how fast it turns', 0.5, 0.1, 1.5), TIMEOUT_S), make)
