# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The edge of the free floor of a map, which no task crosses, visible to a laser or not."""
import math
from typing import Dict, Tuple

import numpy as np

from mhri.base.geometry import into, Pose, within
from mhri.map.grid import Grid, TAKEN_FROM, UNKNOWN

# Maximum spacing of the points of an edge [m]: no robot fits between them.
_APART_M = 0.1
# Size of the squares for which edges are computed [m], and number of them to keep.
_SQUARE_M, _MAX_SQUARES = 0.5, 300


class Floor:
    """The free cells of a map; everything beyond its sides counts as free."""

    def __init__(self, grid: Grid) -> None:
        self._size_m = grid.resolution_m
        self._origin = grid.origin
        # Padded with free cells, since the sides of the map are not edges.
        self._free = np.pad((grid.cells < TAKEN_FROM) & (grid.cells != UNKNOWN), 1,
                            constant_values=True)
        parts = math.ceil(self._size_m / _APART_M)
        self._known: Dict[Tuple[int, int, float], np.ndarray] = {}
        self._along = (np.arange(parts) + 0.5) / parts

    def edge(self, pose: Pose, within_m: float) -> np.ndarray:
        """Return the edge around a robot: an array (n, 2) in the robot's frame [m].

        It is empty if the robot is not on a free cell: the robot or the map is misplaced, and it
        has to be able to leave.

        :param pose: in the frame of the map
        :param within_m: maximum distance ahead or aside [m]
        """
        # Its position in cells, including the rim.
        x, y = (side_m / self._size_m + 1.0 for side_m in within(self._origin, pose))
        height, width = self._free.shape
        if not (0 <= y < height and 0 <= x < width and self._free[int(y), int(x)]):
            return np.zeros((0, 2))
        seen = self._size_m * into(Pose(x, y, pose.heading_rad - self._origin.heading_rad),
                                   self._around(x, y, within_m))
        return seen[(np.abs(seen) < within_m).all(axis=1)]

    def _around(self, x: float, y: float, within_m: float) -> np.ndarray:
        """Return all edges around the square of a position in cells, (n, 2) in cells."""
        square = max(1, round(_SQUARE_M / self._size_m))
        key = int(x) // square, int(y) // square, within_m
        if key not in self._known:
            while len(self._known) >= _MAX_SQUARES:
                del self._known[next(iter(self._known))]
            reach = math.ceil(1.5 * within_m / self._size_m)
            first, last = (tuple(max(0, (part + more) * square + side) for part in key[:2])
                           for more, side in ((0, -reach), (1, reach)))
            self._known[key] = self._sides(self._free[first[1]:last[1], first[0]:last[0]]) + first
        return self._known[key]

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
