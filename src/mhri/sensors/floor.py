# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws on the floor of a robot's picture: the lines of its committed path, as a pinhole sees them.

The floor is the plane z = 0 of the robot's frame (x ahead, y left, z up: REP-103); lens distortion
is ignored.
"""
from dataclasses import dataclass
from typing import List, Sequence, Tuple

import numpy as np

from mhri.base.geometry import beside, Pose
from mhri.sensors.point_cloud import Lens

# Lines in the picture: points (n, 2) as shares of its width and height from the upper left corner.
Lines = Tuple[np.ndarray, ...]

# The way straight on from the end of the path [m], and the spacing of points on it.
AHEAD_M, _SPACING_M = 3.0, 0.05
# Nearer points are not drawn [m along the optical axis].
_NEAR_M = 0.1
# Points farther outside the picture than this share of its size are left out: painters are bounded.
_BESIDE = 3.0


@dataclass(frozen=True, eq=False)
class FloorCamera:
    """A camera above the floor.

    ``matrix`` (4, 4) is the pose of its optical frame (z ahead, x right, y down: REP-103) in the
    robot's frame.
    """

    matrix: np.ndarray
    lens: Lens

    @property
    def usable(self) -> bool:
        """Whether lens and pose are possible, and it is above the floor."""
        lens = self.lens
        return bool(np.isfinite(self.matrix).all() and np.isfinite(np.array(lens, float)).all()
                    and min(lens.fx, lens.fy, lens.width, lens.height) > 0
                    and self.matrix[2, 3] > 0.0)

    def project(self, points: np.ndarray) -> np.ndarray:
        """Return floor points (n, 2) [m] in the picture, as shares of its size; NaN: not visible.

        A point outside the picture has shares below 0 or above 1.
        """
        lens = self.lens
        upright = np.column_stack((points, np.zeros(len(points)), np.ones(len(points))))
        seen = upright @ np.linalg.inv(self.matrix).T
        depth = np.where(seen[:, 2] >= _NEAR_M, seen[:, 2], np.nan)
        found: np.ndarray = np.column_stack((
            (lens.fx * seen[:, 0] / depth + lens.cx + 0.5) / lens.width,
            (lens.fy * seen[:, 1] / depth + lens.cy + 0.5) / lens.height))
        found[(np.abs(found) > _BESIDE).any(axis=1)] = np.nan
        return found


@dataclass(frozen=True, eq=False)
class FloorPath:
    """The lines of a committed path in the picture.

    ``committed`` are both edges of the strip that the robot will cover, ``bar`` is its front at the
    end, ``onward`` the edges of the strip straight on from there. Parts outside are left out.
    """

    committed: Lines = ()
    bar: Lines = ()
    onward: Lines = ()

    @property
    def visible(self) -> bool:
        """Whether any part of it is in the picture."""
        return any(((0.0 <= line) & (line <= 1.0)).all(axis=1).any()
                   for lines in (self.committed, self.bar, self.onward) for line in lines)


def floor_path(path: Sequence[Pose], radius_m: float, camera: FloorCamera) -> FloorPath:
    """Return the lines of a path in the picture of a camera.

    :param path: see :meth:`mhri.sensors.committed.SentCommands.path`
    :param radius_m: half the width of the robot [m]
    """
    # Backwards, the picture does not show where the robot is going.
    if not path or not camera.usable or path[-1].x_m < 0.0:
        return FloorPath()
    end, sides = path[-1], (radius_m, -radius_m)
    ways = np.arange(radius_m, AHEAD_M + radius_m, _SPACING_M)
    return FloorPath(
        _shown(camera, [[beside(pose, 0.0, side) for pose in path] +
                        [beside(end, radius_m, side)] for side in sides]),
        _shown(camera, [[beside(end, radius_m, side) for side in np.linspace(*sides, 9)]]),
        _shown(camera, [[beside(end, way, side) for way in ways] for side in sides]))


def _shown(camera: FloorCamera, lines: Sequence[Sequence[Tuple[float, float]]]) -> Lines:
    """Return the visible pieces of lines on the floor."""
    found: List[np.ndarray] = []
    for line in lines:
        points = camera.project(np.array(line, float))
        hidden = np.flatnonzero(~np.isfinite(points).all(axis=1))
        for piece in np.split(points, hidden):
            piece = piece[np.isfinite(piece).all(axis=1)]
            if len(piece) > 1:
                found.append(piece)
    return tuple(found)


def level_camera(x_m: float, z_m: float, lens: Lens) -> FloorCamera:
    """Return a camera that looks ahead from a point above the middle of the robot [m]."""
    matrix = np.array([[0.0, 0.0, 1.0, x_m], [-1.0, 0.0, 0.0, 0.0],
                       [0.0, -1.0, 0.0, z_m], [0.0, 0.0, 0.0, 1.0]])
    return FloorCamera(matrix, lens)
