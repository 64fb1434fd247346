# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Spreads several robots sent to one position side by side."""
import math
from typing import Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np

from mhri.base.geometry import beside, Pose, within
from mhri.map.assignment import shared_out
from mhri.map.grid import Grid, TAKEN_FROM

# Spacing of centres, in radii of the largest robot.
SPACING_RADII = 2.5
# Maximum number of robots in a row.
_IN_A_ROW = 4


def has_room(grid: Grid, x_m: float, y_m: float, radius_m: float) -> bool:
    """Return whether a disc [m] is free on a map of cells."""
    column, row = (side_m / grid.resolution_m - 0.5
                   for side_m in within(grid.origin, Pose(x_m, y_m, 0.0)))
    reach = radius_m / grid.resolution_m
    rows, columns = (slice(max(0, math.ceil(middle - reach)),
                           max(0, math.floor(middle + reach) + 1)) for middle in (row, column))
    down, across = np.nonzero(grid.cells[rows, columns] >= TAKEN_FROM)
    return not np.any(np.hypot(down + rows.start - row, across + columns.start - column) <= reach)


def _places(goal: Pose, count: int, spacing_m: float,
            free: Callable[[float, float], bool]) -> List[Tuple[float, float]]:
    """Return free positions beside and behind a goal, the centre of the first row."""
    found: List[Tuple[float, float]] = []
    in_row = min(count, _IN_A_ROW)
    for row in range(2 * count + 2):
        for number in range(in_row):
            place = beside(goal, -row * spacing_m, (number - (in_row - 1) / 2.0) * spacing_m)
            if len(found) < count and free(*place):
                found.append(place)
    return found


def spread(goal: Pose, robots: Mapping[str, Optional[Pose]], radius_m: float,
           free: Callable[[float, float], bool] = lambda x_m, y_m: True) -> Dict[str, Pose]:
    """Return the goal of each robot, with the heading of the common goal; paths do not cross.

    :param robots: their poses, None if unknown
    :param radius_m: of the largest of them
    :param free: returns whether a robot can stand at (x, y) [m]
    :returns: robots without a free position are left out
    """
    names = list(robots)
    if len(names) == 1:
        return {names[0]: goal}
    places = _places(goal, len(names), SPACING_RADII * radius_m, free)
    numbers = shared_out(list(robots.values()), places)
    return {name: Pose(*places[number], goal.heading_rad)
            for name, number in zip(names, numbers) if number is not None}
