# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The figures of a link as the host's side tells them, e.g. "round_trip:0.412 loss:0.2"."""
from dataclasses import dataclass
import math
from typing import List

FIGURES = 'mhri_link/figures'
# Where the host's side says how far it is, and how that begins.
FETCHING, FETCHING_WORD = 'mhri_link/fetching', 'fetching'
# They come once a second; older ones count for nothing [s].
FIGURES_S = 3.0
_MOST_LETTERS = 200


@dataclass(frozen=True)
class RadioFigures:
    """What a link measures; NaN where nobody knows.

    :param round_trip: [s]
    :param loss: of what comes from the robot, the share that does not, from 0 to 1
    :param bears: what the radio bears [bytes/s]; infinite while it bears everything
    :param picture_hz: how often a picture comes while it does not; NaN while none is asked for
    """

    round_trip: float = math.nan
    loss: float = math.nan
    bears: float = math.inf
    picture_hz: float = math.nan


def figures_words(figures: RadioFigures) -> str:
    """Return them as one line; what nobody knows is left out."""
    rows = (('round_trip', figures.round_trip, 4), ('loss', figures.loss, 3),
            ('bears', figures.bears, 0), ('picture_hz', figures.picture_hz, 2))
    return ' '.join('{}:{}'.format(key, round(value, digits)) for key, value, digits in rows
                    if math.isfinite(value))


def read_figures(text: str) -> RadioFigures:
    """Return what a line says; what cannot be read, or cannot be, counts as not said."""
    found = {'round_trip': math.nan, 'loss': math.nan, 'bears': math.inf, 'picture_hz': math.nan}
    for word in text[:_MOST_LETTERS].split():
        key, _, value = word.partition(':')
        try:
            number = float(value)
        except ValueError:
            continue
        if key in found and 0.0 <= number < math.inf:
            found[key] = number
    return RadioFigures(**found)


def thinned_words(figures: RadioFigures) -> List[str]:
    """Return what an operator should know of a radio that does not bear all, else []."""
    if math.isinf(figures.bears):
        return []
    bears = 'the radio bears {:.1f} Mbit/s'.format(max(0.1, 8e-6 * figures.bears))
    if math.isnan(figures.picture_hz):
        return ['{} only'.format(bears)]
    return ['{}: {}'.format(picture_words(figures.picture_hz), bears)]


def picture_words(rate_hz: float) -> str:
    """Return how often a picture comes, e.g. "picture 1 in 2 s"."""
    if rate_hz < 0.1:
        return 'no picture'
    if rate_hz < 0.95:
        return 'picture 1 in {:.0f} s'.format(max(2.0, 1.0 / rate_hz))
    return 'picture {:.0f} a second'.format(rate_hz)
