# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a cloud into a picture with numpy: no GPU, and only pixels go to a remote screen.

The points are sorted by distance from the eye, and their ranks put into a buffer, in which near
points become squares: each pixel takes the nearest point of its neighbourhood, so that no far point
covers a near one. The background is dark on every desktop, as a camera's picture is independent of
the theme, too.
"""
import math
from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mhri.base.opencv import cv2
from mhri.camera.images import Range, Size
from mhri.camera.range_follower import RangeFollower
from mhri.sensors.orbit import focal_px, Orbit, projected
from mhri.sensors.point_cloud import Cloud

HEIGHT, DISTANCE, INTENSITY, COLOUR = 'height', 'distance', 'intensity', 'colour'

#: the empty picture, the lines on the floor, the robot (0xffrrggbb)
GROUND, LINES, ROBOT = 0xff15191d, 0xff39424b, 0xffffffff
_AHEAD, _LEFT, _UP = 0xffe69f00, 0xff009e73, 0xff56b4e9
# x ahead, y left, z up of an optical frame's x right, y down, z ahead (REP-103).
_FROM_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
_SAMPLES = 20_000
# No sensor's intensity is larger, and differences between such values do not overflow.
_MAX_INTENSITY = np.float32(1e30)
# The width of a point [m], and the sides it can have on the screen [px].
_POINT_M = 0.02
_SIDES_PX = (2, 3, 5)
_SPARSE = 60_000
# Points nearer to the eye than this part of the distance to its target are not drawn.
_NEAR = 0.05
_GRID_M = (0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
_GRID_LINES = 10
#: how far above the floor a cloud is cut when the eye is above that [m]
CEILING_M = 1.9
_DOWN_RAD = math.radians(10.0)
_ROBOT_RADIUS_M = 0.18
_Line = Tuple[Tuple[float, ...], Tuple[float, ...]]
_FOLLOWERS = {HEIGHT: (0.5, -math.inf), DISTANCE: (0.5, 0.0), INTENSITY: (1e-3, -math.inf)}


class Picture(NamedTuple):
    """A drawn cloud: ``pixels``, uint32 (h, w), each 0xffrrggbb, and their scale.

    ``scale`` is the range of the colours, in metres or the unit of the intensity, None if the
    points have colours of their own; ``grid_m`` the spacing of the lines on the floor,
    ``colouring`` the meaning of the colours. ``cut``: points more than :data:`CEILING_M` above the
    floor are left out.
    """

    pixels: np.ndarray
    scale: Optional[Range]
    grid_m: float
    colouring: str
    cut: bool = False


def _table() -> np.ndarray:
    """Return 256 colours as 0xffrrggbb: viridis without the darkest, invisible on the background.

    Its lightness grows evenly, so people with any of the usual colour deficiencies can read it.
    """
    ramp = np.linspace(50, 255, 256).round().astype(np.uint8).reshape(256, 1)
    blue, green, red = cv2.applyColorMap(ramp, cv2.COLORMAP_VIRIDIS)[:, 0].T.astype(np.uint32)
    return np.uint32(0xff000000) | red << 16 | green << 8 | blue


TABLE = _table()


def upright_axes(cloud: Cloud) -> np.ndarray:
    """Return the rotation of a cloud's points into x ahead, y left, z up: rows, float64 (3, 3)."""
    return _FROM_OPTICAL if cloud.optical else np.eye(3)


def colourings(cloud: Cloud) -> Tuple[str, ...]:
    """Return the ways in which a cloud can be coloured."""
    extras = ((INTENSITY, cloud.intensity), (COLOUR, cloud.colours))
    return (HEIGHT, DISTANCE) + tuple(key for key, values in extras if values is not None)


class CloudArtist:
    """Draws the clouds of one sensor; the scales follow the clouds without flickering.

    One thread at a time.
    """

    def __init__(self) -> None:
        self._followers = {key: RangeFollower(*limits) for key, limits in _FOLLOWERS.items()}

    def draw(self, cloud: Cloud, orbit: Orbit, size: Size, colouring: str = HEIGHT) -> Picture:
        """Return the :class:`Picture` of a cloud.

        :param size: (width, height) of the picture [px], > 0
        :param colouring: one of :func:`colourings`; height if the cloud does not have it
        """
        if colouring not in colourings(cloud):
            colouring = HEIGHT
        heights = _along(upright_axes(cloud)[2], cloud.points)
        floor = self._follow(HEIGHT, heights, cloud.received_s)
        colours, scale = self._colours(cloud, colouring, heights, floor)
        floor_m = floor[0] if floor else 0.0
        top_m = floor_m + CEILING_M
        # From above, a ceiling would hide the room, and no robot reaches it.
        hides = orbit.pitch_rad > _DOWN_RAD and orbit.eye_m()[2] > top_m
        low = heights < top_m if hides else np.ones(len(heights), bool)
        grid_m = next((step for step in _GRID_M if step >= 0.15 * orbit.distance_m), _GRID_M[-1])
        pixels = np.full((size[1], size[0]), GROUND, np.uint32)
        pen = _Pen(pixels, orbit)
        pen.grid(floor_m, grid_m)
        _splat(pixels, cloud, colours, orbit, low)
        pen.robot(floor_m)
        return Picture(pixels, scale, grid_m, colouring, not low.all())

    def _follow(self, key: str, values: np.ndarray, now: float) -> Optional[Range]:
        """Return the range of the scale of some values after one more cloud."""
        return self._followers[key].follow(values[::max(1, len(values) // _SAMPLES)], now)

    def _colours(self, cloud: Cloud, colouring: str, heights: np.ndarray,
                 floor: Optional[Range]) -> Tuple[np.ndarray, Optional[Range]]:
        """Return (0xffrrggbb of each point, the range of the scale)."""
        if colouring == COLOUR and cloud.colours is not None:
            return cloud.colours, None
        values, scale = heights, floor
        if colouring == DISTANCE:
            values = np.sqrt(sum(np.square(column) for column in cloud.points.T))
        elif colouring == INTENSITY and cloud.intensity is not None:
            values = np.clip(np.nan_to_num(cloud.intensity), -_MAX_INTENSITY, _MAX_INTENSITY)
        if colouring != HEIGHT:
            scale = self._follow(colouring, values, cloud.received_s)
        low, high = scale or (0.0, 1.0)
        steps = 255.0 / (high - low)
        # Near is light, as in a depth picture.
        gain, begin = (-steps, high) if colouring == DISTANCE else (steps, low)
        if not len(values):
            return np.empty(0, np.uint32), scale
        # OpenCV rounds and clips to 0..255 on its own, in a fraction of numpy's time.
        shade = cv2.addWeighted(values, gain, values, 0.0, -begin * gain, dtype=cv2.CV_8U)
        return TABLE.take(shade.reshape(-1)), scale


def _along(axis: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return how far points are along an axis, float32 (n,).

    A matrix product would run on threads that cost more than they save.
    """
    a, b, c = axis.astype(np.float32)
    x, y, z = points.T
    found: np.ndarray = a * x
    found += b * y
    found += c * z
    return found


def _splat(pixels: np.ndarray, cloud: Cloud, colours: np.ndarray, orbit: Orbit,
           wanted: np.ndarray) -> None:
    """Draw the wanted points (bool (n,)) of a cloud into a picture."""
    height, width = pixels.shape
    focal = focal_px(height)
    lens = np.array([[focal, 0.0, 0.5 * width], [0.0, focal, 0.5 * height], [0.0, 0.0, 1.0]])
    turn = lens @ orbit.axes()
    x, y, ahead = (_along(axis, cloud.points) for axis in turn @ upright_axes(cloud))
    shift = (turn @ orbit.eye_m()).astype(np.float32)
    ahead -= shift[2]
    near = np.float32(_NEAR * orbit.distance_m)
    with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
        closeness = np.float32(1.0) / ahead
        x = (x - shift[0]) * closeness
        y = (y - shift[1]) * closeness
        seen = np.flatnonzero(wanted & (ahead > near) & (x >= 0) & (x < width)
                              & (y >= 0) & (y < height))
    closeness = closeness[seen]
    # 16 bits suffice for the order in depth, and are sorted in a tenth of the time.
    far_first = np.argsort((closeness * (near * 65535)).astype(np.uint16), kind='stable')
    seen, closeness = seen[far_first], closeness[far_first]
    place = y[seen].astype(np.int32) * width + x[seen].astype(np.int32)
    # float32 holds ranks exactly, and OpenCV dilates float32 quickly.
    ranks = np.zeros(pixels.shape, np.float32)
    ranks.reshape(-1)[place] = np.arange(1, len(seen) + 1, dtype=np.float32)
    ranks = _grown(ranks, closeness, focal, len(cloud.points))
    found = np.empty(len(seen) + 1, np.uint32)
    found[1:] = colours[seen]
    drawn = found.take(ranks.astype(np.int32))
    cv2.copyTo(_bytes(drawn), (ranks > 0).view(np.uint8), _bytes(pixels))


def _grown(ranks: np.ndarray, closeness: np.ndarray, focal: float, count: int) -> np.ndarray:
    """Return a buffer of ranks in which near points are squares.

    :param closeness: of each rank, ascending: 1 / distance ahead [1/m]
    :param count: number of points of the cloud: all points of a sparse cloud are drawn larger
    """
    grown = ranks
    for side in _SIDES_PX:
        first = int(closeness.searchsorted(np.float32((side - 0.5) / (focal * _POINT_M))))
        if side == _SIDES_PX[0] and count < _SPARSE:
            first = 0
        if first < len(closeness):
            _, large = cv2.threshold(ranks, first, 0.0, cv2.THRESH_TOZERO)
            grown = np.maximum(grown, cv2.dilate(large, np.ones((side, side), np.uint8)))
    return grown


def _bytes(pixels: np.ndarray) -> np.ndarray:
    """Return pixels as OpenCV's channels, (h, w, 4): blue, green, red, alpha, as in memory."""
    return pixels.view(np.uint8).reshape(pixels.shape + (4,))


class _Pen:
    """Draws lines given in metres into a picture."""

    def __init__(self, pixels: np.ndarray, orbit: Orbit) -> None:
        self._image = _bytes(pixels)
        self._size = (pixels.shape[1], pixels.shape[0])
        self._orbit = orbit
        self._near_m = _NEAR * orbit.distance_m

    def grid(self, floor_m: float, step_m: float) -> None:
        """Draw the lines on the floor around the eye's target."""
        x, y = (step_m * round(value / step_m) for value in self._orbit.target_m[:2])
        reach = _GRID_LINES * step_m
        lines = []
        for index in range(-_GRID_LINES, _GRID_LINES + 1):
            along = index * step_m
            lines += [((x + along, y - reach, floor_m), (x + along, y + reach, floor_m)),
                      ((x - reach, y + along, floor_m), (x + reach, y + along, floor_m))]
        self._lines(lines, LINES)

    def robot(self, floor_m: float) -> None:
        """Draw the sensor with its axes (ahead, left, up) and the robot's circle below it."""
        here, length = (0.0, 0.0, 0.0), 2.5 * _ROBOT_RADIUS_M
        around = [(_ROBOT_RADIUS_M * math.cos(angle), _ROBOT_RADIUS_M * math.sin(angle), floor_m)
                  for angle in np.linspace(0.0, 2.0 * math.pi, 25)]
        self._lines([((0.0, 0.0, floor_m), here)] + list(zip(around, around[1:])), ROBOT, 2)
        for end, ink in (((length, 0.0, 0.0), _AHEAD), ((0.0, length, 0.0), _LEFT),
                         ((0.0, 0.0, length), _UP)):
            self._lines([(here, end)], ink, 2)

    def _lines(self, lines: Sequence[_Line], ink: int, thickness: int = 1) -> None:
        """Draw the parts of lines that are ahead."""
        ends = np.array(lines)
        depths = (ends - self._orbit.eye_m()) @ self._orbit.axes()[2] - self._near_m
        seen = depths.max(axis=1) > 0.0
        if not seen.any():
            return
        ends, depths = ends[seen], depths[seen]
        cut, back = np.flatnonzero(depths.min(axis=1) < 0.0), depths.argmin(axis=1)
        for line in cut:
            begin, end = back[line], 1 - back[line]
            share = depths[line, begin] / (depths[line, begin] - depths[line, end])
            ends[line, begin] += share * (ends[line, end] - ends[line, begin])
        places = projected(ends.reshape(-1, 3), self._orbit, self._size)[:, :2]
        # OpenCV requires 32-bit integers, and has whole numbers at the centres of pixels.
        corners = np.clip(places - 0.5, -20_000, 20_000).round().astype(np.int32)
        colour = [ink & 255, ink >> 8 & 255, ink >> 16 & 255, 255]
        cv2.polylines(self._image, list(corners.reshape(-1, 2, 2)), False, colour, thickness,
                      cv2.LINE_AA)
