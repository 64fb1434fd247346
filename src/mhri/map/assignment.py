# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Assigns robots to positions so that their paths do not cross."""
import math
from typing import List, Optional, Sequence, Tuple

import numpy as np

from mhri.base.geometry import Pose

# The paths of minimum total length never cross; among equal totals the most even ones are chosen:
# robots in a line do not pass each other.
_EVEN_PER_M2 = 1e-4


def assigned(costs: np.ndarray) -> List[int]:
    """Return a column for each row of costs (n, m >= n), all different, with minimum sum.

    The Hungarian method with potentials, O(n^2 m), as in e-maxx ("Assignment problem").
    """
    rows, columns = costs.shape
    up, left = np.zeros(rows), np.zeros(columns + 1)
    # The row of each column; the last column is the start of the row being assigned.
    row_of = np.full(columns + 1, -1)
    for row in range(rows):
        row_of[columns], here = row, columns
        least = np.full(columns, np.inf)
        before = np.full(columns, columns)
        free = np.ones(columns, dtype=bool)
        while row_of[here] >= 0:
            free[here:here + 1] = False  # beyond the end: nothing
            now = costs[row_of[here]] - up[row_of[here]] - left[:columns]
            better = free & (now < least)
            least[better], before[better] = now[better], here
            here = int(np.argmin(np.where(free, least, np.inf)))
            step, done = least[here], np.append(~free, True)
            up[row_of[done]] += step
            left[done] -= step
            least[free] -= step
        while here != columns:
            row_of[here] = row_of[before[here]]
            here = int(before[here])
    found = [0] * rows
    for column in range(columns):
        if row_of[column] >= 0:
            found[row_of[column]] = column
    return found


def shared_out(poses: Sequence[Optional[Pose]], places: Sequence[Tuple[float, float]]
               ) -> List[Optional[int]]:
    """Return the index of the position of each robot, None if none is left.

    :param poses: poses of the robots, None if unknown: such a robot takes any position
    :param places: (x, y) [m]
    """
    ways = np.array([[0.0 if pose is None else math.hypot(x - pose.x_m, y - pose.y_m)
                      for x, y in places] for pose in poses]).reshape(len(poses), len(places))
    costs = ways + _EVEN_PER_M2 * ways ** 2
    if len(poses) <= len(places):
        return list(assigned(costs))
    found: List[Optional[int]] = [None] * len(poses)
    for place, robot in enumerate(assigned(costs.T)):
        found[robot] = place
    return found
