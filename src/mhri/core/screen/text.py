# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Texts of others, made fit for a screen: short, of one line, without marks that reorder them."""
from typing import Iterable, Tuple

MOST_CHARACTERS = 200
MOST_NAMES = 64
_MORE = '...'


def tidy_text(text: str, most: int = MOST_CHARACTERS) -> str:
    """Return a text with at most so many characters, every one of which can be printed.

    A line break, a control character or one that turns the direction of writing becomes a space. A
    text that was cut ends in "...". It stays text: whoever shows it must not take it for HTML.

    :param text: of any length
    :param most: at least 4
    """
    begun = ''.join(sign if sign.isprintable() else ' ' for sign in text[:most])
    return begun if len(text) <= most else begun[:most - len(_MORE)] + _MORE


def tidy_names(names: Iterable[str], most: int = MOST_NAMES) -> Tuple[str, ...]:
    """Return the first of some names, each as :func:`tidy_text` has it."""
    return tuple(tidy_text(name) for name, _ in zip(names, range(most)))
