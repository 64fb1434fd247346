# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Several robots sent to one place: side by side there, not all on one point."""
import math
from typing import Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np

from mhri.base.mocap import Pose
from mhri.map.assignment import shared_out
from mhri.map.grid import Grid, TAKEN_FROM

# From middle to middle, in radii of the largest.
SPACING_RADII = 2.5
# More than so many stand in several rows.
_IN_A_ROW = 4


def has_room(grid: Grid, x_m: float, y_m: float, radius_m: float) -> bool:
    """Tell whether nothing is known to stand in a disc [m] on a map of cells."""
    cos, sin = math.cos(grid.origin.heading_rad), math.sin(grid.origin.heading_rad)
    ahead, left = x_m - grid.origin.x_m, y_m - grid.origin.y_m
    column = (ahead * cos + left * sin) / grid.resolution_m - 0.5
    row = (left * cos - ahead * sin) / grid.resolution_m - 0.5
    reach = radius_m / grid.resolution_m
    rows, columns = (slice(max(0, math.ceil(middle - reach)),
                           max(0, math.floor(middle + reach) + 1)) for middle in (row, column))
    down, across = np.nonzero(grid.cells[rows, columns] >= TAKEN_FROM)
    return not np.any(np.hypot(down + rows.start - row, across + columns.start - column) <= reach)


def _places(goal: Pose, count: int, spacing_m: float,
            free: Callable[[float, float], bool]) -> List[Tuple[float, float]]:
    """Return so many free places beside and behind a goal; it is the middle of the first row."""
    across = (-math.sin(goal.heading_rad), math.cos(goal.heading_rad))
    back = (-math.cos(goal.heading_rad), -math.sin(goal.heading_rad))
    found: List[Tuple[float, float]] = []
    in_row = min(count, _IN_A_ROW)
    for row in range(2 * count + 2):
        for number in range(in_row):
            aside, behind = (number - (in_row - 1) / 2.0) * spacing_m, row * spacing_m
            place = (goal.x_m + aside * across[0] + behind * back[0],
                     goal.y_m + aside * across[1] + behind * back[1])
            if len(found) < count and free(*place):
                found.append(place)
    return found


def spread(goal: Pose, robots: Mapping[str, Optional[Pose]], radius_m: float,
           free: Callable[[float, float], bool] = lambda x_m, y_m: True) -> Dict[str, Pose]:
    """Return where each robot goes, all with the heading of the goal; ways do not cross.

    :param robots: where they are, None if nobody knows
    :param radius_m: of the largest of them
    :param free: tells whether a robot can stand at (x, y) [m]
    :returns: robots for which there is no free place are left out
    """
    names = list(robots)
    if len(names) == 1:
        return {names[0]: goal}
    places = _places(goal, len(names), SPACING_RADII * radius_m, free)
    numbers = shared_out(list(robots.values()), places)
    return {name: Pose(*places[number], goal.heading_rad)
            for name, number in zip(names, numbers) if number is not None}
