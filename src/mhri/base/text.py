# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes foreign texts safe to display: short, on one line, without direction marks."""
import math
import re
from typing import Iterable, Tuple

MAX_CHARACTERS = 200
MAX_NAMES = 64
_MORE = '...'
_MINUS = '\u2212'
_NUMBER = re.compile('[+-]?([0-9]+[.,]?[0-9]*|[.,][0-9]+)')


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


def typed_number(text: str, least: float = -math.inf, greatest: float = math.inf) -> float:
    """Parse a typed number, in the same way on a computer of any language.

    Point and comma are both the decimal sign: a language in which one of them groups digits would
    make 15 of 1.5.

    :raises ValueError: it is no number, e.g. has a sign between groups of digits, or is out of
        bounds; the message quotes it and says what is expected
    """
    plain, quoted = text.strip().replace(_MINUS, '-'), tidy_text(text.strip(), 40)
    if not _NUMBER.fullmatch(plain):
        raise ValueError("'{}' is not a number: write it like 1.5, with nothing between groups of "
                         'digits'.format(quoted))
    value = float(plain.replace(',', '.'))
    if not least <= value <= greatest:
        raise ValueError('{} is out of bounds: from {:g} to {:g}'.format(quoted, least, greatest))
    return value


def shown_number(value: float, decimals: int = 0) -> str:
    """Return a number with a decimal point and up to six decimals, at least this many."""
    whole, _, fraction = '{:.6f}'.format(value).partition('.')
    fraction = fraction.rstrip('0').ljust(decimals, '0')
    return whole + '.' * bool(fraction) + fraction
