# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the tiles go: in their room, not over each other, with as much picture as there can be."""
import itertools

import pytest

from mhri.screen.arrangement import ALIKE, arrange, AUTO, Box, choose_large, ONE

SIZES = ((1024, 490), (794, 500), (900, 720), (1440, 1080), (1920, 1010), (3840, 2060))
NAMES = tuple('bot{}'.format(number) for number in range(1, 7))


def overlap(one, other):
    return one.x < other.x + other.width and other.x < one.x + one.width and \
        one.y < other.y + other.height and other.y < one.y + one.height


@pytest.mark.parametrize('size', SIZES)
@pytest.mark.parametrize('large, small', [(0, 0), (1, 0), (0, 3), (1, 2), (2, 1), (4, 8), (1, 11),
                                          (1, 23), (12, 0), (3, 0), (3, 3), (3, 9)])
@pytest.mark.parametrize('shape', [4 / 3, 16 / 9, 0.7])
def test_every_tile_is_in_the_room_and_over_no_other(size, large, small, shape):
    found = arrange(*size, [shape] * large, [shape] * small, (150, 60), 4)
    boxes = found.large + found.small
    assert (len(found.large), len(found.small)) == (large, small)
    for box in boxes:
        assert box.x >= 0 and box.y >= 0 and box.width > 0 and box.height > 0
        assert box.x + box.width <= size[0] and box.y + box.height <= size[1]
    assert not any(overlap(*pair) for pair in itertools.combinations(boxes, 2))


@pytest.mark.parametrize('size, large, small, share', [
    ((1440, 1080), 1, 0, 0.99), ((1920, 1010), 1, 2, 0.80), ((1440, 1080), 1, 2, 0.70),
    ((1920, 1010), 2, 1, 0.60), ((1509, 1080), 2, 1, 0.70), ((1920, 1010), 1, 11, 0.70),
    ((960, 720), 1, 2, 0.65)])
def test_most_of_it_is_picture(size, large, small, share):
    found = arrange(*size, [4 / 3] * large, [4 / 3] * small, (150, 60), 4)
    assert found.picture_px >= share * size[0] * size[1]


@pytest.mark.parametrize('size', SIZES)
def test_a_group_of_three_leaves_no_cell_empty(size):
    first, second, third = arrange(*size, [4 / 3] * 3, [], (150, 60), 4).large
    if first.height == size[1]:  # One beside two, or three beside each other.
        assert first.picture(4 / 3) >= second.picture(4 / 3)
    elif first.width < size[0]:  # Two, and the third in the middle below.
        assert abs(third.x - (size[0] - third.x - third.width)) <= 1


def test_the_picture_of_a_group_of_three_is_larger_than_in_a_square_of_four():
    found = arrange(1440, 1080, [4 / 3] * 3, [], (150, 60), 4)
    assert found.picture_px == pytest.approx(
        sum(box.picture(4 / 3) for box in found.large), rel=1e-3)
    assert arrange(1500, 1000, [4 / 3] * 3, [], (150, 60), 4).picture_px > 3 * (
        Box(0, 0, 748, 498).picture(4 / 3))


def test_the_one_looked_at_is_much_larger_than_a_thumbnail():
    found = arrange(1920, 1010, [4 / 3], [4 / 3] * 11, (150, 60), 4)
    assert found.large[0].picture(4 / 3) > 8 * max(box.picture(4 / 3) for box in found.small)
    assert all(box.width >= 150 and box.height >= 60 for box in found.small)


@pytest.mark.parametrize('driven, looked_at, style, expected', [
    ((), '', AUTO, ('bot1',)),
    ((), 'bot3', AUTO, ('bot3',)),
    (('bot2',), '', AUTO, ('bot2',)),
    (('bot2',), 'bot3', AUTO, ('bot3',)),
    (('bot4', 'bot2'), '', AUTO, ('bot2', 'bot4')),
    (('bot4', 'bot2'), 'bot2', AUTO, ('bot2', 'bot4')),
    (('bot4', 'bot2'), 'bot5', AUTO, ('bot5',)),
    (NAMES[:5], 'bot2', AUTO, ('bot2',)),
    (('bot4', 'bot2'), 'bot2', ONE, ('bot2',)),
    (('bot2',), 'bot2', ALIKE, NAMES),
    (('gone',), 'gone', AUTO, ('bot1',))])
def test_whose_picture_is_large(driven, looked_at, style, expected):
    assert choose_large(NAMES, driven, looked_at, style) == expected


def test_without_robots_nothing_is():
    assert choose_large((), (), 'bot1') == ()
    assert arrange(0, 0, (), (), (1, 1), 4).large == ()
