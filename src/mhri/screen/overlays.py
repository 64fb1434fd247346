# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The places of a robot's views in its tile: one fills it, others lie over it.

The first visible view of the registry fills the tile. If that is a picture, the others lie over it,
each at the place in its row: in the upper right corner, or as a strip above the numbers. Their
sizes do not depend on the stick or the numbers, so that nothing moves when these change. A view
without room is not shown: :data:`MIN_PICTURE` of the tile always stay picture.
"""
from math import sqrt
from typing import Dict, Iterable, Optional, Tuple

from mhri.base.view_rows import CORNER, PICTURES, STRIP, VIEW_ROWS

# Minimum share of a tile for its picture, beside its edge, header and overlays.
MIN_PICTURE = 0.6
# Share of the shorter side of the tile for the corner; minimum [line heights].
_CORNER_SHARE, _MIN_CORNER_UNITS = 0.36, 5.0
# Its share of the room for overlays if there is a strip, too.
_CORNER_OF_BOTH = 0.5
# Share of the tile's height for the strip; usual and minimum height [line heights].
_STRIP_SHARE, _STRIP_UNITS, _MIN_STRIP_UNITS = 0.18, 5.0, 3.6
# Narrower strips have no room for a curve [line heights].
_MIN_STRIP_WIDTH_UNITS = 11.0
# The stick at the lower right, as the stage places it: share of the room, and its width, usual and
# minimum, and the height of its caption; height of the numbers at the lower left [line heights].
_STICK_SHARE, _STICK_UNITS, _CAPTION_UNITS, _NUMBERS_UNITS = 0.34, (9.0, 7.0), 1.4, 4.6
# Share of a robot without a picture for the strip.
_STRIP_OF_VIEWS = 0.4

Sizes = Dict[str, Tuple[int, int]]


def filling(shown: Iterable[str]) -> Optional[str]:
    """Return the view that fills the tile, None without a view."""
    keys = frozenset(shown)
    return next((row.key for row in VIEW_ROWS if row.key in keys), None)


def overlay_sizes(places: Iterable[str], tile: Tuple[int, int], header: int, edge: int,
                  unit: int) -> Sizes:
    """Return {place: (width, height)} [px] of the overlays that a picture has room for.

    :param places: CORNER, STRIP or both
    :param tile: width and height of the tile
    :param header: height of the header over its picture
    :param edge: width of the edge of the tile
    :param unit: height of a line
    """
    wanted = frozenset(places)
    width, height = tile[0] - 2 * edge, tile[1] - 2 * edge
    if width <= 0 or height <= 0:
        return {}
    spare = width * (height - header) - MIN_PICTURE * tile[0] * tile[1]
    stick, stick_high = (
        max((_STICK_UNITS[1] + caption) * unit,
            min((_STICK_UNITS[0] + caption) * unit, _STICK_SHARE * room))
        for room, caption in ((width, 0.0), (height - header, _CAPTION_UNITS)))
    found: Sizes = {}
    if CORNER in wanted:
        share = _CORNER_OF_BOTH if STRIP in wanted else 1.0
        side = int(min(_CORNER_SHARE * min(width, height), sqrt(max(0.0, share * spare)),
                       height - header - stick_high - 1.5 * unit))
        if side >= _MIN_CORNER_UNITS * unit:
            found[CORNER] = (side, side)
            spare -= side * side
    if STRIP in wanted:
        wide = int(width - stick - 1.5 * unit)
        below = found.get(CORNER, (0, 0))[1] + unit
        high = int(min(max(_STRIP_SHARE * height, _STRIP_UNITS * unit), spare / max(1, wide),
                       height - header - below - _NUMBERS_UNITS * unit))
        if high >= _MIN_STRIP_UNITS * unit and wide >= _MIN_STRIP_WIDTH_UNITS * unit:
            found[STRIP] = (wide, high)
    return found


def fitting(chosen: Iterable[str], tile: Tuple[int, int], header: int, edge: int,
            unit: int) -> Dict[str, str]:
    """Return {view: place} of the chosen views that a large tile has room for.

    The place of the one that fills the tile is ''. A place over a picture holds one view, the first
    of the registry. The parameters are those of :func:`overlay_sizes`.
    """
    keys = frozenset(chosen)
    full = filling(keys)
    rest = [row for row in VIEW_ROWS if row.key in keys and row.key != full]
    first = {row.overlay: row.key for row in reversed(rest)}
    if full in PICTURES:
        sizes = overlay_sizes(first, tile, header, edge, unit)
        first = {place: key for place, key in first.items() if place in sizes}
    found = {key: place for place, key in first.items() if place}
    return found if full is None else {full: '', **found}


def stacked(height: int) -> int:
    """Return the height of a strip below a view that is not a picture, out of both [px]."""
    return round(_STRIP_OF_VIEWS * height)
