# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The places of views in a tile: the picture keeps its share, what has no room is not shown."""
import itertools

import pytest

from mhri.base.view_rows import CLOUD, CORNER, DEPTH, IMU, RGB, SCAN, STRIP
from mhri.screen.overlays import filling, fitting, MIN_PICTURE, overlay_sizes

EDGE, UNIT, HEADER = 4, 18, 44
ROOMY = (1200, 800)


@pytest.mark.parametrize('shown, expected', [
    ((), None), ((IMU,), IMU), ((IMU, SCAN), SCAN), ((IMU, SCAN, CLOUD), CLOUD),
    ((SCAN, DEPTH), DEPTH), ((RGB, IMU), RGB)])
def test_the_first_view_of_the_registry_fills_the_tile(shown, expected):
    assert filling(shown) == expected


@pytest.mark.parametrize('chosen, tile, expected', [
    ((RGB, SCAN, IMU), ROOMY, {RGB: '', SCAN: CORNER, IMU: STRIP}),
    ((CLOUD, SCAN), ROOMY, {CLOUD: '', SCAN: CORNER}),
    ((SCAN, IMU), ROOMY, {SCAN: '', IMU: STRIP}),
    ((IMU,), ROOMY, {IMU: ''}),
    ((), ROOMY, {}),
    ((RGB, SCAN, IMU), (260, 200), {RGB: ''}),
    ((SCAN, IMU), (260, 200), {SCAN: '', IMU: STRIP}),
    ((RGB, SCAN), (0, 0), {RGB: ''})])
def test_each_view_has_its_place(chosen, tile, expected):
    assert fitting(chosen, tile, HEADER, EDGE, UNIT) == expected


@pytest.mark.parametrize('unit', [14, 20, 40])
def test_overlays_leave_the_picture_its_share_and_do_not_meet(unit):
    header, seen = round(2.3 * unit), set()
    for width, height in itertools.product(range(100, 4000, 130), range(80, 2200, 90)):
        sizes = overlay_sizes((CORNER, STRIP), (width, height), header, EDGE, unit)
        seen.add(frozenset(sizes))
        covered = sum(wide * high for wide, high in sizes.values())
        left = (width - 2 * EDGE) * (height - 2 * EDGE - header) - covered
        assert not sizes or left >= MIN_PICTURE * width * height
        assert not sizes or header + sum(high for _, high in sizes.values()) < height
        for wide, high in sizes.values():
            assert wide >= 5 * unit and high >= 3 * unit, 'large enough to read'
    assert frozenset((CORNER, STRIP)) in seen and frozenset() in seen
