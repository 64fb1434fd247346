# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the free floor of a map ends: what no task drives over, whether a laser sees it or not."""
import math
from typing import Dict, Tuple

import numpy as np

from mhri.base.mocap import Pose
from mhri.map.grid import Grid, TAKEN_FROM, UNKNOWN

# No two points of an edge are further apart than this [m]: no robot fits between them.
_APART_M = 0.1
# Edges are worked out for squares of this size, and so many are kept [m].
_SQUARE_M, _MOST_SQUARES = 0.5, 300


class Floor:
    """The free cells of a map; what the map says nothing of, beyond its sides, counts as free."""

    def __init__(self, grid: Grid) -> None:
        self._size_m = grid.resolution_m
        self._origin = grid.origin
        # With a rim of free cells, since what is beyond has no edge.
        self._free = np.pad((grid.cells < TAKEN_FROM) & (grid.cells != UNKNOWN), 1,
                            constant_values=True)
        parts = math.ceil(self._size_m / _APART_M)
        self._known: Dict[Tuple[int, int, float], np.ndarray] = {}
        self._along = (np.arange(parts) + 0.5) / parts

    def edge(self, pose: Pose, within_m: float) -> np.ndarray:
        """Return where it ends around a robot: an array (n, 2) in the robot's frame [m].

        Nothing where the robot itself stands on no free cell: either is misplaced, and it has to
        get away from there.

        :param pose: in the frame of the map
        :param within_m: no further ahead or aside than this [m]
        """
        cos, sin = math.cos(self._origin.heading_rad), math.sin(self._origin.heading_rad)
        gap_x, gap_y = pose.x_m - self._origin.x_m, pose.y_m - self._origin.y_m
        # Where it is in cells, those of the rim counted.
        x = (cos * gap_x + sin * gap_y) / self._size_m + 1.0
        y = (cos * gap_y - sin * gap_x) / self._size_m + 1.0
        height, width = self._free.shape
        if not (0 <= y < height and 0 <= x < width and self._free[int(y), int(x)]):
            return np.zeros((0, 2))
        seen = self._seen(self._around(x, y, within_m), x, y,
                          pose.heading_rad - self._origin.heading_rad)
        return seen[(np.abs(seen) < within_m).all(axis=1)]

    def _around(self, x: float, y: float, within_m: float) -> np.ndarray:
        """Return all edges around the square that a place in cells lies in, (n, 2) in cells."""
        square = max(1, round(_SQUARE_M / self._size_m))
        key = int(x) // square, int(y) // square, within_m
        if key not in self._known:
            while len(self._known) >= _MOST_SQUARES:
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

    def _seen(self, points: np.ndarray, x: float, y: float, heading_rad: float) -> np.ndarray:
        """Return points in cells as a robot that is at x, y sees them [m]."""
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
        seen: np.ndarray = self._size_m * (points - (x, y)) @ np.array(((cos, -sin), (sin, cos)))
        return seen
