# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The viewpoint of a cloud, on an orbit around a point; x ahead, y left, z up (REP-103)."""
from dataclasses import dataclass, replace
import math
from typing import List, Tuple

import numpy as np

from mhri.camera.images import Size

#: vertical field of view of the picture [rad]
FIELD_OF_VIEW_RAD = math.radians(60.0)
_MIN_DISTANCE_M, _MAX_DISTANCE_M = 0.3, 500.0
_BEYOND_M = 1e4
_MAX_PITCH_RAD = math.radians(89.0)
_TURN_RAD_PER_PX = math.radians(0.4)
_ZOOM = 1.15
# Most of the points, so that one stray point does not shrink the rest to a dot.
_CORE_PERCENT = (4, 96)
_NEAREST_FIT_M = 1.0
_FIT_SIZE = (120, 100)


@dataclass(frozen=True)
class Orbit:
    """The eye, ``distance_m`` away from ``target_m``, which is in the middle of the picture.

    ``yaw_rad`` is its viewing direction, 0 ahead and growing to the left; ``pitch_rad`` its
    downward angle, within 89 degrees. Distances are from 0.3 to 500 m.
    """

    target_m: Tuple[float, float, float] = (1.5, 0.0, 0.0)
    yaw_rad: float = 0.0
    pitch_rad: float = math.radians(30.0)
    distance_m: float = 5.0

    def axes(self) -> np.ndarray:
        """Return the picture's right, down and forward as rows, float64 (3, 3)."""
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        level, drop = math.cos(self.pitch_rad), math.sin(self.pitch_rad)
        return np.array([[sin, -cos, 0.0],
                         [-drop * cos, -drop * sin, -level],
                         [level * cos, level * sin, -drop]])

    def eye_m(self) -> np.ndarray:
        """Return the position of the eye [m]."""
        return np.array(self.target_m) - self.distance_m * self.axes()[2]

    def turned(self, right_px: float, down_px: float) -> 'Orbit':
        """Return the orbit after a drag by this many pixels: the near side follows the mouse."""
        pitch = self.pitch_rad + down_px * _TURN_RAD_PER_PX
        yaw = math.remainder(self.yaw_rad - right_px * _TURN_RAD_PER_PX, 2.0 * math.pi)
        return replace(self, yaw_rad=yaw,
                       pitch_rad=min(_MAX_PITCH_RAD, max(-_MAX_PITCH_RAD, pitch)))

    def moved(self, right_px: float, down_px: float, height_px: float) -> 'Orbit':
        """Return the orbit after a drag of the target, in a picture ``height_px`` high."""
        scale = self.distance_m / focal_px(height_px)
        right, down, _ = self.axes()
        target = np.array(self.target_m) - scale * (right_px * right + down_px * down)
        x, y, z = np.clip(target, -_BEYOND_M, _BEYOND_M).tolist()
        return replace(self, target_m=(x, y, z))

    def zoomed(self, steps: float) -> 'Orbit':
        """Return the orbit zoomed in by this many steps of a mouse wheel (negative: out)."""
        distance = self.distance_m * _ZOOM ** -min(100.0, max(-100.0, steps))
        return replace(self, distance_m=min(_MAX_DISTANCE_M, max(_MIN_DISTANCE_M, distance)))

    def to_list(self) -> List[float]:
        """Return it as a list of six numbers, to store."""
        return [round(value, 4) for value in (
            *self.target_m, self.yaw_rad, self.pitch_rad, self.distance_m)]


def read_orbit(values: object) -> Orbit:
    """Return the :class:`Orbit` of a list from :meth:`Orbit.to_list`.

    :raises ValueError: the list is malformed, or has impossible values
    """
    if not isinstance(values, list) or len(values) != 6 or not all(
            type(value) in (int, float) and abs(value) <= _BEYOND_M for value in values):
        raise ValueError('expected six numbers, got {!r}'.format(values))
    x, y, z, yaw, pitch, distance = values
    if abs(pitch) > _MAX_PITCH_RAD or not _MIN_DISTANCE_M <= distance <= _MAX_DISTANCE_M:
        raise ValueError('expected a possible pitch and distance, got {!r}'.format(values))
    return Orbit((x, y, z), yaw, pitch, distance)


def focal_px(height_px: float) -> float:
    """Return the focal length [px] of a picture with this height [px]."""
    return 0.5 * max(1.0, height_px) / math.tan(0.5 * FIELD_OF_VIEW_RAD)


def projected(places_m: np.ndarray, orbit: Orbit, size: Size) -> np.ndarray:
    """Return places projected into a picture: columns x, y [px] and distance ahead [m], (n, 3).

    :param places_m: (n, 3), x ahead, y left, z up; places behind the eye become NaN
    :param size: (width, height) of the picture [px]
    """
    seen = (np.asarray(places_m, float) - orbit.eye_m()) @ orbit.axes().T
    with np.errstate(divide='ignore', invalid='ignore'):
        seen[:, :2] *= focal_px(size[1]) / np.where(seen[:, 2:] > 0.0, seen[:, 2:], np.nan)
    seen[:, :2] += 0.5 * size[0], 0.5 * size[1]
    return seen


def fitted(points_m: np.ndarray) -> Orbit:
    """Return an :class:`Orbit` that shows most of some points, and the sensor, from behind.

    :param points_m: (n, 3), x ahead, y left, z up, finite
    """
    if not len(points_m):
        return Orbit()
    low, high = np.percentile(points_m, _CORE_PERCENT, axis=0)
    low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    x, y, z = ((low + high) / 2.0).tolist()
    orbit = Orbit((x, y, z), distance_m=_NEAREST_FIT_M)
    # The box around most of the points, slightly reduced, since its corners are often empty.
    corners = np.array(np.meshgrid(*zip(0.9 * low + 0.1 * high, 0.9 * high + 0.1 * low)))
    places = np.vstack((corners.reshape(3, -1).T, ((0.0, 0.0, 0.0), (-0.3, 0.0, low[2]))))
    while orbit.distance_m < _MAX_DISTANCE_M and not _shows(orbit, places):
        orbit = replace(orbit, distance_m=min(_MAX_DISTANCE_M, 1.05 * orbit.distance_m))
    return orbit


def _shows(orbit: Orbit, places_m: np.ndarray) -> bool:
    """Return whether places are in a picture a little wider than high, clear of its edges."""
    seen = projected(places_m, orbit, _FIT_SIZE)
    off = np.abs(seen[:, :2] - 0.5 * np.array(_FIT_SIZE))
    return bool((seen[:, 2] > 0.0).all() and (off < 0.46 * np.array(_FIT_SIZE)).all())
