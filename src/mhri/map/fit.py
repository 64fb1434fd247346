# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Matches a robot's laser scan with a map, or with the scan of another robot.

All poses around the rough one are tried against a distance field, coarsely (Olson, "Real-time
correlative scan matching", 2009); the best are refined by least squares. If distant poses fit
equally well, as in a corridor, the match is rejected.
"""
from dataclasses import dataclass
import math
from typing import List, Optional, Tuple

import numpy as np

from mhri.base.geometry import out_of, Pose
from mhri.map.grid import Grid

# Maximum error of the rough pose, with a margin [m, rad].
AROUND_M, AROUND_RAD = 0.6, math.radians(26.0)
_STEP_M, _STEP_RAD = 0.1, math.radians(2.0)
# Cell size of the distance field [m]; points further from the robot are ignored.
_CELL_M, FAR_M = 0.025, 8.0
# Distance at which a point still counts, in the search and in the refinement [m].
_LOOSE_M, _TIGHT_M = 0.12, 0.04
# Distance at which a point counts as matched [m]; required fraction of them.
_MET_M, MIN_MET = 0.1, 0.6
# The same for the scan of another robot, whose view overlaps less.
MIN_SHARED = 0.45
# Points of another robot further apart than this are isolated [m].
_GAP_M = 0.15
MIN_POINTS = 30
# Poses this far apart are distinct; if the second is nearly as good, the match is ambiguous.
_APART_M, _APART_RAD = 0.2, math.radians(8.0)
ALIKE = 0.93
# At this lateral offset [m] the score has to be lower by at least this fraction.
_ASIDE_M, MIN_HELD = 0.12, 0.05
_CANDIDATES, _ROUNDS = 12, 25
NO_POINTS = 'its laser sees too little'


class FitError(ValueError):
    """A failed match; the message names the reason."""


@dataclass(frozen=True)
class Fit:
    """A match: the pose, the fraction of matched points, and their mean distance.

    ``residual_m`` is the mean over the matched points [m].
    """

    pose: Pose
    met: float
    residual_m: float

    @property
    def text(self) -> str:
        """The quality as text."""
        return '{:.0f} % of its laser points match, {:.0f} mm off on average'.format(
            100.0 * self.met, 1000.0 * self.residual_m)


def fit(points: np.ndarray, rough: Pose, grid: Optional[Grid] = None,
        around: Optional[Tuple[np.ndarray, Pose]] = None) -> Fit:
    """Return the :class:`Fit` of a scan.

    :param points: (n, 2) in the robot's frame [m]
    :param rough: its pose, within half a metre and 20 degrees
    :param grid: the map; None: match with ``around``
    :param around: the scan of another robot, (n, 2) in its frame, and its pose
    :raises FitError: it does not match, or is ambiguous
    """
    seen = _thinned(points)
    if len(seen) < MIN_POINTS:
        raise FitError(NO_POINTS)
    targets = _shape(*around) if around is not None else np.zeros((0, 2)) if grid is None \
        else grid.taken()
    field = _Field(targets, rough)
    fits = [field.refined(seen, start) for start in field.candidates(seen)]
    best, score = max(fits, key=lambda pair: pair[1])
    met, residual_m = field.measure(seen, best)
    least = MIN_MET if around is None else MIN_SHARED
    if not _near(best, rough, 1.5 * AROUND_M, 1.5 * AROUND_RAD) or met < least:
        raise FitError('only {:.0f} % of its scan fits the map: place it nearer to where it really '
                       'is'.format(100.0 * met))
    if field.held(seen, best) < MIN_HELD or any(
            other > ALIKE * score and not _near(pose, best, _APART_M, _APART_RAD)
            for pose, other in fits):
        raise FitError('several places fit equally well: drive it to where it sees more than '
                       'plain walls')
    return Fit(best, met, residual_m)


def _near(one: Pose, other: Pose, most_m: float, most_rad: float) -> bool:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m) < most_m and abs(
        math.remainder(one.heading_rad - other.heading_rad, 2.0 * math.pi)) < most_rad


def _thinned(points: np.ndarray) -> np.ndarray:
    """Return one point per square of two by two cells, without distant ones."""
    near = points[np.isfinite(points).all(axis=1)]
    near = near[np.hypot(near[:, 0], near[:, 1]) < FAR_M]
    if not len(near):
        return near  # numpy 1.17 fails on empty arrays
    cells = np.unique(np.floor(near / (2.0 * _CELL_M)), axis=0, return_index=True)[1]
    found: np.ndarray = near[cells]
    return found


def _shape(points: np.ndarray, pose: Pose) -> np.ndarray:
    """Return the scan of another robot in the frame of its pose, without isolated points.

    Beams that graze a wall hit it far apart: such points are not features.
    """
    seen = out_of(pose, _thinned(points))
    gaps = np.hypot(*(seen[:, None] - seen).T)
    np.fill_diagonal(gaps, np.inf)
    found: np.ndarray = seen[(gaps < _GAP_M).any(axis=1)] if len(seen) else seen
    return found


class _Field:
    """The distance field around a rough pose."""

    def __init__(self, targets: np.ndarray, rough: Pose) -> None:
        self._rough = rough
        self._reach_m = FAR_M + AROUND_M + 0.5
        size = int(2.0 * self._reach_m / _CELL_M)
        cells = np.floor((targets - (rough.x_m, rough.y_m) + self._reach_m) / _CELL_M)
        cells = cells[((cells >= 0) & (cells < size)).all(axis=1)].astype(int)
        if not len(cells):
            raise FitError('there is nothing on the map around it')
        from mhri.base.opencv import cv2  # loaded late, for a fast start
        empty = np.ones((size, size), dtype=np.uint8)
        empty[cells[:, 1], cells[:, 0]] = 0
        self._far_m = cv2.distanceTransform(empty, cv2.DIST_L2, 5) * _CELL_M
        self._slope_y, self._slope_x = np.gradient(self._far_m, _CELL_M)
        self._loose = np.exp(-0.5 * (self._far_m / _LOOSE_M) ** 2)

    def _cells(self, places: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Return the (rows, columns) of positions (n, 2) in the map's frame, clipped."""
        cells = (places - (self._rough.x_m, self._rough.y_m) + self._reach_m) / _CELL_M
        cells = np.clip(cells.astype(int), 0, len(self._far_m) - 1)
        return cells[:, 1], cells[:, 0]

    def candidates(self, seen: np.ndarray) -> List[Pose]:
        """Return the best poses around the rough one, without neighbours."""
        rough, count = self._rough, round(AROUND_M / _STEP_M)
        shifts, cells = np.arange(-count, count + 1), round(_STEP_M / _CELL_M)
        turns = np.arange(-AROUND_RAD, AROUND_RAD + 1e-9, _STEP_RAD)
        scores = np.zeros((len(turns), len(shifts), len(shifts)))
        for number, turn in enumerate(turns):
            rows, columns = self._cells(out_of(Pose(
                rough.x_m, rough.y_m, rough.heading_rad + turn), seen))
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
            cells = self._cells(out_of(pose, seen))
            far, x, y = self._far_m[cells], self._slope_x[cells], self._slope_y[cells]
            weights = np.exp(-0.5 * (far / near_m) ** 2)
            arms = out_of(Pose(0.0, 0.0, pose.heading_rad), seen)
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
        """Return the minimum relative loss of the score at an offset in any direction."""
        here = max(1e-9, self._score(seen, pose))
        return min(1.0 - self._score(seen, Pose(
            pose.x_m + _ASIDE_M * math.cos(turn), pose.y_m + _ASIDE_M * math.sin(turn),
            pose.heading_rad)) / here for turn in np.arange(16) * math.pi / 8.0)

    def _score(self, seen: np.ndarray, pose: Pose) -> float:
        far = self._far_m[self._cells(out_of(pose, seen))]
        return float(np.exp(-0.5 * (far / _TIGHT_M) ** 2).mean())

    def measure(self, seen: np.ndarray, pose: Pose) -> Tuple[float, float]:
        """Return (the fraction of matched points, their mean distance [m])."""
        far = self._far_m[self._cells(out_of(pose, seen))]
        met = far < _MET_M
        return float(met.mean()), float(far[met].mean()) if met.any() else math.inf
