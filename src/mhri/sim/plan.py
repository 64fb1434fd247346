# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The floor plan that all simulated robots share: walls, landmarks, start poses."""
from dataclasses import dataclass
import math
from typing import Tuple

import numpy as np

from mhri.base.config import parse_yaml

Colour = Tuple[int, int, int]


@dataclass(frozen=True)
class Landmark:
    """A coloured cylinder: centre, radius and height [m], colour (red, green, blue) 0 to 255.

    ``on_map`` is false for objects to be searched for.
    """

    name: str
    colour: Colour
    x_m: float
    y_m: float
    radius_m: float
    height_m: float
    on_map: bool = True


@dataclass(frozen=True)
class Plan:
    """Walls as an array (n, 4) of x1, y1, x2, y2 [m]; landmarks; start poses (x, y, yaw).

    Walls are thin and share one height [m] and colour; the floor has a colour, too. ``gas`` is the
    place of a leak of gas [m], () without one.
    """

    name: str
    walls: np.ndarray
    wall_height_m: float
    wall_colour: Colour
    floor_colour: Colour
    landmarks: Tuple[Landmark, ...]
    starts: Tuple[Tuple[float, float, float], ...]
    gas: Tuple[float, ...] = ()

    def discs(self, map_only=False):
        """Return the landmarks as an array (n, 3) of x, y, radius [m].

        :param map_only: those that are drawn on the map
        """
        return np.array([(item.x_m, item.y_m, item.radius_m) for item in self.landmarks
                         if item.on_map or not map_only], dtype=float).reshape(-1, 3)

    def distance(self, x, y):
        """Return the distance to the nearest wall or landmark [m], < 0 inside a landmark."""
        x1, y1, x2, y2 = self.walls.T
        ex, ey, px, py = x2 - x1, y2 - y1, x - x1, y - y1
        share = (px * ex + py * ey) / np.maximum(ex * ex + ey * ey, 1e-12)
        share = np.minimum(np.maximum(share, 0.0), 1.0)
        gap2 = (px - share * ex) ** 2 + (py - share * ey) ** 2
        return min(math.sqrt(gap2.min()), disc_distance(self.discs(), x, y))


def disc_distance(discs, x, y):
    """Return the distance to the nearest disc [m], < 0 inside one, inf without discs.

    :param discs: array (n, 3) of x, y, radius [m]
    """
    if not len(discs):
        return math.inf
    return float((np.hypot(discs[:, 0] - x, discs[:, 1] - y) - discs[:, 2]).min())


def read_colour(section, key):
    """Return the (red, green, blue) of a key, each an integer from 0 to 255.

    :raises ConfigError: it is not such a colour
    """
    row = section.take(key)
    if not (isinstance(row, list) and len(row) == 3 and all(
            type(value) is int and 0 <= value <= 255 for value in row)):
        raise section.error(key, 'expected red, green, blue from 0 to 255, got {!r}'.format(row))
    return tuple(row)


def _rows(section, key, value):
    """Return a value, which has to be a list with at least one item."""
    if not isinstance(value, list) or not value:
        raise section.error(key, 'expected a list, got {!r}'.format(value))
    return value


def _numbers(section, key, row, count):
    """Return a tuple of finite floats of a given length."""
    good = isinstance(row, list) and len(row) == count and all(
        type(value) in (int, float) and math.isfinite(value) for value in row)
    if not good:
        raise section.error(key, 'expected {} numbers, got {!r}'.format(count, row))
    return tuple(float(value) for value in row)


def _walls(section):
    """Return the polylines of the key ``walls`` as an array (n, 4) of single walls."""
    walls = []
    for line in _rows(section, 'walls', section.take('walls')):
        corners = [_numbers(section, 'walls', corner, 2)
                   for corner in _rows(section, 'walls', line)]
        if len(corners) < 2:
            raise section.error('walls', 'a wall needs two corners, got {!r}'.format(line))
        walls += [one + two for one, two in zip(corners, corners[1:])]
    return np.array(walls, dtype=float)


def _landmark(row):
    landmark = Landmark(
        row.text('name'), read_colour(row, 'colour'),
        row.number('x', -1000.0, 1000.0), row.number('y', -1000.0, 1000.0),
        row.number('radius', 0.01, 10.0), row.number('height', 0.01, 10.0),
        row.flag('on_map', True))
    row.close()
    return landmark


def parse_plan(text, origin):
    """Return the :class:`Plan` of a YAML text.

    :raises ConfigError: the text is invalid; the error names the file and the key
    """
    section = parse_yaml(text, origin)
    plan = Plan(
        name=section.text('name'), walls=_walls(section),
        wall_height_m=section.number('wall_height', 0.1, 100.0),
        wall_colour=read_colour(section, 'wall_colour'),
        floor_colour=read_colour(section, 'floor_colour'),
        landmarks=tuple(_landmark(row) for row in section.sections('landmarks')),
        starts=tuple(_numbers(section, 'starts', row, 3)
                     for row in _rows(section, 'starts', section.take('starts'))),
        gas=_numbers(section, 'gas', section.take('gas'), 2) if 'gas' in section else ())
    section.close()
    return plan
