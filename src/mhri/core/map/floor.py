# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the free floor of a map ends: what no task drives over, whether a laser sees it or not."""
import math

import numpy as np

from mhri.core.map.grid import Grid, TAKEN_FROM, UNKNOWN
from mhri.core.robots.mocap import Pose

# No two points of an edge are further apart than this [m]: no robot fits between them.
_APART_M = 0.1


class Floor:
    """The free cells of a map; what the map says nothing of, beyond its sides, counts as free."""

    def __init__(self, grid: Grid) -> None:
        self._size_m = grid.resolution_m
        self._origin = grid.origin
        # With a rim of free cells, since what is beyond has no edge.
        self._free = np.pad((grid.cells < TAKEN_FROM) & (grid.cells != UNKNOWN), 1,
                            constant_values=True)
        parts = math.ceil(self._size_m / _APART_M)
        self._along = (np.arange(parts) + 0.5) / parts

    def edge(self, pose: Pose, within_m: float) -> np.ndarray:
        """Return where it ends around a robot: an array (n, 2) in the robot's frame [m].

        Nothing where the robot itself stands on no free cell: either is misplaced, and it has to
        get away from there.

        :param pose: in the frame of the map
        :param within_m: no further off than this, roughly [m]
        """
        cos, sin = math.cos(self._origin.heading_rad), math.sin(self._origin.heading_rad)
        gap_x, gap_y = pose.x_m - self._origin.x_m, pose.y_m - self._origin.y_m
        # Where it is in cells, those of the rim counted.
        x = (cos * gap_x + sin * gap_y) / self._size_m + 1.0
        y = (cos * gap_y - sin * gap_x) / self._size_m + 1.0
        reach = within_m / self._size_m + 1.0
        rows, columns = (slice(max(0, int(at - reach)), max(0, int(at + reach) + 1))
                         for at in (y, x))
        free = self._free[rows, columns]
        row, column = math.floor(y) - rows.start, math.floor(x) - columns.start
        if not (0 <= row < free.shape[0] and 0 <= column < free.shape[1] and free[row, column]):
            return np.zeros((0, 2))
        return self._seen(self._sides(free) + (columns.start, rows.start), x, y,
                          pose.heading_rad - self._origin.heading_rad)

    def _sides(self, free: np.ndarray) -> np.ndarray:
        """Return points on the sides between free and other cells, (n, 2): x, y in cells."""
        row, column = np.nonzero(free[:, 1:] != free[:, :-1])
        upright = np.column_stack((
            np.repeat(column + 1.0, len(self._along)),
            (row[:, None] + self._along).ravel()))
        row, column = np.nonzero(free[1:] != free[:-1])
        level = np.column_stack((
            (column[:, None] + self._along).ravel(),
            np.repeat(row + 1.0, len(self._along))))
        return np.vstack((upright, level))

    def _seen(self, points: np.ndarray, x: float, y: float, heading_rad: float) -> np.ndarray:
        """Return points in cells as a robot that is at x, y sees them [m]."""
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
        seen: np.ndarray = self._size_m * (points - (x, y)) @ np.array(((cos, -sin), (sin, cos)))
        return seen
