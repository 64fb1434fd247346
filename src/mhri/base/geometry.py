# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Positions, headings and frames in the plane: x ahead, y to the left (REP-103)."""
from dataclasses import dataclass
import math
from typing import Any, Tuple

import numpy as np


@dataclass(frozen=True)
class Pose:
    """A position in the plane [m] and a heading [rad]."""

    x_m: float
    y_m: float
    heading_rad: float

    def is_finite(self) -> bool:
        """Return whether every number is finite."""
        return all(map(math.isfinite, (self.x_m, self.y_m, self.heading_rad)))


def composed(frame: Pose, pose: Pose) -> Pose:
    """Return a pose of a frame in the coordinates of its parent."""
    return Pose(*beside(frame, pose.x_m, pose.y_m),
                math.remainder(frame.heading_rad + pose.heading_rad, 2.0 * math.pi))


def inverse(pose: Pose) -> Pose:
    """Return the inverse of a pose: its parent frame, seen from the pose."""
    return Pose(*within(pose, Pose(0.0, 0.0, 0.0)), -pose.heading_rad)


def beside(pose: Pose, ahead_m: float, left_m: float) -> Tuple[float, float]:
    """Return the point (x, y) [m] ahead and to the left of a pose."""
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return pose.x_m + cos * ahead_m - sin * left_m, pose.y_m + sin * ahead_m + cos * left_m


def within(pose: Pose, other: Pose) -> Tuple[float, float]:
    """Return the position of another pose in the frame of a pose: (ahead, to the left) [m]."""
    gap_x, gap_y = other.x_m - pose.x_m, other.y_m - pose.y_m
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return cos * gap_x + sin * gap_y, cos * gap_y - sin * gap_x


def out_of(frame: Pose, points: np.ndarray) -> np.ndarray:
    """Return points (n, 2) of a frame in the coordinates of its parent."""
    found: np.ndarray = points @ _turned(frame.heading_rad).T + (frame.x_m, frame.y_m)
    return found


def into(frame: Pose, points: np.ndarray) -> np.ndarray:
    """Return points (n, 2) of the parent in the coordinates of a frame."""
    found: np.ndarray = (points - (frame.x_m, frame.y_m)) @ _turned(frame.heading_rad)
    return found


def is_rotation(x: Any, y: Any, z: Any, w: Any) -> Any:
    """Return whether numbers, or each row of four arrays, are the quaternion of a rotation.

    Drivers that do not measure an orientation send zeros, or an angle in place of a component. The
    length may differ from 1 by a tenth, as in numbers typed by hand, but that of a lone component
    only by rounding.
    """
    squares = (x * x, y * y, z * z, w * w)
    total = sum(squares)
    lone = False
    for square in squares:
        lone = lone | (square == total)
    return abs(total - 1.0) < 0.2 - 0.198 * lone


def heading_of(x: float, y: float, z: float, w: float) -> float:
    """Return the heading [rad, [-pi, pi]] of a quaternion, NaN unless it :func:`is_rotation`."""
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z) \
        if is_rotation(x, y, z, w) else math.nan


def rotation_words(x: float, y: float, z: float, w: float) -> str:
    """Return a quaternion in words."""
    return 'orientation of ({:.3g}, {:.3g}, {:.3g}, {:.3g})'.format(x, y, z, w)


def _turned(angle_rad: float) -> np.ndarray:
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return np.array(((cos, -sin), (sin, cos)))
