# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the words of flags go, so that none lie over others."""
from typing import Callable, Iterator, List, Sequence, Tuple


def place_labels(flags: Sequence[Tuple[float, float, str]], width_of: Callable[[str], float],
                 height_px: float, cloth_px: float, room_px: float) -> List[Tuple[float, str]]:
    """Return (left edge [px], text) of the words of each flag.

    Words are right of the flag, else left of it; if both are taken by words of newer flags, only
    the first word, the number, is right of it, else there is none.

    :param flags: (x [px], y [px], words), the newest last
    :param width_of: returns the width of a text [px]
    :param height_px: height of a line
    :param cloth_px: width of a flag with the gap beside it
    :param room_px: width of the picture, which words do not leave
    """
    taken: List[Tuple[float, float, float]] = []
    found: List[Tuple[float, str]] = []

    def places(x_px: float, words: str) -> Iterator[Tuple[float, str]]:
        for text in (words, words.partition(' ')[0]):
            width = width_of(text)
            for left in (x_px + cloth_px, x_px - width - cloth_px / 3.0):
                if 0.0 <= left and left + width < room_px:
                    yield left, text

    for x_px, y_px, words in reversed(flags):
        for left, text in places(x_px, words):
            end = left + width_of(text)
            if not any(left < other_end and begin < end and abs(low - y_px) < height_px
                       for begin, other_end, low in taken):
                taken.append((left, end, y_px))
                found.append((left, text))
                break
        else:
            found.append((x_px, ''))
    return found[::-1]
