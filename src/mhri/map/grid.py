# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A map of cells, as ``nav_msgs/OccupancyGrid`` and the files of map_server have it."""
from dataclasses import dataclass
import math
import re
from typing import Callable, Optional, Sequence, Tuple, Union

import numpy as np

from mhri.base.config import parse_yaml, Section
from mhri.base.mocap import Pose
from mhri.base.plausible import can_be, PLACE

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
# From here on a cell counts as something that stands there; map_server's own threshold.
TAKEN_FROM = 65
MOST_CELLS = 40_000_000
# The kind, and two numbers behind spaces and comments.
_PNM = re.compile(rb'P[1-6](?:\s+|#[^\n]*\n)+(\d{1,9})(?:\s+|#[^\n]*\n)+(\d{1,9})')
TRINARY, SCALE, RAW = 'trinary', 'scale', 'raw'


class GridError(ValueError):
    """A map that cannot be; the message says why."""


@dataclass(frozen=True)
class Grid:
    """Cells in [0, 100], -1 for unknown; ``origin`` is the lower left corner in the map's frame.

    ``cells`` is an int8 array (height, width), row 0 at the bottom: [row, column] is y, x.
    """

    resolution_m: float
    origin: Pose
    cells: np.ndarray

    @property
    def size_m(self) -> Tuple[float, float]:
        """Return its width and height [m]."""
        height, width = self.cells.shape
        return (width * self.resolution_m, height * self.resolution_m)

    def taken(self) -> np.ndarray:
        """Return the middles of the cells where something stands: (n, 2) in the map's frame [m]."""
        rows, columns = np.nonzero(self.cells >= TAKEN_FROM)
        x, y = (np.stack((columns, rows)) + 0.5) * self.resolution_m
        cos, sin = math.cos(self.origin.heading_rad), math.sin(self.origin.heading_rad)
        return np.column_stack((self.origin.x_m + cos * x - sin * y,
                                self.origin.y_m + sin * x + cos * y))


def size_problem(resolution_m: float, origin: Pose, width: int, height: int) -> Optional[str]:
    """Return why a map of this size cannot be, None if it can.

    :param width: cells in a row
    :param height: rows
    """
    if not (math.isfinite(resolution_m) and 1e-4 <= resolution_m <= 1e3):
        return 'cells of {:.3g} m'.format(resolution_m)
    if not (origin.is_finite() and can_be(PLACE, origin.x_m) and can_be(PLACE, origin.y_m)):
        return 'a corner at x {:.3g}, y {:.3g}, turned by {:.3g}'.format(
            origin.x_m, origin.y_m, origin.heading_rad)
    if width < 1 or height < 1 or width * height > MOST_CELLS:
        return '{} x {} cells: expected 1 to {} of them'.format(width, height, MOST_CELLS)
    return None


def grid_of(resolution_m: float, origin: Pose, width: int, height: int,
            data: Union[bytes, Sequence[int], np.ndarray]) -> Grid:
    """Return the :class:`Grid` of a message's fields.

    :param data: one value for each cell, row by row from the bottom, or their bytes; what is no
        occupancy counts as unknown
    :raises GridError: they do not fit together, or no map is of this size
    """
    problem = size_problem(resolution_m, origin, width, height)
    if problem:
        raise GridError(problem)
    if len(data) != width * height:
        raise GridError('{} values for {} x {} cells'.format(len(data), width, height))
    values = np.frombuffer(data, dtype=np.int8) if isinstance(data, bytes) \
        else np.asarray(data).astype(np.int8)
    known = (values >= FREE) & (values <= OCCUPIED)
    return Grid(resolution_m, origin, np.where(known, values, UNKNOWN).astype(
        np.int8).reshape(height, width))


def read_map(text: str, origin: str, load_image: Callable[[str], Optional[np.ndarray]]) -> Grid:
    """Return the :class:`Grid` of a YAML file of map_server (http://wiki.ros.org/map_server).

    Keys that nobody knows are ignored, as map_server does: other programs write some.

    :param text: the file's text
    :param origin: its name, for errors
    :param load_image: function from the name of the picture in it to an array of 8 or 16
        bits, (height, width) or (height, width, channels) with the alpha last, None where it cannot
        be read
    :raises ConfigError: names the file, the key and the remedy
    """
    section = parse_yaml(text, origin)
    image, resolution_m = section.text('image'), section.number('resolution', 1e-4, 1e3)
    corner = _corner(section)
    taken = section.number('occupied_thresh', 0.0, 1.0)
    free = section.number('free_thresh', 0.0, 1.0)
    mode, negate = section.text('mode', TRINARY), _negate(section)
    if mode not in (TRINARY, SCALE, RAW):
        raise section.error('mode', 'expected {}, {} or {}'.format(TRINARY, SCALE, RAW))
    if not free < taken:
        raise section.error('free_thresh', 'expected less than occupied_thresh')
    picture = load_image(image)
    if picture is not None and picture.dtype == np.uint16:
        # As map_server's SDL_image does.
        picture = (picture >> 8).astype(np.uint8)
    if picture is None or picture.dtype != np.uint8 or picture.ndim not in (2, 3):
        raise section.error('image', '{!r} cannot be read as a picture'.format(image[:60]))
    problem = size_problem(resolution_m, corner, picture.shape[1], picture.shape[0])
    if problem:
        raise section.error('image', problem)
    cells = _cells(picture, negate, mode, taken, free)
    return Grid(resolution_m, corner, np.ascontiguousarray(cells[::-1]))


def picture_size(head: bytes) -> Optional[Tuple[int, int]]:
    """Return (width, height) as the first 1,000 bytes of a PNG, PNM or BMP say, None for others."""
    if head.startswith(b'\x89PNG\r\n\x1a\n') and len(head) >= 24:
        return (int.from_bytes(head[16:20], 'big'), int.from_bytes(head[20:24], 'big'))
    if head.startswith(b'BM') and len(head) >= 26:
        return (int.from_bytes(head[18:22], 'little'),
                abs(int.from_bytes(head[22:26], 'little', signed=True)))
    found = _PNM.match(head)
    return (int(found.group(1)), int(found.group(2))) if found else None


def _corner(section: Section) -> Pose:
    row = section.take('origin')
    if not (isinstance(row, list) and len(row) == 3 and all(
            type(value) in (int, float) and math.isfinite(value) for value in row)):
        raise section.error('origin', 'expected [x, y, yaw] of the lower left corner [m, m, rad]')
    return Pose(*map(float, row))


def _negate(section: Section) -> bool:
    """Return the key ``negate``: 0 or 1, as map_server writes it, or a flag."""
    value = section.take('negate', 0)
    if value not in (0, 1):
        raise section.error('negate', 'expected 0 or 1')
    return bool(value)


def _cells(picture: np.ndarray, negate: bool, mode: str, taken: float,
           free: float) -> np.ndarray:
    """Return the cells of a picture, the top row first, as map_server's image_loader has them."""
    colours, clear = picture, np.zeros(picture.shape[:2], dtype=bool)
    if picture.ndim == 3:
        if picture.shape[2] in (2, 4):
            clear = picture[:, :, -1] == 0
            # With its alpha counted as a colour in trinary mode, as map_server does.
            colours = picture if mode == TRINARY else picture[:, :, :-1]
        colours = colours.mean(axis=2)
    shade = 255.0 - colours if negate else colours.astype(np.float32)
    if mode == RAW:
        return np.where(shade <= OCCUPIED, shade, UNKNOWN).astype(np.int8)
    occupancy = (255.0 - shade) / 255.0
    between = np.full(occupancy.shape, UNKNOWN, dtype=np.float32)
    if mode == SCALE:
        between = np.where(clear, UNKNOWN, 1.0 + 98.0 * (occupancy - free) / (taken - free))
    return np.where(occupancy > taken, OCCUPIED,
                    np.where(occupancy < free, FREE, between)).astype(np.int8)
