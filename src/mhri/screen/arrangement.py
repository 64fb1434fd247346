# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The arrangement of the stage: large pictures, a cell for each robot, the map; no room is left.

The cells are a strip beside or below the rest, the *room*, in which the large pictures lie. The map
is at the end of the strip, or beside or below the large pictures. The places depend on numbers
alone, not on which robots are large, so that looking at another robot moves nothing. All
arrangements are tried.
"""
from functools import lru_cache
from math import sqrt
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple

# Tried shares of the stage for the strip of cells.
_STRIP_SHARES = tuple(share / 100.0 for share in range(9, 62, 3))
# Share of its comfortable size that a cell has, and of the stage that the large pictures have,
# where there is room for it at all.
_FIT, _LARGE = 0.66, 0.4
# Maximum number of rows or columns of the strip.
_MAX_LINES = 4
# A cell and the map are useful up to this share of the width of a large picture; weights of a pixel
# of their width up to there.
_SMALL_ENOUGH, _SMALL_COUNTS, _MAP_COUNTS = 0.26, 1.3, 1.3
# Maximum share of a picture that is cut off to fill its box, large and in a cell.
CUT_LARGE, CUT_SMALL = 0.10, 0.28
#: maximum share of the screen without picture or map; the share of the stage that is aimed at,
#: as the gaps between boxes come to it; a difference that counts
MAX_EMPTY, _AIM_EMPTY, _EMPTY_STEP = 0.03, 0.018, 0.006
# Assumed shape (width / height) before the first picture.
USUAL_SHAPE = 4.0 / 3.0
_GROUP_AT_MOST = 4

AUTO, ONE, ALIKE = 'auto', 'one', 'alike'
#: the map: never, where room would be left, always
NO_MAP, MAP_TO_FILL, WITH_MAP = range(3)
# Its minimum size [px]; the share of its width that is better than black.
MAP_PX, _NARROW = (300, 150), 0.8


class Box(NamedTuple):
    """A rectangle on the stage, in pixels."""

    x: int
    y: int
    width: int
    height: int


def covered(width: float, height: float, shape: float, cut: float = 0.0) -> float:
    """Return the area [px²] that a picture covers of a box.

    :param shape: width / height of the picture
    :param cut: maximum share of the picture that is cut off to fill the box
    """
    high = min(height, width / shape / (1.0 - cut))
    return high * min(width, height * shape / (1.0 - cut))


class Arrangement(NamedTuple):
    """Boxes of the large pictures, of all cells, in order, of the map, and of the room."""

    large: Tuple[Box, ...] = ()
    cells: Tuple[Box, ...] = ()
    the_map: Optional[Box] = None
    room: Box = Box(0, 0, 0, 0)


def choose_large(robots: Sequence[str], driven: Sequence[str], looked_at: str,
                 style: str = AUTO) -> Tuple[str, ...]:
    """Return the robots whose tiles are large, in the order of ``robots``.

    AUTO: a driven group of two to four, else the robot in view, else the driven one, else the
    first. ONE: a single robot. ALIKE: all robots.

    :param driven: the selected robots
    :param looked_at: the robot chosen last, '' if none
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


def choose_inset(robots: Sequence[str], driven: Sequence[str], large: Sequence[str]) -> str:
    """Return the robot whose picture is inset into a large one, '' for none.

    That is the first driven one while no driven one is large: it is never out of sight.
    """
    group = [name for name in robots if name in driven]
    return group[0] if group and not any(name in large for name in group) else ''


class _Grid(NamedTuple):
    """Lines of boxes: columns from left to right, or rows from top to bottom.

    A line with fewer boxes is thicker, so that they fill their place at about one shape.
    """

    columns: bool
    counts: Tuple[int, ...]
    #: thickness of all lines, in lengths of the grid
    lines: float

    def sizes(self, place: Box, gap: int) -> Iterator[Tuple[int, float, float]]:
        """Yield (number, width, height) of the boxes of each line [px]."""
        across, along = (place.width, place.height) if self.columns else (
            place.height, place.width)
        across -= gap * (len(self.counts) - 1)
        for count in self.counts:
            thick, long = across / count / self.lines, (along - gap * (count - 1)) / count
            yield (count, thick, long) if self.columns else (count, long, thick)

    def boxes(self, place: Box, gap: int) -> Tuple[Box, ...]:
        """Return the boxes, line by line."""
        found = []
        across, along = (place.width, place.height) if self.columns else (
            place.height, place.width)
        for count, (begin, thick) in zip(self.counts, _ends(
                across, [1.0 / count for count in self.counts], gap)):
            for start, long in _ends(along, [1.0] * count, gap):
                found.append(Box(place.x + begin, place.y + start, thick, long) if self.columns
                             else Box(place.x + start, place.y + begin, long, thick))
        return tuple(found)

    def natural(self, room: Box, shape: float) -> Box:
        """Return the part of a room, from its upper left, that whole pictures fill."""
        if self.columns:
            return Box(room.x, room.y, min(
                room.width, round(room.height * shape * self.lines)), room.height)
        return Box(room.x, room.y, room.width, min(
            room.height, round(room.width / shape * self.lines)))


def _ends(length: int, parts: Sequence[float], gap: int) -> Iterator[Tuple[int, int]]:
    """Yield (begin, length) of each part of a length [px], in these proportions."""
    room, total, done, begin = length - gap * (len(parts) - 1), sum(parts), 0.0, 0
    for index, part in enumerate(parts):
        done += part
        end = round(room * done / total) + gap * index
        yield begin, end - begin
        begin = end + gap


@lru_cache(maxsize=64)
def _grids(count: int, most: int) -> Tuple[_Grid, ...]:
    """Return the grids to try for so many boxes, in at most so many lines."""
    counts = {tuple((count + line) // lines for line in range(lines))
              for lines in range(1, min(count, most) + 1)}
    return tuple(_Grid(columns, lines, sum(1.0 / line for line in lines))
                 for lines in sorted(counts) for columns in (True, False))


class _Filled(NamedTuple):
    """A place filled by a grid of pictures: the areas of whole pictures, and without one [px²]."""

    place: Box
    grid: Optional[_Grid]
    picture_px: float = 0.0
    empty_px: float = 0.0
    #: smallest width and height of a box [px]
    least: Tuple[float, float] = (0.0, 0.0)


def _filled(place: Box, grid: _Grid, shape: float, cut: float, gap: int) -> Optional[_Filled]:
    """Return how a grid fills a place; None if there is no room for it."""
    sizes = tuple(grid.sizes(place, gap))
    least = min(width for _, width, _ in sizes), min(height for _, _, height in sizes)
    if min(least) < 1.0:
        return None
    return _Filled(
        place, grid, sum(count * covered(width, height, shape) for count, width, height in sizes),
        sum(count * (width * height - covered(width, height, shape, cut))
            for count, width, height in sizes), least)


def _places(room: Box, grid: _Grid, shape: float, gap: int, the_map: int) -> Iterator[
        Tuple[Box, Optional[Box]]]:
    """Yield (place of the pictures, place of the map, beside or below them)."""
    least, natural = MAP_PX, grid.natural(room, shape)
    width = min(natural.width, room.width - gap - least[0])
    if the_map and width > 0 and room.height >= least[1]:
        yield (Box(room.x, room.y, width, room.height),
               Box(room.x + width + gap, room.y, room.width - width - gap, room.height))
    height = min(natural.height, room.height - gap - least[1])
    if the_map and height > 0 and room.width >= _NARROW * least[0]:
        yield (Box(room.x, room.y, room.width, height),
               Box(room.x, room.y + height + gap, room.width, room.height - height - gap))


def _rooms(room: Box, count: int, shape: float, gap: int, the_map: int) -> Iterator[
        Tuple[_Filled, Optional[Box]]]:
    """Yield all ways to fill the room with pictures and map."""
    cut = CUT_LARGE if count <= _GROUP_AT_MOST else CUT_SMALL
    for grid in _grids(count, count):
        places = list(_places(room, grid, shape, gap, the_map))
        for place, map_box in [(room, None), *places]:
            filled = _filled(place, grid, shape, cut, gap)
            if filled:
                yield filled, map_box


def _strips(whole: Box, count: int, shape: float, gap: int, the_map: int) -> Iterator[
        Tuple[Box, _Filled, Optional[Box]]]:
    """Yield (room, strip of cells, map at its end or None), the strip at the right and below."""
    if not count:
        yield whole, _Filled(Box(0, 0, 0, 0), None), None
        return
    width, height = whole.width, whole.height
    for share in _STRIP_SHARES:
        for grid in _grids(count, _MAX_LINES):
            size = round(share * (width if grid.columns else height))
            strip = Box(width - size, 0, size, height) if grid.columns else \
                Box(0, height - size, width, size)
            room = Box(0, 0, width - size - gap, height) if grid.columns else \
                Box(0, 0, width, height - size - gap)
            parts: List[Tuple[Box, Optional[Box]]] = [(strip, None)]
            if the_map:
                parts.append(_divided(strip, grid.columns, gap))
            for place, map_box in parts:
                filled = _filled(place, grid, shape, CUT_SMALL, gap)
                if filled and min(room.width, room.height) > 0:
                    yield room, filled, map_box


def _divided(strip: Box, columns: bool, gap: int) -> Tuple[Box, Optional[Box]]:
    """Return (place of the cells, place of the map or None if there is no room) of a strip."""
    x, y, width, height = strip
    if columns:
        size = max(MAP_PX[1], min(width, height // 2))
        if width < MAP_PX[0] or height - size - gap < 1:
            return strip, None
        return Box(x, y, width, height - size - gap), Box(x, y + height - size, width, size)
    size = max(MAP_PX[0], min(2 * height, width // 2))
    if height < MAP_PX[1] or width - size - gap < 1:
        return strip, None
    return Box(x, y, width - size - gap, height), Box(x + width - size, y, size, height)


def _worth(pictures: float, cell: float, fit: float, the_map: Optional[Box]) -> float:
    """Return the usefulness for driving, in pixels of width.

    :param pictures: width of a large picture [px], ``cell`` of one in a cell
    :param fit: share of its minimum size that a cell reaches, 1 at most
    """
    beside = min(the_map.width, the_map.height) if the_map else 0
    return pictures + _SMALL_COUNTS * min(cell, _SMALL_ENOUGH * pictures) * fit + \
        _MAP_COUNTS * min(beside, _SMALL_ENOUGH * pictures)


def arrange(width: int, height: int, large: int, cells: int, shape: float,
            least: Tuple[int, int], gap: int, the_map: int = NO_MAP) -> Arrangement:
    """Return the best arrangement: nothing empty, large pictures, useful cells.

    :param width: width of the stage [px], like ``height``
    :param large: number of large pictures
    :param cells: number of cells, 0 for no strip
    :param shape: width / height of most pictures
    :param least: comfortable width and height of a cell [px]; two thirds are kept if possible
    :param gap: gap between two tiles [px]
    :param the_map: NO_MAP, MAP_TO_FILL or WITH_MAP
    """
    return _arrange(Box(0, 0, max(1, width), max(1, height)), large, cells, shape, least, gap,
                    the_map)


# Cached, because each layout calls it, mostly with the same sizes and shapes.
@lru_cache(maxsize=32)
def _arrange(whole: Box, large: int, cells: int, shape: float, least: Tuple[int, int], gap: int,
             the_map: int) -> Arrangement:
    best, best_score, rooms = None, (-1000, 0.0, 0.0), {}
    area = float(whole.width * whole.height)
    for room, strip, at_end in _strips(whole, cells, shape, gap, the_map) if large else ():
        wanted = NO_MAP if at_end else the_map
        if (room, wanted) not in rooms:
            rooms[room, wanted] = list(_rooms(room, large, shape, gap, wanted))
        fit = min(1.0, strip.least[0] / least[0], strip.least[1] / least[1]) if cells else 1.0
        cell = sqrt(strip.picture_px / cells) if cells else 0.0
        for filled, beside in rooms[room, wanted]:
            empty = (filled.empty_px + strip.empty_px) / area
            map_box = at_end or beside
            # The map is missing only where too much would be empty with it.
            missing = 2 if the_map == WITH_MAP and not map_box else 0
            share = filled.picture_px / area
            score = (min(0, round((_AIM_EMPTY - empty) / _EMPTY_STEP)) - missing,
                     min(1.0, round(min(fit / _FIT, share / _LARGE), 1)),
                     _worth(sqrt(filled.picture_px / large), cell, fit,
                            map_box if the_map == WITH_MAP else None))
            if score > best_score:
                best_score, best = score, (filled, map_box, strip, room)
    if best is None:
        return Arrangement(room=whole)
    filled, map_box, strip, room = best
    larges, boxes = (part.grid.boxes(part.place, gap) if part.grid else ()
                     for part in (filled, strip))
    return Arrangement(larges, boxes, map_box, room)
