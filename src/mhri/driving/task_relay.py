# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Decision on whether the mux passes on the velocities of robots on a task."""
import collections
import math
from typing import Counter, Optional, Sequence, Tuple

from mhri.base.names import MAX_LENGTH, name_problem

MAX_ROBOTS = 100

PASS, PASS_ZEROS, NOTHING = 'pass', 'pass_zeros', 'nothing'


def team_problem(robots: Sequence[str],
                 twists: Sequence[Sequence[float]]) -> Optional[Tuple[str, str]]:
    """Return why a ``mhri/TeamTwist`` cannot be used, or None if it can.

    :param robots: names
    :param twists: for each, the six numbers of its Twist [m/s, rad/s]
    :returns: (the key of its counter, a sentence)
    """
    if len(robots) != len(twists):
        return 'lengths', '{} robots and {} twists: give one to each'.format(
            len(robots), len(twists))
    if len(robots) > MAX_ROBOTS:
        return 'too_many', '{} robots; at most {}'.format(len(robots), MAX_ROBOTS)
    for name in robots:
        problem = name_problem(name)
        if problem:
            return 'name', '{!r}: {}'.format(name[:MAX_LENGTH], problem)
    if len(set(robots)) < len(robots):
        return 'twice', 'a robot is named twice'
    if not all(math.isfinite(value) for twist in twists for value in twist):
        return 'not_finite', 'NaN or infinity in a twist'
    return None


class TaskRelay:
    """Decides what to do with each message; counts those refused and those held back."""

    def __init__(self) -> None:
        self.refused: Counter[str] = collections.Counter()
        self.held: Counter[str] = collections.Counter()
        self._moving = False

    def judge(self, robots: Sequence[str], twists: Sequence[Sequence[float]], stopped: bool,
              enabled: bool, is_new: bool) -> Tuple[str, str]:
        """Return (PASS, PASS_ZEROS or NOTHING, the problem of the message or '').

        :param stopped: whether stop-all is in force; then nothing is passed on, since the robots
            have got their zeros
        :param enabled: whether the enabling pedal is pressed or does not exist; after its release
            moving robots get zeros once
        :param is_new: whether the message is newer than 0.25 s
        """
        problem = team_problem(robots, twists)
        if problem:
            self.refused[problem[0]] += 1
            return NOTHING, problem[1]
        was_moving, self._moving = self._moving, False
        if stopped or not is_new:
            self.held['stop' if stopped else 'old'] += 1
            return NOTHING, ''
        if not enabled:
            self.held['enabling'] += 1
            return PASS_ZEROS if was_moving else NOTHING, ''
        self._moving = True
        return PASS, ''
