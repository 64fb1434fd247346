# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The visible part of a map: conversion of metres and pixels, scale bar, positions as text."""
from dataclasses import dataclass, replace
import math
from typing import List, Tuple

import numpy as np

from mhri.base.geometry import beside
from mhri.map.grid import Grid

# Zoom range: a robot is a dot at the minimum, and fills the map at the maximum.
MIN_PX_PER_M, MAX_PX_PER_M = 2.0, 1000.0
# Maximum scale at which everything is shown.
_FITTED_PX_PER_M = 150.0
# Maximum distance of panning from the origin [m].
FARTHEST_M = 1000.0


@dataclass(frozen=True)
class Canvas:
    """A map of some size [px]; x of a pixel grows to the right, y downwards.

    :param x_m: position at the centre, like ``y_m``
    :param turn_rad: rotation of the world to the left: 0 has its x axis to the right
    """

    width: int
    height: int
    x_m: float = 0.0
    y_m: float = 0.0
    px_per_m: float = 60.0
    turn_rad: float = 0.0

    def pixels(self, places: np.ndarray) -> np.ndarray:
        """Return the pixels, an array (n, 2), of positions (n, 2) [m]."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        turned = (places - (self.x_m, self.y_m)) @ np.array(((cos, -sin), (-sin, -cos)))
        return np.asarray(turned * self.px_per_m + (self.width / 2.0, self.height / 2.0))

    def pixel(self, x_m: float, y_m: float) -> Tuple[float, float]:
        """Return the pixel of a position."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        ahead, left = x_m - self.x_m, y_m - self.y_m
        return (self.width / 2.0 + (ahead * cos - left * sin) * self.px_per_m,
                self.height / 2.0 - (ahead * sin + left * cos) * self.px_per_m)

    def world(self, x_px: float, y_px: float) -> Tuple[float, float]:
        """Return the position [m] of a pixel."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        right, up = x_px - self.width / 2.0, self.height / 2.0 - y_px
        return (self.x_m + (right * cos + up * sin) / self.px_per_m,
                self.y_m + (up * cos - right * sin) / self.px_per_m)

    def heading(self, heading_rad: float) -> float:
        """Return the drawn angle of a heading [rad]: 0 is to the right, pi / 2 up."""
        return heading_rad + self.turn_rad

    def resized(self, width: int, height: int) -> 'Canvas':
        """Return a copy with another size and the same centre."""
        return replace(self, width=max(1, width), height=max(1, height))

    def centred(self, x_m: float, y_m: float) -> 'Canvas':
        """Return a copy with another centre, within :data:`FARTHEST_M`."""
        return replace(self, x_m=min(FARTHEST_M, max(-FARTHEST_M, x_m)),
                       y_m=min(FARTHEST_M, max(-FARTHEST_M, y_m)))

    def zoomed(self, factor: float, x_px: float, y_px: float) -> 'Canvas':
        """Return a copy zoomed by a factor about a pixel."""
        x_m, y_m = self.world(x_px, y_px)
        scaled = replace(self, px_per_m=min(MAX_PX_PER_M, max(
            MIN_PX_PER_M, self.px_per_m * factor)))
        x_now, y_now = scaled.world(x_px, y_px)
        return scaled.centred(self.x_m + x_m - x_now, self.y_m + y_m - y_now)

    def panned(self, right_px: float, down_px: float) -> 'Canvas':
        """Return a copy panned by pixels."""
        return self.centred(*self.world(self.width / 2.0 - right_px, self.height / 2.0 - down_px))

    def turned(self, turn_rad: float) -> 'Canvas':
        """Return a copy with another rotation about its centre."""
        return replace(self, turn_rad=turn_rad)

    def showing(self, least: Tuple[float, float], most: Tuple[float, float],
                taken: Tuple[int, int] = (0, 0)) -> 'Canvas':
        """Return a copy that shows everything between two corners (x, y) [m], with a margin.

        :param taken: width and height of what lies over its lower right corner [px]; everything is
            shown at the left of it or above it
        """
        width, height = most[0] - least[0] + 0.6, most[1] - least[1] + 0.6
        scale, wide, high = max((min(wide / width, high / height), wide, high) for wide, high in (
            (max(1, self.width - taken[0]), self.height),
            (self.width, max(1, self.height - taken[1]))))
        shown = replace(self, px_per_m=max(MIN_PX_PER_M, min(scale, _FITTED_PX_PER_M))).centred(
            (least[0] + most[0]) / 2.0, (least[1] + most[1]) / 2.0)
        return shown.panned((wide - self.width) / 2.0, (high - self.height) / 2.0) \
            if any(taken) else shown

    def follows(self, x_m: float, y_m: float) -> 'Canvas':
        """Return a copy panned just enough for a position to be in the middle third."""
        right, down = self.pixel(x_m, y_m)
        beyond = [place - min(2.0 * size / 3.0, max(size / 3.0, place))
                  for place, size in ((right, self.width), (down, self.height))]
        return self.panned(-beyond[0], -beyond[1]) if any(beyond) else self


def scale_bar(px_per_m: float, most_px: float) -> Tuple[float, float]:
    """Return the length of a scale bar [m], 1, 2 or 5 of some power of ten, and its pixels.

    :param most_px: maximum length
    """
    longest = most_px / px_per_m
    decade = 10.0 ** math.floor(math.log10(longest))
    length = next(part * decade for part in (5.0, 2.0, 1.0) if part * decade <= longest * 1.0001)
    return length, length * px_per_m


def length_words(length_m: float) -> str:
    """Return a length of the scale bar as text, e.g. "20 cm", "5 m", "1 km"."""
    if length_m < 0.995:
        return '{:g} cm'.format(round(100.0 * length_m, 3))
    if length_m < 999.5:
        return '{:g} m'.format(round(length_m, 3))
    return '{:g} km'.format(round(length_m / 1000.0, 3))


def place_words(x_m: float, y_m: float) -> str:
    """Return a position as text, of constant width on a map of 200 m."""
    return 'x {:6.2f} m  y {:6.2f} m'.format(x_m + 0.0, y_m + 0.0)


def known_corners(grid: Grid) -> List[Tuple[float, float]]:
    """Return the four corners (x, y) [m] around the known cells of a map; [] without any."""
    known = grid.cells >= 0
    rows, columns = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return []
    return [beside(grid.origin, x * grid.resolution_m, y * grid.resolution_m)
            for x in (int(columns[0]), int(columns[-1]) + 1)
            for y in (int(rows[0]), int(rows[-1]) + 1)]
