# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The colour and the shape of each robot by its number, the same wherever a robot is drawn.

The colours are those of nobody's state (:mod:`mhri.base.gui.theme`). Twelve colours cannot all be
told apart with every kind of colour vision: of those that look alike, each has another shape, and
the number is printed as well.
"""
from typing import Tuple

# (on a light ground, on a dark one)
COLOURS: Tuple[Tuple[str, str], ...] = (
    ('#495A00', '#E9C428'), ('#6D38BA', '#A589C9'), ('#4D4B84', '#D5F6EF'),
    ('#773457', '#FCD1F0'), ('#864E31', '#E9AF9C'), ('#153774', '#91CEFD'),
    ('#50695F', '#A1C087'), ('#A20F78', '#FE7FFF'), ('#3733DD', '#7F8CFF'),
    ('#1C4200', '#A3EC95'), ('#4A2552', '#A6ACBB'), ('#533D2B', '#899D56'))
DISC, SQUARE, PENTAGON = 'disc', 'square', 'pentagon'
SHAPES = (DISC, SQUARE, PENTAGON)


def colour_of(number: int, dark: bool) -> str:
    """Return the colour "#RRGGBB" of a robot.

    :param number: from 1; 0 for a robot without one
    :param dark: whether the ground is dark
    """
    return COLOURS[max(0, number - 1) % len(COLOURS)][dark]


def shape_of(number: int) -> str:
    """Return the shape of a robot's mark; robots of one colour have different shapes."""
    place = max(0, number - 1)
    return SHAPES[(place + place // len(COLOURS)) % len(SHAPES)]
