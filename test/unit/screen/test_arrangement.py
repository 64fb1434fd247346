# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the tiles go: each in its place for good, not over each other, and nothing left empty."""
import itertools

import pytest

from mhri.screen.arrangement import (
    ALIKE, arrange, AUTO, Box, choose_inset, choose_large, covered, CUT_LARGE, CUT_SMALL,
    MAP_PX, MAP_TO_FILL, MAX_EMPTY, NO_MAP, ONE, WITH_MAP)

SCREENS = ((1024, 600), (1280, 720), (1366, 768), (1920, 1080), (2560, 1440), (3840, 2160))
# Heights of the foot and widths of the drawer, at most, at the usual font and at twice the font.
FOOT_PX, DRAWER_PX = {1: 93, 2: 166}, {1: 400, 2: 660}
NAMES = tuple('bot{}'.format(number) for number in range(1, 7))
LEAST, GAP = (162, 117), 4


def stages(font=1):
    """Yield (width, height, which map) of the stage of each screen, drawer open and closed."""
    for (width, height), is_open in itertools.product(SCREENS, (False, True)):
        drawer = min(DRAWER_PX[font], max(400, round(0.4 * width)))
        yield (width - is_open * drawer, height - FOOT_PX[font],
               WITH_MAP if width >= 1600 else MAP_TO_FILL)


def arranged(width, height, the_map, large, count, shape, font=1):
    """Return the arrangement of so many robots, some of them large."""
    return arrange(width, height, large, 0 if large == count else count, shape,
                   tuple(font * length for length in LEAST), GAP, the_map)


def overlap(one, other):
    return one.x < other.x + other.width and other.x < one.x + one.width and \
        one.y < other.y + other.height and other.y < one.y + one.height


def boxes_of(found):
    return found.large + found.cells + ((found.the_map,) if found.the_map else ())


def empty_share(found, shape, width, height):
    """Return the share of the stage in a box and without a picture."""
    empty = sum(box.width * box.height - covered(box.width, box.height, shape, cut)
                for boxes, cut in ((found.large, CUT_LARGE), (found.cells, CUT_SMALL))
                for box in boxes)
    return empty / (width * height)


@pytest.mark.parametrize('shape', [4 / 3, 16 / 9])
@pytest.mark.parametrize('stage', list(stages()))
def test_nothing_is_left_empty_and_nothing_overlaps(stage, shape):
    width, height, the_map = stage
    for count in range(1, 13):
        for large in range(1, min(count, 4) + 1):
            found, boxes = arranged(*stage, large, count, shape), None
            boxes = boxes_of(found)
            assert (len(found.large), len(found.cells)) == (large, 0 if large == count else count)
            for box in boxes:
                assert box.x >= 0 and box.y >= 0 and box.width > 0 and box.height > 0
                assert box.x + box.width <= width and box.y + box.height <= height
            assert not any(overlap(*pair) for pair in itertools.combinations(boxes, 2))
            assert empty_share(found, shape, width, height) <= MAX_EMPTY, (count, large)
            # What is in no box are the gaps.
            outside = width * height - sum(box.width * box.height for box in boxes)
            assert outside <= 2 * GAP * len(boxes) * max(width, height), (count, large)


@pytest.mark.parametrize('stage, screen_px', [
    (stage, width * height) for stage, (width, height) in zip(
        stages(2), (size for size in SCREENS for _ in range(2)))])
def test_with_letters_twice_as_large_nothing_is_empty_and_the_picture_is_large(stage, screen_px):
    width, height, _ = stage
    for count, shape in itertools.product((1, 3, 6, 12), (4 / 3, 16 / 9)):
        found = arranged(*stage, 1, count, shape, font=2)
        boxes = boxes_of(found)
        assert empty_share(found, shape, width, height) * width * height <= MAX_EMPTY * screen_px
        assert not any(overlap(*pair) for pair in itertools.combinations(boxes, 2))
        box = found.large[0]
        assert box.width * box.height >= 0.2 * width * height, (count, shape)
        assert box.height >= max(cell.height for cell in found.cells or (box,))


@pytest.mark.parametrize('stage', list(stages()))
def test_the_map_is_there_on_a_wide_screen_and_never_too_small(stage):
    for count, shape in itertools.product(range(1, 13), (4 / 3, 16 / 9)):
        the_map = arranged(*stage, 1, count, shape).the_map
        assert the_map is not None or stage[2] != WITH_MAP, count
        assert the_map is None or (the_map.width >= MAP_PX[0] and the_map.height >= MAP_PX[1])
        # A strip that is wide and flat shows nothing of a building.
        assert stage[2] != WITH_MAP or shape != 4 / 3 or min(the_map.width, the_map.height) >= 300
        assert arranged(*stage[:2], NO_MAP, 1, count, shape).the_map is None


@pytest.mark.parametrize('size, count, share', [
    ((1440, 1080), 1, 0.99), ((1024, 507), 1, 0.64), ((1024, 507), 3, 0.60), ((880, 627), 3, 0.50),
    ((1280, 627), 6, 0.60), ((1280, 627), 12, 0.50), ((1920, 987), 1, 0.65),
    ((1920, 987), 3, 0.60), ((1920, 987), 12, 0.60), ((3840, 2067), 12, 0.65)])
def test_most_of_it_is_the_large_picture(size, count, share):
    box = arranged(*size, MAP_TO_FILL if size[0] < 1600 else WITH_MAP, 1, count, 4 / 3).large[0]
    assert covered(box.width, box.height, 4 / 3) >= share * size[0] * size[1]


@pytest.mark.parametrize('stage', list(stages()))
def test_a_cell_has_room_for_a_name(stage):
    for count in range(2, 13):
        for box in arranged(*stage, 1, count, 4 / 3).cells:
            assert box.width >= 0.5 * LEAST[0] and box.height >= 0.5 * LEAST[1], count


def test_cells_are_in_order_along_the_strip():
    for count in range(2, 13):
        cells = arranged(1280, 627, NO_MAP, 1, count, 4 / 3).cells
        assert list(cells) == sorted(cells, key=lambda box: (box.x, box.y)) or \
            list(cells) == sorted(cells, key=lambda box: (box.y, box.x))


@pytest.mark.parametrize('size', [(1024, 490), (794, 500), (900, 720), (1920, 1010), (3840, 2060)])
@pytest.mark.parametrize('large, cells', [(12, 0), (3, 0), (1, 24), (4, 40)])
def test_more_robots_than_usual_do_not_overlap_either(size, large, cells):
    found = arrange(*size, large, cells, 0.7, LEAST, GAP, NO_MAP)
    assert (len(found.large), len(found.cells)) == (large, cells)
    assert not any(overlap(*pair) for pair in itertools.combinations(boxes_of(found), 2))


@pytest.mark.parametrize('box, shape, cut, area', [
    ((400, 300), 4 / 3, 0.0, 120000), ((500, 300), 4 / 3, 0.0, 120000),
    ((440, 300), 4 / 3, 0.1, 132000), ((400, 400), 4 / 3, 0.1, 400 * 300 / 0.9),
    ((900, 300), 4 / 3, 0.2, 300 * 400 / 0.8)])
def test_how_much_of_a_box_a_picture_covers(box, shape, cut, area):
    assert covered(*box, shape, cut) == pytest.approx(area)


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


@pytest.mark.parametrize('driven, large, expected', [
    ((), ('bot1',), ''), (('bot1',), ('bot1',), ''), (('bot1',), ('bot3',), 'bot1'),
    (('bot4', 'bot2'), ('bot5',), 'bot2'), (('bot4', 'bot2'), ('bot4',), ''),
    (('bot2',), (), 'bot2'), (('gone',), ('bot1',), '')])
def test_a_driven_picture_is_inset_while_none_is_large(driven, large, expected):
    assert choose_inset(NAMES, driven, large) == expected


def test_without_robots_nothing_is():
    assert choose_large((), (), 'bot1') == ()
    found = arrange(0, 0, 0, 0, 4 / 3, (1, 1), 4)
    assert found.large == found.cells == () and found.room == Box(0, 0, 1, 1)
