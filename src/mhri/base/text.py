# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes foreign texts safe to display: short, on one line, without direction marks."""
from typing import Iterable, Tuple

MAX_CHARACTERS = 200
MAX_NAMES = 64
_MORE = '...'


def tidy_text(text: str, most: int = MAX_CHARACTERS) -> str:
    """Return a text with at most this many characters, all of them printable.

    Line breaks, control characters and direction marks become spaces. A cut text ends in "...". The
    result is plain text: do not show it as HTML.

    :param text: of any length
    :param most: at least 4
    """
    begun = ''.join(sign if sign.isprintable() else ' ' for sign in text[:most])
    return begun if len(text) <= most else begun[:most - len(_MORE)] + _MORE


def tidy_names(names: Iterable[str], most: int = MAX_NAMES) -> Tuple[str, ...]:
    """Return the first names, each through :func:`tidy_text`."""
    return tuple(tidy_text(name) for name, _ in zip(names, range(most)))


def listed(names: Iterable[str], most: int = 4) -> str:
    """Return names as a text: 'a, b and 3 more'; '' for none."""
    names = list(names)
    if len(names) <= most:
        return ', '.join(names)
    return '{} and {} more'.format(', '.join(names[:most]), len(names) - most)
