# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The floor plan as a grid map, as if recorded by a robot."""
import numpy as np

from mhri.base.geometry import Pose
from mhri.map.grid import FREE, Grid, OCCUPIED

RESOLUTION_M = 0.05
# Walls at multiples of 0.1 m are at the centre of a cell.
MARGIN_M = 0.225


def grid_of_plan(plan):
    """Return the :class:`Grid` of a :class:`mhri.sim.plan.Plan`, in the plan's own frame.

    All cells are known; objects to be searched for are omitted.
    """
    corners = plan.walls.reshape(-1, 2)
    left = corners.min(axis=0) - MARGIN_M
    size = np.ceil((corners.max(axis=0) + MARGIN_M - left) / RESOLUTION_M).astype(int)
    cells = np.full((size[1], size[0]), FREE, dtype=np.int8)
    for x1, y1, x2, y2 in plan.walls:
        steps = int(np.hypot(x2 - x1, y2 - y1) / RESOLUTION_M * 4) + 2
        _fill(cells, np.linspace((x1, y1), (x2, y2), steps) - left)
    columns, rows = np.meshgrid(*(left[axis] + (np.arange(size[axis]) + 0.5) * RESOLUTION_M
                                  for axis in (0, 1)))
    for x, y, radius in plan.discs(map_only=True):
        cells[np.hypot(columns - x, rows - y) <= radius] = OCCUPIED
    return Grid(RESOLUTION_M, Pose(float(left[0]), float(left[1]), 0.0), cells)


def _fill(cells, places):
    """Mark the cells at positions (n, 2) from the lower left corner [m]."""
    found = np.floor(places / RESOLUTION_M).astype(int)
    cells[found[:, 1], found[:, 0]] = OCCUPIED
