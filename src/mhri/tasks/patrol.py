# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The task patrol: drives along a route, once or repeatedly."""
from typing import Optional

from mhri.tasks.acts import ACT, read_acts
from mhri.tasks.base import (
    DONE, Field, FRAME, REQUIRED, ROUTE, RUNNING, Senses, Start, Step, Task, TaskKind, Values)
from mhri.tasks.goto import Goto, SPEED
from mhri.tasks.hold import ROW as HOLD

TIMEOUT_S = HOLD.fields[1]


class Patrol(Task):
    """Visits the corners of a route.

    :param rounds: number of rounds, 0: until it is ended
    """

    def __init__(self, start: Start, values: Values) -> None:
        self._start = start
        self._route = values.route('route')
        self._rounds = int(values.number('rounds'))
        self._speed_mps = values.number('speed')
        self._by_odometry = values.by_odometry()
        self._acts = read_acts(values.text('act'), len(self._route), start.accessories)
        self._passed = 0
        self._leg: Optional[Goto] = None

    def step(self, senses: Senses) -> Step:
        """Return the next step towards the next corner."""
        corner = self._passed % len(self._route)
        if self._leg is None:
            self._leg = Goto(self._start, *self._route[corner], None, self._speed_mps,
                             within_m=0.1, by_odometry=self._by_odometry)
        done = self._leg.step(senses)
        words = 'round {}, corner {}'.format(self._passed // len(self._route) + 1, corner + 1)
        if done.state != DONE:
            return Step(done.velocity, done.state, '{}: {}'.format(words, done.text), done.left_m)
        self._leg = None
        self._passed += 1
        over = self._rounds and self._passed == self._rounds * len(self._route)
        return Step(state=DONE if over else RUNNING, said=(words + ' reached',),
                    acts=self._acts.get(corner, ()),
                    text='it has completed its route' if over else words + ' reached')


ROW = TaskKind('patrol', 'Patrol', 'along a route, once or repeatedly', (
    Field('route', 'm', 'its corners: [[x, y], ...]', REQUIRED, kind=ROUTE),
    Field('rounds', '', 'how often, 0 until it is ended', 0.0, 0.0, 10000.0, whole=True),
    SPEED, FRAME, ACT, TIMEOUT_S), lambda values, start: Patrol(start, values), needs_place=True)
