# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A depth picture as the obstacle brake takes it: the nearest thing in each direction.

What is as low as the floor, or well above the camera, is in nobody's way. A direction in which
hardly a pixel was measured was not looked at: nothing measured is no free way.
"""
import math
from typing import Tuple

import numpy as np

from mhri.base.mocap import Pose
from mhri.sensors.brake import KEEP_M, Scan
from mhri.sensors.point_cloud import CloudError, Lens, slopes

# From beam to beam at least.
STEP_RAD = math.radians(0.5)
# As low is the floor [m], and so much more for each metre of the way: cameras nod.
FLOOR_M, FLOOR_SHARE = 0.04, 0.02
# Of a camera of unknown height: nothing that lies lower than so much below it counts [m].
BELOW_M = 0.03
# What is so far above the camera is above the robot as well [m].
ABOVE_M = 0.25
# Such cameras measure nothing that is nearer, and nothing well that is further [m].
NEAREST_M, FARTHEST_M = 0.45, 8.0
# Share of the pixels of a direction, and of a picture, without which nothing was measured.
LEAST_OF_COLUMN, LEAST_OF_PICTURE = 0.1, 0.05
# One row of so many is read.
ROWS = 2
# Less of its axis in the plane than this: it looks at the floor or the ceiling.
_LEVEL = 0.7


class DepthBeams:
    """Turns the depth pictures of one camera into scans; keeps what depends on lens and place.

    One thread at a time.
    """

    def __init__(self) -> None:
        self._made_for: object = None

    def scan(self, depth_m: np.ndarray, lens: Lens, mount: np.ndarray,
             height_known: bool = True) -> Scan:
        """Return a picture as a :class:`Scan`.

        :param depth_m: float32 (h, w), along the optical axis [m], NaN for nothing measured
        :param mount: matrix (4, 4) of the camera's optical frame in the robot's, in which z is
            above the floor
        :param height_known: False: that z means nothing
        :raises CloudError: the lens is impossible, the camera looks up or down, or hardly a pixel
            was measured
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
        if measured.mean() < LEAST_OF_PICTURE:
            raise CloudError('a depth picture that measured nothing in {:.0f} % of its '
                             'pixels'.format(100.0 - 100.0 * measured.mean()))
        far[~inside] = np.inf
        rows = far.argmin(axis=0)
        columns = np.arange(far.shape[1])
        ranges = np.full(self._count, np.inf)
        np.minimum.at(ranges, self._beams[rows, columns], far[rows, columns])
        ranges[ranges > FARTHEST_M] = np.nan
        looked = np.isfinite(ranges)
        looked[self._beams[len(depth) // 2][measured >= LEAST_OF_COLUMN]] = True
        return Scan(ranges, self._first, self._step, self._near_m, FARTHEST_M, self._place,
                    np.where(looked, 0.0, np.inf))

    def _make(self, shape: Tuple[int, ...], lens: Lens, mount: np.ndarray,
              height_known: bool) -> None:
        """Make the tables: of each pixel, for each metre of depth, how far up and away it lies."""
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
        # What is low and nearer than the floor is in the picture is not seen any more.
        floor = height_m * self._far[-1] / np.maximum(-self._up[-1], 1e-6)
        self._near_m = float(min(KEEP_M, max(NEAREST_M, floor.max())))
