# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Aligns what a robot's laser sees with a map, or with what another robot sees.

Every pose around the rough one is tried against a field of distances, coarsely (Olson, "Real-time
correlative scan matching", 2009); the best are then refined by least squares. Where two poses apart
fit alike, as in a corridor, none is taken.
"""
from dataclasses import dataclass
import math
from typing import List, Optional, Tuple

import numpy as np

from mhri.base.mocap import Pose
from mhri.map.grid import Grid

# How far off the rough pose may be, and a little more [m, rad].
AROUND_M, AROUND_RAD = 0.6, math.radians(26.0)
_STEP_M, _STEP_RAD = 0.1, math.radians(2.0)
# Cells of the field of distances [m]; points further from the robot are left out.
_CELL_M, FAR_M = 0.025, 8.0
# How far off a point still counts, in the search and in the end [m].
_LOOSE_M, _TIGHT_M = 0.12, 0.04
# A point this near to something counts as met [m]; so many have to be.
_MET_M, LEAST_MET = 0.1, 0.6
# Of what another robot sees it sees less.
LEAST_SHARED = 0.45
# Points of another robot that are further apart stand alone [m].
_GAP_M = 0.15
LEAST_POINTS = 30
# Poses this far apart are two; if the other is this nearly as good, nobody knows which it is.
_APART_M, _APART_RAD = 0.2, math.radians(8.0)
ALIKE = 0.93
# So far aside [m] it has to fit worse by this share.
_ASIDE_M, LEAST_HELD = 0.12, 0.05
_CANDIDATES, _ROUNDS = 12, 25
NO_POINTS = 'its laser sees too little'


class FitError(ValueError):
    """It does not fit; the message says why."""


@dataclass(frozen=True)
class Fit:
    """Where a robot is: its pose, the share of points that meet something, how far off they are.

    ``residual_m`` is the mean over the points that meet something [m].
    """

    pose: Pose
    met: float
    residual_m: float

    @property
    def text(self) -> str:
        """How well it fits, in words."""
        return '{:.0f} % of what its laser sees fits, {:.0f} mm off on average'.format(
            100.0 * self.met, 1000.0 * self.residual_m)


def turned(points: np.ndarray, pose: Pose) -> np.ndarray:
    """Return points (n, 2), given in the frame of a pose, in the frame that the pose is in."""
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    found: np.ndarray = points @ np.array(((cos, sin), (-sin, cos))) + (pose.x_m, pose.y_m)
    return found


def fit(points: np.ndarray, rough: Pose, grid: Optional[Grid] = None,
        around: Optional[Tuple[np.ndarray, Pose]] = None) -> Fit:
    """Return the :class:`Fit` of what a robot sees.

    :param points: (n, 2) in the robot's frame [m]
    :param rough: its pose, within half a metre and 20 degrees
    :param grid: the map; None: ``around`` counts
    :param around: what another robot sees, (n, 2) in its frame, and its pose
    :raises FitError: it does not fit, or nobody can tell where
    """
    seen = _thinned(points)
    if len(seen) < LEAST_POINTS:
        raise FitError(NO_POINTS)
    targets = _shape(*around) if around is not None else np.zeros((0, 2)) if grid is None \
        else grid.taken()
    field = _Field(targets, rough)
    fits = [field.refined(seen, start) for start in field.candidates(seen)]
    best, score = max(fits, key=lambda pair: pair[1])
    met, residual_m = field.measure(seen, best)
    least = LEAST_MET if around is None else LEAST_SHARED
    if not _near(best, rough, 1.5 * AROUND_M, 1.5 * AROUND_RAD) or met < least:
        raise FitError('{:.0f} % of what its laser sees meets anything: place it nearer to where '
                       'it is'.format(100.0 * met))
    if field.held(seen, best) < LEAST_HELD or any(
            other > ALIKE * score and not _near(pose, best, _APART_M, _APART_RAD)
            for pose, other in fits):
        raise FitError('it looks alike at several places: drive it to where more can be seen than '
                       'plain walls')
    return Fit(best, met, residual_m)


def _near(one: Pose, other: Pose, most_m: float, most_rad: float) -> bool:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m) < most_m and abs(
        math.remainder(one.heading_rad - other.heading_rad, 2.0 * math.pi)) < most_rad


def _thinned(points: np.ndarray) -> np.ndarray:
    """Return one of the points in each cell of two of the field's, none from far away."""
    near = points[np.isfinite(points).all(axis=1)]
    near = near[np.hypot(near[:, 0], near[:, 1]) < FAR_M]
    if not len(near):
        return near  # numpy 1.17 finds nothing unique in nothing
    cells = np.unique(np.floor(near / (2.0 * _CELL_M)), axis=0, return_index=True)[1]
    found: np.ndarray = near[cells]
    return found


def _shape(points: np.ndarray, pose: Pose) -> np.ndarray:
    """Return what another robot sees in the frame of its pose, without what stands alone.

    Beams that graze a wall meet it far apart: such points are none of its features.
    """
    seen = turned(_thinned(points), pose)
    gaps = np.hypot(*(seen[:, None] - seen).T)
    np.fill_diagonal(gaps, np.inf)
    found: np.ndarray = seen[(gaps < _GAP_M).any(axis=1)] if len(seen) else seen
    return found


class _Field:
    """How far it is to the next thing, around a rough pose."""

    def __init__(self, targets: np.ndarray, rough: Pose) -> None:
        self._rough = rough
        self._reach_m = FAR_M + AROUND_M + 0.5
        size = int(2.0 * self._reach_m / _CELL_M)
        cells = np.floor((targets - (rough.x_m, rough.y_m) + self._reach_m) / _CELL_M)
        cells = cells[((cells >= 0) & (cells < size)).all(axis=1)].astype(int)
        if not len(cells):
            raise FitError('there is nothing on the map around it')
        from mhri.base.opencv import cv2  # a start does not wait for it
        empty = np.ones((size, size), dtype=np.uint8)
        empty[cells[:, 1], cells[:, 0]] = 0
        self._far_m = cv2.distanceTransform(empty, cv2.DIST_L2, 5) * _CELL_M
        self._slope_y, self._slope_x = np.gradient(self._far_m, _CELL_M)
        self._loose = np.exp(-0.5 * (self._far_m / _LOOSE_M) ** 2)

    def _cells(self, places: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Return the (rows, columns) of places (n, 2) in the map's frame, kept to the field."""
        cells = (places - (self._rough.x_m, self._rough.y_m) + self._reach_m) / _CELL_M
        cells = np.clip(cells.astype(int), 0, len(self._far_m) - 1)
        return cells[:, 1], cells[:, 0]

    def candidates(self, seen: np.ndarray) -> List[Pose]:
        """Return the best poses around the rough one, no two of them side by side."""
        rough, count = self._rough, round(AROUND_M / _STEP_M)
        shifts, cells = np.arange(-count, count + 1), round(_STEP_M / _CELL_M)
        turns = np.arange(-AROUND_RAD, AROUND_RAD + 1e-9, _STEP_RAD)
        scores = np.zeros((len(turns), len(shifts), len(shifts)))
        for number, turn in enumerate(turns):
            rows, columns = self._cells(turned(seen, Pose(
                rough.x_m, rough.y_m, rough.heading_rad + turn)))
            for down, shift in enumerate(shifts * cells):
                scores[number, down] = self._loose[
                    rows[:, None] + shift, columns[:, None] + shifts * cells].mean(axis=0)
        found: List[Pose] = []
        for index in np.argsort(scores, axis=None)[::-1]:
            turn, down, right = np.unravel_index(index, scores.shape)
            pose = Pose(rough.x_m + shifts[right] * _STEP_M, rough.y_m + shifts[down] * _STEP_M,
                        rough.heading_rad + float(turns[turn]))
            if not any(_near(pose, other, _APART_M, _APART_RAD) for other in found):
                found.append(pose)
                if len(found) == _CANDIDATES:
                    break
        return found

    def refined(self, seen: np.ndarray, pose: Pose) -> Tuple[Pose, float]:
        """Return (a pose after least squares, its score in [0, 1])."""
        for number in range(_ROUNDS):
            near_m = max(_TIGHT_M, _LOOSE_M * 0.85 ** number)
            cells = self._cells(turned(seen, pose))
            far, x, y = self._far_m[cells], self._slope_x[cells], self._slope_y[cells]
            weights = np.exp(-0.5 * (far / near_m) ** 2)
            arms = turned(seen, Pose(0.0, 0.0, pose.heading_rad))
            rows = np.column_stack((x, y, y * arms[:, 0] - x * arms[:, 1]))
            normal = rows.T @ (weights[:, None] * rows) + 1e-3 * np.eye(3)
            step = np.linalg.solve(normal, -rows.T @ (weights * far))
            step *= min(1.0, 0.1 / max(1e-9, float(np.abs(step).max())))
            pose = Pose(pose.x_m + step[0], pose.y_m + step[1], pose.heading_rad + step[2])
            if np.abs(step).max() < 1e-4 and near_m == _TIGHT_M:
                break
        pose = Pose(float(pose.x_m), float(pose.y_m),
                    math.remainder(float(pose.heading_rad), 2.0 * math.pi))
        return pose, self._score(seen, pose)

    def held(self, seen: np.ndarray, pose: Pose) -> float:
        """Return what of the score is lost at least, a little aside to any hand, in [0, 1]."""
        here = max(1e-9, self._score(seen, pose))
        return min(1.0 - self._score(seen, Pose(
            pose.x_m + _ASIDE_M * math.cos(turn), pose.y_m + _ASIDE_M * math.sin(turn),
            pose.heading_rad)) / here for turn in np.arange(16) * math.pi / 8.0)

    def _score(self, seen: np.ndarray, pose: Pose) -> float:
        far = self._far_m[self._cells(turned(seen, pose))]
        return float(np.exp(-0.5 * (far / _TIGHT_M) ** 2).mean())

    def measure(self, seen: np.ndarray, pose: Pose) -> Tuple[float, float]:
        """Return (the share of points that meet something, how far off those are [m])."""
        far = self._far_m[self._cells(turned(seen, pose))]
        met = far < _MET_M
        return float(met.mean()), float(far[met].mean()) if met.any() else math.inf
