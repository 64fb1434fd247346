# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which part of the world a map shows: metres to pixels and back, scale bar, places in words."""
from dataclasses import dataclass, replace
import math
from typing import List, Tuple

import numpy as np

from mhri.map.grid import Grid

# A robot is a dot, or fills the map.
LEAST_PX_PER_M, MOST_PX_PER_M = 2.0, 1000.0
# Farther from its middle [m] than this nobody pans.
FARTHEST_M = 1000.0


@dataclass(frozen=True)
class Canvas:
    """A map of some size [px]; x of a pixel grows to the right, y downwards.

    :param x_m: the place in the middle, like ``y_m``
    :param turn_rad: by how much the world is turned to the left: 0 has its x axis to the right
    """

    width: int
    height: int
    x_m: float = 0.0
    y_m: float = 0.0
    px_per_m: float = 60.0
    turn_rad: float = 0.0

    def pixels(self, places: np.ndarray) -> np.ndarray:
        """Return the pixels, an array (n, 2), of places (n, 2) [m]."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        turned = (places - (self.x_m, self.y_m)) @ np.array(((cos, -sin), (-sin, -cos)))
        return np.asarray(turned * self.px_per_m + (self.width / 2.0, self.height / 2.0))

    def pixel(self, x_m: float, y_m: float) -> Tuple[float, float]:
        """Return the pixel of a place."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        ahead, left = x_m - self.x_m, y_m - self.y_m
        return (self.width / 2.0 + (ahead * cos - left * sin) * self.px_per_m,
                self.height / 2.0 - (ahead * sin + left * cos) * self.px_per_m)

    def world(self, x_px: float, y_px: float) -> Tuple[float, float]:
        """Return the place [m] of a pixel."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        right, up = x_px - self.width / 2.0, self.height / 2.0 - y_px
        return (self.x_m + (right * cos + up * sin) / self.px_per_m,
                self.y_m + (up * cos - right * sin) / self.px_per_m)

    def heading(self, heading_rad: float) -> float:
        """Return a heading as it is drawn [rad]: 0 is to the right, a quarter turn up."""
        return heading_rad + self.turn_rad

    def resized(self, width: int, height: int) -> 'Canvas':
        """Return it with another size, the same place in its middle."""
        return replace(self, width=max(1, width), height=max(1, height))

    def centred(self, x_m: float, y_m: float) -> 'Canvas':
        """Return it with another place in its middle, within :data:`FARTHEST_M`."""
        return replace(self, x_m=min(FARTHEST_M, max(-FARTHEST_M, x_m)),
                       y_m=min(FARTHEST_M, max(-FARTHEST_M, y_m)))

    def zoomed(self, factor: float, x_px: float, y_px: float) -> 'Canvas':
        """Return it larger by a factor; what is at a pixel stays there."""
        x_m, y_m = self.world(x_px, y_px)
        scaled = replace(self, px_per_m=min(MOST_PX_PER_M, max(
            LEAST_PX_PER_M, self.px_per_m * factor)))
        x_now, y_now = scaled.world(x_px, y_px)
        return scaled.centred(self.x_m + x_m - x_now, self.y_m + y_m - y_now)

    def panned(self, right_px: float, down_px: float) -> 'Canvas':
        """Return it with everything moved by so many pixels."""
        return self.centred(*self.world(self.width / 2.0 - right_px, self.height / 2.0 - down_px))

    def turned(self, turn_rad: float) -> 'Canvas':
        """Return it with the world turned so much, about its middle."""
        return replace(self, turn_rad=turn_rad)

    def showing(self, least: Tuple[float, float], most: Tuple[float, float],
                most_px_per_m: float = 150.0) -> 'Canvas':
        """Return it with all between two corners (x, y) [m] on show, with a margin."""
        width, height = most[0] - least[0] + 0.6, most[1] - least[1] + 0.6
        scale = min(self.width / width, self.height / height, most_px_per_m)
        return replace(self, px_per_m=max(LEAST_PX_PER_M, scale)).centred(
            (least[0] + most[0]) / 2.0, (least[1] + most[1]) / 2.0)

    def follows(self, x_m: float, y_m: float) -> 'Canvas':
        """Return it moved just so far that a place is in the middle third."""
        right, down = self.pixel(x_m, y_m)
        beyond = [place - min(2.0 * size / 3.0, max(size / 3.0, place))
                  for place, size in ((right, self.width), (down, self.height))]
        return self.panned(-beyond[0], -beyond[1]) if any(beyond) else self


def scale_bar(px_per_m: float, most_px: float) -> Tuple[float, float]:
    """Return the length of a scale bar [m], 1, 2 or 5 of some power of ten, and its pixels.

    :param most_px: it is not longer than this
    """
    longest = most_px / px_per_m
    decade = 10.0 ** math.floor(math.log10(longest))
    length = next(part * decade for part in (5.0, 2.0, 1.0) if part * decade <= longest * 1.0001)
    return length, length * px_per_m


def length_words(length_m: float) -> str:
    """Return a length of the scale bar in words, e.g. "20 cm", "5 m", "1 km"."""
    if length_m < 0.995:
        return '{:g} cm'.format(round(100.0 * length_m, 3))
    if length_m < 999.5:
        return '{:g} m'.format(round(length_m, 3))
    return '{:g} km'.format(round(length_m / 1000.0, 3))


def place_words(x_m: float, y_m: float) -> str:
    """Return a place in words, as wide for every place on a map of 200 m."""
    return 'x {:6.2f} m  y {:6.2f} m'.format(x_m + 0.0, y_m + 0.0)


def known_corners(grid: Grid) -> List[Tuple[float, float]]:
    """Return the four corners (x, y) [m] between which cells of a map are known; none: nothing."""
    known = grid.cells >= 0
    rows, columns = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return []
    cos, sin = math.cos(grid.origin.heading_rad), math.sin(grid.origin.heading_rad)
    return [(grid.origin.x_m + (x * cos - y * sin) * grid.resolution_m,
             grid.origin.y_m + (x * sin + y * cos) * grid.resolution_m)
            for x in (int(columns[0]), int(columns[-1]) + 1)
            for y in (int(rows[0]), int(rows[-1]) + 1)]
