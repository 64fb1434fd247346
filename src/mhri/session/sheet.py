# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map of a report as a picture: its extent, scale and contents.

Its world file is in the format of GIS programs: six lines, x and y of a step to the right, x and y
of a step down, then x and y of the centre of the upper left pixel
(https://en.wikipedia.org/wiki/World_file).
"""
from dataclasses import dataclass
import math
from typing import List, Optional, Sequence, Tuple

import numpy as np

from mhri.base.geometry import beside, into, Pose
from mhri.base.opencv import cv2
from mhri.base.series import round_step
from mhri.base.views import FlagView
from mhri.map.grid import FREE, Grid, TAKEN_FROM, UNKNOWN
from mhri.map.labels import place_labels

# Approximate length of the longer side [px], minimum size of a pixel [m].
_SIDE_PX, _MIN_PX_M = 2000, 0.005
# Margin around the contents, also of an empty session [m].
_MARGIN_M = 0.5
_PAPER, _UNKNOWN, _TAKEN, _LINES = 255, 232, 60, 240
# Minimum spacing of the grid lines on a sheet without a map [px].
_LINES_PX = 100
_INK = (40, 40, 40)
# Thickness of letters [units].
_STROKE = 1.5


@dataclass(frozen=True)
class Way:
    """The path of a robot on the map: name, number, colour "#rrggbb", pieces (n, 2) [m]."""

    name: str
    number: int
    colour: str
    pieces: Sequence[np.ndarray]


@dataclass(frozen=True)
class Sheet:
    """A rectangle of the world in pixels; ``corner`` is its upper left corner in the map's frame.

    Rows run along ``corner.heading_rad``; ``px_m`` is the size of a pixel [m].
    """

    corner: Pose
    px_m: float
    width: int
    height: int

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 2) of the map [m] in pixels from the upper left corner."""
        away = into(self.corner, np.asarray(points, dtype=float).reshape(-1, 2))
        return away * (1.0, -1.0) / self.px_m

    def world_file(self) -> str:
        """Return the text of the world file, in metres of the map's frame."""
        cos, sin = math.cos(self.corner.heading_rad), math.sin(self.corner.heading_rad)
        right, down = (cos * self.px_m, sin * self.px_m), (sin * self.px_m, -cos * self.px_m)
        middle = beside(self.corner, 0.5 * self.px_m, -0.5 * self.px_m)
        return ''.join('{:.10f}\n'.format(value) for value in (*right, *down, *middle))


def sheet_of(grid: Optional[Grid], points: np.ndarray) -> Sheet:
    """Return a sheet that contains a map and points (n, 2) [m].

    It is oriented like the map and aligned with the edges of the map's cells.
    """
    origin = grid.origin if grid is not None else Pose(0.0, 0.0, 0.0)
    inside = into(origin, points.reshape(-1, 2))
    if grid is not None:
        inside = np.vstack((inside, (0.0, 0.0), grid.size_m))
    if not len(inside):
        inside = np.zeros((1, 2))
    # Only a path that leaves the map needs a margin.
    margin_m = 0.0 if grid is not None and _holds(grid, inside) else _MARGIN_M
    least, most = inside.min(axis=0) - margin_m, inside.max(axis=0) + margin_m
    px_m = max(_MIN_PX_M, float((most - least).max()) / _SIDE_PX)
    if grid is not None:
        # A whole number of pixels per cell, or of cells per pixel.
        cells = px_m / grid.resolution_m
        px_m = grid.resolution_m * (1.0 / math.floor(1.0 / cells) if cells < 1.0
                                    else math.ceil(cells))
    first, last = np.floor(least / px_m + 1e-6), np.ceil(most / px_m - 1e-6)
    width, height = (max(1, int(side)) for side in last - first)
    left_m, top_m = float(first[0]) * px_m, float(last[1]) * px_m
    return Sheet(Pose(*beside(origin, left_m, top_m), origin.heading_rad), px_m, width, height)


def _holds(grid: Grid, inside: np.ndarray) -> bool:
    return bool((inside >= -1e-6).all() and (inside <= np.array(grid.size_m) + 1e-6).all())


def ground(sheet: Sheet, grid: Optional[Grid]) -> np.ndarray:
    """Return the map as a grey picture (height, width); without a map, a metric grid."""
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
        # Use the darkest cell of each pixel, so that thin walls stay visible.
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
    """Return the spacing of the grid lines, also the length of the scale bar: 1, 2, 5 ... m."""
    return round_step(_LINES_PX * sheet.px_m)


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
          flags: Sequence[FlagView]) -> np.ndarray:
    """Return the sheet with paths, marks and a scale bar, (height, width, 3) BGR.

    :param base: result of :func:`ground`
    """
    picture = cv2.cvtColor(base, cv2.COLOR_GRAY2BGR)
    unit = max(sheet.width, sheet.height) / 1000.0
    thick = _thick(unit)
    for way in ways:
        pieces = [piece for piece in way.pieces if len(piece)]
        for piece in pieces:
            draw_path(picture, sheet, piece, way.colour, unit)
        if pieces:
            start = _eighths(sheet, pieces[0][0])
            for ink, width in (((255, 255, 255), -1), (_bgr(way.colour), thick)):
                cv2.circle(picture, start, round(7 * unit * 8), ink, width, cv2.LINE_AA, 3)
            draw_robot(picture, sheet, pieces[-1][-1], way, unit)
    _flags(picture, sheet, flags, unit)
    _scale(picture, sheet, unit)
    return picture


def draw_path(picture: np.ndarray, sheet: Sheet, points: np.ndarray, colour: str,
              unit: float) -> None:
    """Draw a path (n, 2) [m] on a picture of a sheet.

    :param unit: size of lines and words; 1 on a sheet of 1000 px
    """
    cv2.polylines(picture, [_whole(sheet.pixels(points))], False, _bgr(colour), _thick(unit),
                  cv2.LINE_AA, 3)


def draw_robot(picture: np.ndarray, sheet: Sheet, place: Sequence[float], way: Way, unit: float,
               pale: bool = False) -> None:
    """Draw the disc of a robot with its number at a place (x, y) [m].

    :param pale: whether its place is not its present one
    """
    at = _eighths(sheet, place)
    colour = tuple((3 * part + 7 * 255) // 10 if pale else part for part in _bgr(way.colour))
    cv2.circle(picture, at, round(11 * unit * 8), colour, -1, cv2.LINE_AA, 3)
    if pale:
        cv2.circle(picture, at, round(11 * unit * 8), _INK, max(1, _thick(unit) // 2), cv2.LINE_AA,
                   3)
    _word(picture, str(way.number), at[0] / 8, at[1] / 8, unit, _INK if pale else (255, 255, 255))


def _thick(unit: float) -> int:
    return max(1, round(2.5 * unit))


def _eighths(sheet: Sheet, place: Sequence[float]) -> Tuple[int, int]:
    """Return a place (x, y) [m] in eighths of a pixel."""
    across, down = _whole(sheet.pixels(np.asarray(place)))[0]
    return int(across), int(down)


def _flags(picture: np.ndarray, sheet: Sheet, flags: Sequence[FlagView], unit: float) -> None:
    """Draw marks as on the screen: flags with their words."""
    pixels = sheet.pixels(np.array([(flag.x_m, flag.y_m) for flag in flags]).reshape(-1, 2))
    places = [(float(x), float(y), _ascii(flag.label)) for (x, y), flag in zip(pixels, flags)]
    words = place_labels(places, lambda text: float(_text_size(text, unit)[0]), 18 * unit,
                         20 * unit, sheet.width)
    for (x, y, _), (left, text) in zip(places, words):
        _flag(picture, x, y, text, left, unit)


def _flag(picture: np.ndarray, x: float, y: float, text: str, left: float, unit: float) -> None:
    """Draw a flag at a pixel, and a text that begins at ``left``."""
    top = y - 26 * unit
    for ink, thick in (((255, 255, 255), 5.0), (_INK, 2.0)):
        pole = _whole(np.array([(x, y), (x, top)]))
        cv2.polylines(picture, [pole], False, ink, max(1, round(thick * unit)), cv2.LINE_AA, 3)
    cloth = _whole(np.array([(x, top), (x + 16 * unit, top + 6 * unit), (x, top + 12 * unit)]))
    cv2.fillPoly(picture, [cloth], _INK, cv2.LINE_AA, 3)
    cv2.circle(picture, tuple(int(value) for value in _whole(np.array([x, y]))),
               round(3.5 * unit * 8), _INK, -1, cv2.LINE_AA, 3)
    for ink, thick in (((255, 255, 255), 5.0), (_INK, _STROKE)):
        _write(picture, text, left, top + 12 * unit, unit, ink, thick)


def _whole(pixels: np.ndarray) -> np.ndarray:
    """Return pixels in eighths, for OpenCV's subpixel drawing."""
    return np.clip(np.rint(pixels * 8), -2 ** 28, 2 ** 28).astype(np.int32)


def _word(picture: np.ndarray, text: str, x: float, y: float, unit: float,
          colour: Tuple[int, int, int]) -> None:
    """Write a word centred at a pixel."""
    wide, high = _text_size(text, unit)
    # float(), because round() of a number of an old numpy does not return an int.
    _write(picture, text, float(x) - wide / 2, float(y) + high / 2, unit, colour)


def _write(picture: np.ndarray, text: str, left: float, low: float, unit: float,
           colour: Tuple[int, int, int], thick: float = _STROKE) -> None:
    """Write a text that begins at a pixel."""
    cv2.putText(picture, text, (round(left), round(low)), cv2.FONT_HERSHEY_SIMPLEX, 0.5 * unit,
                colour, max(1, round(thick * unit)), cv2.LINE_AA)


def _text_size(text: str, unit: float) -> Tuple[int, int]:
    """Return width and height of a text [px]."""
    wide, high = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 0.5 * unit,
                                 max(1, round(_STROKE * unit)))[0]
    return int(wide), int(high)


def _ascii(text: str) -> str:
    """Return a text in the characters that OpenCV can write."""
    return text.replace('\u2026', '...').encode('ascii', 'replace').decode()


def _scale(picture: np.ndarray, sheet: Sheet, unit: float) -> None:
    """Draw the scale bar."""
    length_m = lines_m(sheet)
    left, low = round(20 * unit), sheet.height - round(20 * unit)
    right = left + round(length_m / sheet.px_m)
    cv2.line(picture, (left, low), (right, low), _INK, max(1, round(3 * unit)))
    _word(picture, '{:g} m'.format(length_m), (left + right) / 2, low - 14 * unit, unit, _INK)


def bounds_points(ways: Sequence[Way], flags: Sequence[FlagView]) -> np.ndarray:
    """Return all points (n, 2) [m] that a sheet must contain."""
    parts: List[np.ndarray] = [piece for way in ways for piece in way.pieces]
    parts.append(np.array([(flag.x_m, flag.y_m) for flag in flags], dtype=float).reshape(-1, 2))
    return np.vstack(parts)
