# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map of a report as a picture: which part of the world, at which scale, with what on it.

Its world file is as GIS programs read it: six lines, x and y of a step to the right and of one
down, then x and y of the middle of the upper left pixel
(https://en.wikipedia.org/wiki/World_file).
"""
from dataclasses import dataclass
import math
from typing import List, Optional, Sequence, Tuple

import numpy as np

from mhri.base.mocap import Pose
from mhri.base.opencv import cv2
from mhri.map.grid import FREE, Grid, TAKEN_FROM, UNKNOWN

# The longer side has about so many pixels, a pixel is no smaller than this [m].
_SIDE_PX, _LEAST_PX_M = 2000, 0.005
# Around everything; an empty session has a sheet of this, too [m].
_MARGIN_M = 0.5
_PAPER, _UNKNOWN, _TAKEN, _LINES = 255, 232, 60, 240
# Lines of a sheet without a map are at least so far apart [px].
_LINES_PX = 100
_INK = (40, 40, 40)


@dataclass(frozen=True)
class Way:
    """The way of a robot on the map: its number, its colour "#rrggbb", its pieces (n, 2) [m]."""

    name: str
    number: int
    colour: str
    pieces: Sequence[np.ndarray]


@dataclass(frozen=True)
class Spot:
    """A mark on the map: its name, x, y [m]."""

    name: str
    x_m: float
    y_m: float


@dataclass(frozen=True)
class Sheet:
    """A rectangle of the world in pixels: ``corner`` is its upper left one in the map's frame.

    Its rows go along ``corner.heading_rad``; ``px_m`` is the size of a pixel [m].
    """

    corner: Pose
    px_m: float
    width: int
    height: int

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 2) of the map [m] in pixels, from the upper left edge."""
        cos, sin = math.cos(self.corner.heading_rad), math.sin(self.corner.heading_rad)
        away = np.asarray(points, dtype=float).reshape(-1, 2) - (self.corner.x_m, self.corner.y_m)
        return np.column_stack((away @ (cos, sin), away @ (sin, -cos))) / self.px_m

    def world_file(self) -> str:
        """Return the text of its world file, metres of the map's frame."""
        cos, sin = math.cos(self.corner.heading_rad), math.sin(self.corner.heading_rad)
        right, down = (cos * self.px_m, sin * self.px_m), (sin * self.px_m, -cos * self.px_m)
        x_m = self.corner.x_m + 0.5 * (right[0] + down[0])
        y_m = self.corner.y_m + 0.5 * (right[1] + down[1])
        return ''.join('{:.10f}\n'.format(value) for value in (*right, *down, x_m, y_m))


def sheet_of(grid: Optional[Grid], points: np.ndarray) -> Sheet:
    """Return the sheet that a map and points (n, 2) [m] fit on.

    It lies as the map does, and begins at an edge of one of its cells.
    """
    origin = grid.origin if grid is not None else Pose(0.0, 0.0, 0.0)
    cos, sin = math.cos(origin.heading_rad), math.sin(origin.heading_rad)
    away = points.reshape(-1, 2) - (origin.x_m, origin.y_m)
    inside = np.column_stack((away @ (cos, sin), away @ (-sin, cos)))
    if grid is not None:
        inside = np.vstack((inside, (0.0, 0.0), grid.size_m))
    if not len(inside):
        inside = np.zeros((1, 2))
    # What the map holds needs no margin, a way beyond its edge does.
    margin_m = 0.0 if grid is not None and _holds(grid, inside) else _MARGIN_M
    least, most = inside.min(axis=0) - margin_m, inside.max(axis=0) + margin_m
    px_m = max(_LEAST_PX_M, float((most - least).max()) / _SIDE_PX)
    if grid is not None:
        # A whole number of pixels to a cell, or of cells to a pixel.
        cells = px_m / grid.resolution_m
        px_m = grid.resolution_m * (1.0 / math.floor(1.0 / cells) if cells < 1.0
                                    else math.ceil(cells))
    first, last = np.floor(least / px_m + 1e-6), np.ceil(most / px_m - 1e-6)
    width, height = (max(1, int(side)) for side in last - first)
    left_m, top_m = float(first[0]) * px_m, float(last[1]) * px_m
    return Sheet(Pose(origin.x_m + cos * left_m - sin * top_m,
                      origin.y_m + sin * left_m + cos * top_m, origin.heading_rad),
                 px_m, width, height)


def _holds(grid: Grid, inside: np.ndarray) -> bool:
    return bool((inside >= -1e-6).all() and (inside <= np.array(grid.size_m) + 1e-6).all())


def ground(sheet: Sheet, grid: Optional[Grid]) -> np.ndarray:
    """Return the sheet with the map alone, grey (height, width); without a map lines of metres."""
    if grid is None:
        return _lined(sheet)
    picture = np.full((sheet.height, sheet.width), _UNKNOWN, np.uint8)
    shades = np.full(grid.cells.shape, _PAPER, np.uint8)
    known = grid.cells > FREE
    shades[known] = (_PAPER - (_PAPER - _TAKEN) * np.minimum(
        grid.cells[known].astype(np.float32) / TAKEN_FROM, 1.0)).astype(np.uint8)
    shades[grid.cells == UNKNOWN] = _UNKNOWN
    shades = np.ascontiguousarray(shades[::-1])
    scale = grid.resolution_m / sheet.px_m
    height, width = (max(1, round(side * scale)) for side in shades.shape)
    if scale < 1.0:
        # Walls stay where the cells beside them do not: the darkest one counts.
        size = math.ceil(1.0 / scale)
        shades = cv2.erode(shades, np.ones((size, size), np.uint8))
    shades = cv2.resize(shades, (width, height), interpolation=cv2.INTER_NEAREST)
    corner = np.array([[grid.origin.x_m, grid.origin.y_m]])
    left, bottom = (round(float(value)) for value in sheet.pixels(corner)[0])
    top = max(0, bottom - height)
    part = picture[top:top + height, left:left + width]
    part[:] = shades[:part.shape[0], :part.shape[1]]
    return picture


def lines_m(sheet: Sheet) -> float:
    """Return how far apart the lines of a sheet are, and the length of its scale: 1, 2, 5 ... m."""
    least_m = _LINES_PX * sheet.px_m
    power = 10.0 ** math.floor(math.log10(least_m))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= least_m * 0.999)


def _lined(sheet: Sheet) -> np.ndarray:
    picture = np.full((sheet.height, sheet.width), _PAPER, np.uint8)
    step_m = lines_m(sheet)
    for start, count, along in ((sheet.corner.x_m, sheet.width, True),
                                (-sheet.corner.y_m, sheet.height, False)):
        first = math.ceil(start / step_m) * step_m
        places = [round((first - start + number * step_m) / sheet.px_m)
                  for number in range(math.ceil(count * sheet.px_m / step_m))]
        for place in places:
            if 0 <= place < count:
                picture[(slice(None), place) if along else (place, slice(None))] = _LINES
    return picture


def _bgr(colour: str) -> Tuple[int, int, int]:
    return int(colour[5:7], 16), int(colour[3:5], 16), int(colour[1:3], 16)


def drawn(sheet: Sheet, base: np.ndarray, ways: Sequence[Way],
          spots: Sequence[Spot]) -> np.ndarray:
    """Return the sheet with the ways of robots, marks and a scale, (height, width, 3) BGR.

    :param base: of :func:`ground`
    """
    picture = cv2.cvtColor(base, cv2.COLOR_GRAY2BGR)
    unit = max(sheet.width, sheet.height) / 1000.0
    thick = max(1, round(2.5 * unit))
    for way in ways:
        colour = _bgr(way.colour)
        lines = [_whole(sheet.pixels(piece)) for piece in way.pieces if len(piece)]
        for line in lines:
            cv2.polylines(picture, [line], False, colour, thick, cv2.LINE_AA, 3)
        if lines:
            end = tuple(int(value) for value in lines[-1][-1])
            cv2.circle(picture, end, round(11 * unit * 8), colour, -1, cv2.LINE_AA, 3)
            _word(picture, str(way.number), end[0] / 8, end[1] / 8, unit, (255, 255, 255))
    for spot in spots:
        x, y = sheet.pixels(np.array([[spot.x_m, spot.y_m]]))[0]
        corners = _whole(np.array([(x, y - 9 * unit), (x + 9 * unit, y), (x, y + 9 * unit),
                                   (x - 9 * unit, y)]))
        cv2.fillPoly(picture, [corners], (255, 255, 255), cv2.LINE_AA, 3)
        cv2.polylines(picture, [corners], True, _INK, thick, cv2.LINE_AA, 3)
        _word(picture, spot.name, x, y - 20 * unit, unit, _INK)
    _scale(picture, sheet, unit)
    return picture


def _whole(pixels: np.ndarray) -> np.ndarray:
    """Return pixels in eighths, as OpenCV draws them smoothly."""
    return np.clip(np.rint(pixels * 8), -2 ** 28, 2 ** 28).astype(np.int32)


def _word(picture: np.ndarray, text: str, x: float, y: float, unit: float,
          colour: Tuple[int, int, int]) -> None:
    """Write a word with its middle at a pixel."""
    text = text.encode('ascii', 'replace').decode()[:12]
    thick = max(1, round(1.5 * unit))
    (wide, high), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 0.5 * unit, thick)
    # Of a number of an old numpy, round() makes no whole one.
    cv2.putText(picture, text, (round(float(x) - wide / 2), round(float(y) + high / 2)),
                cv2.FONT_HERSHEY_SIMPLEX, 0.5 * unit, colour, thick, cv2.LINE_AA)


def _scale(picture: np.ndarray, sheet: Sheet, unit: float) -> None:
    """Draw how long some metres are."""
    length_m = lines_m(sheet)
    left, low = round(20 * unit), sheet.height - round(20 * unit)
    right = left + round(length_m / sheet.px_m)
    cv2.line(picture, (left, low), (right, low), _INK, max(1, round(3 * unit)))
    _word(picture, '{:g} m'.format(length_m), (left + right) / 2, low - 14 * unit, unit, _INK)


def bounds_points(ways: Sequence[Way], spots: Sequence[Spot]) -> np.ndarray:
    """Return all places (n, 2) [m] that a sheet is to show."""
    parts: List[np.ndarray] = [piece for way in ways for piece in way.pieces]
    parts.append(np.array([(spot.x_m, spot.y_m) for spot in spots], dtype=float).reshape(-1, 2))
    return np.vstack(parts)
