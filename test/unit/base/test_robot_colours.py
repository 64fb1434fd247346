# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The colours of robots: everybody tells them apart, by colour or by colour and shape."""
from itertools import combinations

import pytest
from support.sight import apart, SIGHTS

from mhri.base.robot_colours import colour_of, COLOURS, shape_of


@pytest.mark.parametrize('dark', [True, False])
@pytest.mark.parametrize('sight', SIGHTS)
def test_twelve_robots_are_told_apart(sight, dark):
    least = {True: 100.0, False: 100.0}
    for one, other in combinations(range(1, 13), 2):
        same = shape_of(one) == shape_of(other)
        least[same] = min(least[same], apart(
            colour_of(one, dark), colour_of(other, dark), sight))
    assert len(COLOURS) == 12
    if sight == 'usual':
        assert min(least.values()) > 9.0
    else:
        assert least[True] > 6.0 and least[False] > 3.0


def test_robots_of_one_colour_have_different_shapes():
    for number in range(1, 25):
        assert colour_of(number, True) == colour_of(number + 12, True)
        assert shape_of(number) != shape_of(number + 12)
    assert colour_of(0, True) == colour_of(1, True) and shape_of(0) == shape_of(1)
