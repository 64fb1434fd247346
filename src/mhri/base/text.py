# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Texts from elsewhere, made fit for a screen: short, on one line, without direction marks."""
from typing import Iterable, Tuple

MOST_CHARACTERS = 200
MOST_NAMES = 64
_MORE = '...'


def tidy_text(text: str, most: int = MOST_CHARACTERS) -> str:
    """Return a text with at most this many characters, all of them printable.

    Line breaks, control characters and those that change the direction of writing become spaces. A
    cut text ends in "...". The result is plain text: do not show it as HTML.

    :param text: of any length
    :param most: at least 4
    """
    begun = ''.join(sign if sign.isprintable() else ' ' for sign in text[:most])
    return begun if len(text) <= most else begun[:most - len(_MORE)] + _MORE


def tidy_names(names: Iterable[str], most: int = MOST_NAMES) -> Tuple[str, ...]:
    """Return the first names, each made tidy by :func:`tidy_text`."""
    return tuple(tidy_text(name) for name, _ in zip(names, range(most)))
