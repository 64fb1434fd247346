# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The figures of a link as its host side publishes them, e.g. "round_trip:0.412 loss:0.2"."""
from dataclasses import dataclass
import math
from typing import List

FIGURES = 'mhri_link/figures'
# Where the host side publishes the progress of fetching, and how that text begins.
FETCHING, FETCHING_WORD = 'mhri_link/fetching', 'fetching'
# Published once a second; older ones are ignored [s].
FIGURES_S = 3.0
_MAX_LETTERS = 200
# {field of RadioFigures: (its key in the line, digits)}; other programs read these keys.
_KEYS = {'round_trip': ('round_trip', 4), 'loss': ('loss', 3), 'carries': ('bears', 0),
         'picture_hz': ('picture_hz', 2)}


@dataclass(frozen=True)
class RadioFigures:
    """What a link measures; NaN for an unknown value.

    :param round_trip: [s]
    :param loss: share of the messages from the robot that are lost, from 0 to 1
    :param carries: capacity of the radio [bytes/s]; infinite while it carries everything
    :param picture_hz: rate of the pictures while it does not [Hz]; NaN while none is in view
    """

    round_trip: float = math.nan
    loss: float = math.nan
    carries: float = math.inf
    picture_hz: float = math.nan


def figures_words(figures: RadioFigures) -> str:
    """Return the figures as one line, without unknown ones."""
    rows = ((key, digits, getattr(figures, field)) for field, (key, digits) in _KEYS.items())
    return ' '.join('{}:{}'.format(key, round(value, digits)) for key, digits, value in rows
                    if math.isfinite(value))


def read_figures(text: str) -> RadioFigures:
    """Return the figures of a line; unreadable and impossible values stay unknown."""
    fields = {key: field for field, (key, _) in _KEYS.items()}
    found = {}
    for word in text[:_MAX_LETTERS].split():
        key, _, value = word.partition(':')
        try:
            number = float(value)
        except ValueError:
            continue
        if key in fields and 0.0 <= number < math.inf:
            found[fields[key]] = number
    return RadioFigures(**found)


def thinned_words(figures: RadioFigures) -> List[str]:
    """Return sentences for the operator about a radio that cannot carry everything, else []."""
    if math.isinf(figures.carries):
        return []
    carries = 'the radio carries {:.1f} Mbit/s'.format(max(0.1, 8e-6 * figures.carries))
    if math.isnan(figures.picture_hz):
        return ['{} only'.format(carries)]
    return ['{}: {}'.format(picture_words(figures.picture_hz), carries)]


def picture_words(rate_hz: float) -> str:
    """Return the rate of pictures in words, e.g. "picture 1 in 2 s"."""
    if rate_hz < 0.1:
        return 'no picture'
    if rate_hz < 0.95:
        return 'picture 1 in {:.0f} s'.format(max(2.0, 1.0 / rate_hz))
    return 'picture {:.0f} a second'.format(rate_hz)
