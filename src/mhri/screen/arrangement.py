# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the tiles go: pictures as large as possible, and none over another.

Tiles are large (what the operator drives by) or small (the rest, a strip beside or below). Every
way of placing them is tried: the large ones as large as they can be, the small ones of use.
"""
from collections import Counter
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, sqrt
from typing import Dict, Iterator, Sequence, Tuple

# How many pictures there are of each shape (width by height).
Kinds = Dict[float, int]

# Fractions of the stage that the strip of small tiles may have.
_STRIP_SHARES = tuple(share / 100.0 for share in range(10, 52, 2))
# A small picture is of use up to this part of the width of a large one; till there, a pixel of its
# width counts so much.
_SMALL_ENOUGH = 0.26
_SMALL_COUNTS = 1.3
# With room to spare it becomes larger, up to this part of the area of a large one: still smaller at
# a glance.
_SMALL_AT_MOST = 0.72
# So much more has to be seen in another arrangement before the tiles move.
WORTH_MOVING = 1.06
# Shape (width / height) of a picture that has not arrived yet.
USUAL_SHAPE = 4.0 / 3.0
_GROUP_AT_MOST = 4
# In the place of a number of columns: one of three beside the two others, so that no cell is empty.
_BESIDE = 0

AUTO, ONE, ALIKE = 'auto', 'one', 'alike'


@dataclass(frozen=True)
class Box:
    """A rectangle on the stage, in pixels."""

    x: int
    y: int
    width: int
    height: int

    def picture(self, shape: float) -> float:
        """Return the area [px²] that a picture of this shape (width by height) has in it."""
        height = min(self.height, self.width / shape)
        return height * height * shape


@dataclass(frozen=True)
class Arrangement:
    """A box for each large and each small tile, in order, and the area of all pictures [px²]."""

    large: Tuple[Box, ...] = ()
    small: Tuple[Box, ...] = ()
    picture_px: float = 0.0


def choose_large(robots: Sequence[str], driven: Sequence[str], looked_at: str,
                 style: str = AUTO) -> Tuple[str, ...]:
    """Return the robots whose tiles are large, in the order of ``robots``.

    AUTO: a group of two to four that is driven together, else the robot looked at, else the one
    that is driven, else the first. ONE shows one alone, ALIKE all.

    :param driven: the robots that are checked
    :param looked_at: the robot that was chosen last, '' for none
    """
    if style == ALIKE:
        return tuple(robots)
    group = [name for name in robots if name in driven]
    if style == AUTO and 2 <= len(group) <= _GROUP_AT_MOST and looked_at in ('', *group):
        return tuple(group)
    for name in (looked_at, *group, *robots):
        if name in robots:
            return (name,)
    return ()


def _beside(box: Box, shapes: Sequence[float], gap: int) -> Tuple[Box, ...]:
    """Return boxes for three shapes: one at the left, two above each other."""
    height = (box.height - gap) // 2
    right = min(ceil(height * max(shapes[1:])), (box.width - gap) // 2)
    left = box.width - gap - right
    x = box.x + left + gap
    return (Box(box.x, box.y, left, box.height), Box(x, box.y, right, height),
            Box(x, box.y + height + gap, right, height))


def _grid(box: Box, shapes: Sequence[float], columns: int, gap: int,
          centred: bool = False) -> Tuple[Box, ...]:
    """Return a box for each shape, row by row, in this many columns, or :data:`_BESIDE`.

    :param centred: whether a last row that is not full is in the middle
    """
    if columns == _BESIDE:
        return _beside(box, shapes, gap)
    rows = ceil(len(shapes) / columns)
    width = (box.width - gap * (columns - 1)) // columns
    height = (box.height - gap * (rows - 1)) // rows
    spare = (columns * rows - len(shapes)) * (width + gap) // 2 if centred else 0
    return tuple(Box(box.x + index % columns * (width + gap) + (
        spare if index // columns == rows - 1 else 0), box.y + index // columns * (height + gap),
        width, height) for index in range(len(shapes)))


@lru_cache(maxsize=64)
def _columns(count: int) -> Tuple[int, ...]:
    """Return the numbers of columns worth trying: more with as many rows would only be narrower."""
    return tuple(sorted({ceil(count / rows) for rows in range(1, count + 1)}))


def _cell(box: Box, kinds: Kinds, columns: int, gap: int) -> Tuple[int, int, float]:
    """Return width and height of a box of such a grid, and the area of all its pictures [px²]."""
    rows = ceil(sum(kinds.values()) / columns)
    width = (box.width - gap * (columns - 1)) // columns
    height = (box.height - gap * (rows - 1)) // rows
    if min(width, height) < 1:
        return width, height, 0.0
    return width, height, sum(count * min(height, width / shape) ** 2 * shape
                              for shape, count in kinds.items())


def _worth(large_px: float, larges: int, small_px: float, smalls: int) -> float:
    """Return how good pictures of these areas [px²] are to drive by, in pixels of width."""
    large = sqrt(large_px / larges)
    return large + _SMALL_COUNTS * min(sqrt(small_px / smalls), _SMALL_ENOUGH * large)


def _best_columns(box: Box, shapes: Sequence[float], gap: int) -> Tuple[float, int]:
    """Return the area of the pictures in the grid that shows most of them, and its columns."""
    kinds = Counter(shapes)
    area, fewer = max((_cell(box, kinds, columns, gap)[2], -columns)
                      for columns in _columns(len(shapes)))
    if len(shapes) == 3 and min(box.width, box.height) > 2 * gap:
        other = sum(one.picture(shape) for one, shape in zip(_beside(box, shapes, gap), shapes))
        # Alike, they are compared at a glance: it has to be worth it.
        if other > WORTH_MOVING * area:
            return other, _BESIDE
    return area, -fewer


def _snug(boxes: Tuple[Box, ...], shapes: Sequence[float], gap: int, room: Box,
          least_px: int) -> Tuple[Box, ...]:
    """Return the boxes of a strip no larger than their pictures need, from its upper left.

    :param least_px: least width of one
    """
    rows = sorted({box.y for box in boxes})
    heights = [max(min(box.height, ceil(box.width / shape))
                   for box, shape in zip(boxes, shapes) if box.y == y) for y in rows]
    tops = [room.y + sum(heights[:row]) + gap * row for row in range(len(rows))]
    lefts = sorted({box.x for box in boxes})
    width = min(boxes[0].width, max(least_px, *(
        ceil(heights[rows.index(box.y)] * shape) for box, shape in zip(boxes, shapes))))
    return tuple(Box(room.x + lefts.index(box.x) * (width + gap), tops[rows.index(box.y)],
                     width, heights[rows.index(box.y)]) for box in boxes)


def _fitness(width: int, height: int, least: Tuple[int, int]) -> int:
    """Return how near to their least size boxes are: 6 if they have it, 0 for next to nothing."""
    return int(6.0 * min(1.0, width / least[0], height / least[1]))


def _splits(width: int, height: int, gap: int) -> Iterator[Tuple[Box, Box]]:
    """Yield (room of the large tiles, room of the strip): the strip at the right, then below."""
    for share in _STRIP_SHARES:
        strip = round(width * share)
        yield (Box(0, 0, width - strip - gap, height),
               Box(width - strip, 0, strip, height))
        strip = round(height * share)
        yield (Box(0, 0, width, height - strip - gap),
               Box(0, height - strip, width, strip))


def arrange(width: int, height: int, large: Sequence[float], small: Sequence[float],
            least: Tuple[int, int], gap: int) -> Arrangement:
    """Return where the tiles go.

    :param width: of the stage [px], like ``height``
    :param large: shape (width by height) of the picture of each large tile
    :param small: the same of each small one
    :param least: least width and height of a small tile [px]; kept if possible
    :param gap: between two tiles [px]
    """
    whole = Box(0, 0, max(1, width), max(1, height))
    return _arrange(whole, tuple(large), tuple(small), least, gap)


# It is asked for at each layout, and changes with a size or a shape alone.
@lru_cache(maxsize=32)
def _arrange(whole: Box, large: Tuple[float, ...], small: Tuple[float, ...],
             least: Tuple[int, int], gap: int) -> Arrangement:
    if not large and not small:
        return Arrangement()
    if not large or not small:
        shapes = large or small
        area, columns = _best_columns(whole, shapes, gap)
        boxes = _grid(whole, shapes, columns, gap, True)
        return Arrangement(boxes, (), area) if large else Arrangement((), boxes, area)
    best, best_score = None, (-1, -1.0, 0.0)
    smalls = Counter(small)
    for room, strip in _splits(whole.width, whole.height, gap):
        if min(room.width, room.height, strip.width, strip.height) < 1:
            continue
        large_px, large_columns = _best_columns(room, large, gap)
        for columns in _columns(len(small)):
            width, height, small_px = _cell(strip, smalls, columns, gap)
            if min(width, height) < 1:
                continue
            score = (_fitness(width, height, least),
                     _worth(large_px, len(large), small_px, len(small)),
                     min(small_px / len(small), _SMALL_AT_MOST * large_px / len(large)))
            if score > best_score:
                best_score = score
                best = (room, large_columns, strip, columns, large_px + small_px)
    if best is None:
        return Arrangement()
    room, large_columns, strip, columns, picture_px = best
    return Arrangement(_grid(room, large, large_columns, gap, True),
                       _snug(_grid(strip, small, columns, gap), small, gap, strip, least[0]),
                       picture_px)
