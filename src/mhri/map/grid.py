# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A grid map, as in ``nav_msgs/OccupancyGrid`` and in the files of map_server.

map_server itself is not packaged for Debian, one of the two supported systems.
"""
from dataclasses import dataclass
import math
import re
from typing import Callable, Optional, Sequence, Tuple, Union

import numpy as np

from mhri.base.config import parse_yaml, Section
from mhri.base.geometry import out_of, Pose
from mhri.base.plausible import can_be, PLACE

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
# Cells from this value on count as occupied, as in map_server.
TAKEN_FROM = 65
MAX_CELLS = 40_000_000
# The magic number, then width and height after whitespace and comments.
_PNM = re.compile(rb'P[1-6](?:\s+|#[^\n]*\n)+(\d{1,9})(?:\s+|#[^\n]*\n)+(\d{1,9})')
TRINARY, SCALE, RAW = 'trinary', 'scale', 'raw'


class GridError(ValueError):
    """An impossible map; the message names the reason."""


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
        """Return the centres of the occupied cells: (n, 2) in the map's frame [m]."""
        rows, columns = np.nonzero(self.cells >= TAKEN_FROM)
        return out_of(self.origin, (np.column_stack((columns, rows)) + 0.5) * self.resolution_m)


def size_problem(resolution_m: float, origin: Pose, width: int, height: int) -> Optional[str]:
    """Return why a map of this size is impossible, None if it is possible.

    :param width: cells in a row
    :param height: rows
    """
    if not (math.isfinite(resolution_m) and 1e-4 <= resolution_m <= 1e3):
        return 'cells of {:.3g} m'.format(resolution_m)
    if not (origin.is_finite() and can_be(PLACE, origin.x_m) and can_be(PLACE, origin.y_m)):
        return 'a corner at x {:.3g}, y {:.3g}, turned by {:.3g}'.format(
            origin.x_m, origin.y_m, origin.heading_rad)
    if width < 1 or height < 1 or width * height > MAX_CELLS:
        return '{} x {} cells: expected 1 to {} of them'.format(width, height, MAX_CELLS)
    return None


def grid_of(resolution_m: float, origin: Pose, width: int, height: int,
            data: Union[bytes, Sequence[int], np.ndarray]) -> Grid:
    """Return the :class:`Grid` of a message's fields.

    :param data: one value per cell, row by row from the bottom, or their bytes; invalid occupancies
        count as unknown
    :raises GridError: they are inconsistent, or the size is impossible
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

    Unknown keys are ignored, as in map_server, since other programs add their own.

    :param text: the file's text
    :param origin: its name, for errors
    :param load_image: function from the name of the picture in it to an array of 8 or 16
        bits, (height, width) or (height, width, channels) with the alpha last, None if it is
        unreadable
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
    """Return (width, height) from the first 1,000 bytes of a PNG, PNM or BMP, None for others."""
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
    """Return the cells of a picture, the top row first, as in map_server's image_loader."""
    colours, clear = picture, np.zeros(picture.shape[:2], dtype=bool)
    if picture.ndim == 3:
        if picture.shape[2] in (2, 4):
            clear = picture[:, :, -1] == 0
            # In trinary mode alpha counts as a colour, as in map_server.
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
