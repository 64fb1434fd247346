# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts depth pictures to scans for the obstacle brake: the nearest obstacle per direction.

Points as low as the floor, or well above the camera, are ignored. A direction with hardly any
measured pixel counts as unseen, not as free.
"""
import math
from typing import Tuple

import numpy as np

from mhri.base.geometry import Pose
from mhri.sensors.brake import KEEP_M, Scan
from mhri.sensors.point_cloud import CloudError, Lens, slopes

# Minimum angle from beam to beam.
STEP_RAD = math.radians(0.5)
# Points up to this height are the floor [m], plus this much per metre of distance: cameras nod.
FLOOR_M, FLOOR_SHARE = 0.04, 0.02
# For a camera of unknown height, points more than this below it are ignored [m].
BELOW_M = 0.03
# Points this far above the camera are above the robot, too [m].
ABOVE_M = 0.25
# Depth cameras measure nothing nearer than the first, and nothing well beyond the second [m].
MIN_RANGE_M, MAX_RANGE_M = 0.45, 8.0
# Minimum share of measured pixels of a direction, and of a picture, for it to count.
MIN_OF_COLUMN, MIN_OF_PICTURE = 0.1, 0.05
# Only one row in this many is read.
ROWS = 2
# With a smaller horizontal part of its axis the camera looks at the floor or the ceiling.
_LEVEL = 0.7


class DepthBeams:
    """Converts the depth pictures of one camera to scans; caches the tables for lens and mount.

    One thread at a time.
    """

    def __init__(self) -> None:
        self._made_for: object = None

    def scan(self, depth_m: np.ndarray, lens: Lens, mount: np.ndarray,
             height_known: bool = True) -> Scan:
        """Return a picture as a :class:`Scan`.

        :param depth_m: float32 (h, w), along the optical axis [m], NaN if not measured
        :param mount: matrix (4, 4) of the camera's optical frame in the robot's, in which z is
            the height above the floor
        :param height_known: False if that z is meaningless
        :raises CloudError: the lens is impossible, the camera looks up or down, or hardly any
            pixel was measured
        """
        key = depth_m.shape, lens, mount.tobytes(), height_known
        if key != self._made_for:
            self._make(depth_m.shape, lens, mount, height_known)
            self._made_for = key
        depth = depth_m[::ROWS]
        with np.errstate(invalid='ignore'):
            valid = (depth > 0.0) & (depth < np.inf)
            up, far = depth * self._up, depth * self._far
            inside = valid & (up > self._least_m + self._share * far) & (up < ABOVE_M)
        measured = valid.mean(axis=0)
        if measured.mean() < MIN_OF_PICTURE:
            raise CloudError('a depth picture that measured nothing in {:.0f} % of its '
                             'pixels'.format(100.0 - 100.0 * measured.mean()))
        far[~inside] = np.inf
        rows = far.argmin(axis=0)
        columns = np.arange(far.shape[1])
        ranges = np.full(self._count, np.inf)
        np.minimum.at(ranges, self._beams[rows, columns], far[rows, columns])
        ranges[ranges > MAX_RANGE_M] = np.nan
        looked = np.isfinite(ranges)
        looked[self._beams[len(depth) // 2][measured >= MIN_OF_COLUMN]] = True
        return Scan(ranges, self._first, self._step, self._near_m, MAX_RANGE_M, self._place,
                    np.where(looked, 0.0, np.inf))

    def _make(self, shape: Tuple[int, ...], lens: Lens, mount: np.ndarray,
              height_known: bool) -> None:
        """Make the tables: height and horizontal distance of each pixel per metre of depth."""
        height, width = shape
        right, down = slopes(lens, width, height)
        right, down = right[None, :], down[::ROWS, None]
        turn, height_m = mount[:3, :3], float(mount[2, 3]) if height_known else 0.0
        if math.hypot(turn[0, 2], turn[1, 2]) < _LEVEL:
            raise CloudError('a depth camera that looks up or down')
        heading = math.atan2(turn[1, 2], turn[0, 2])
        ahead, left, up = (row[0] * right + row[1] * down + row[2] for row in turn)
        self._up, self._far = up.astype(np.float32), np.hypot(ahead, left).astype(np.float32)
        bearing = np.mod(np.arctan2(left, ahead) - heading + math.pi, 2.0 * math.pi) - math.pi
        self._first = float(bearing.min())
        span = float(bearing.max()) - self._first
        self._step = max(STEP_RAD, 1.5 * span / width)
        self._beams = np.rint((bearing - self._first) / self._step).astype(int)
        self._count = int(self._beams.max()) + 1
        self._place = Pose(float(mount[0, 3]), float(mount[1, 3]), heading)
        self._least_m, self._share = (FLOOR_M - height_m, FLOOR_SHARE) \
            if height_known else (-BELOW_M, 0.0)
        # Low obstacles nearer than the nearest visible floor are out of view.
        floor = height_m * self._far[-1] / np.maximum(-self._up[-1], 1e-6)
        self._near_m = float(min(KEEP_M, max(MIN_RANGE_M, floor.max())))
