# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of cells: what a message and a file of map_server say, and what cannot be."""
import math

import numpy as np
import pytest

from mhri.base.config import ConfigError
from mhri.base.mocap import Pose
from mhri.map.grid import Grid, grid_of, GridError, picture_size, read_map

CORNER = Pose(-1.0, 2.0, 0.0)
YAML = '''image: hall.pgm
resolution: 0.5
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
'''


def loaded(picture):
    return lambda name: np.array(picture, dtype=np.uint8)


def test_a_message_is_read_row_by_row_from_the_bottom():
    for data in ((0, 100, -1, 50, 0, 0), bytes((0, 100, 255, 50, 0, 0)),
                 np.array((0, 100, -1, 50, 0, 0))):
        grid = grid_of(0.5, CORNER, 3, 2, data)
        assert grid.cells.tolist() == [[0, 100, -1], [50, 0, 0]]
        assert grid.cells.dtype == np.int8
        assert grid.size_m == (1.5, 1.0)
        assert grid.taken().tolist() == [[-0.25, 2.25]]


def test_a_map_that_is_turned_has_its_cells_turned():
    grid = grid_of(1.0, Pose(1.0, 0.0, 0.5 * math.pi), 2, 1, (0, 100))
    assert grid.taken()[0] == pytest.approx((0.5, 1.5))


def test_values_that_are_no_occupancy_are_unknown():
    assert grid_of(1.0, CORNER, 3, 1, (-2, 101, 100)).cells.tolist() == [[-1, -1, 100]]


@pytest.mark.parametrize('fields, words', [
    ((0.0, CORNER, 1, 1, (0,)), 'cells of 0 m'),
    ((-0.1, CORNER, 1, 1, (0,)), 'cells of -0.1 m'),
    ((math.nan, CORNER, 1, 1, (0,)), 'cells of nan m'),
    ((0.1, Pose(math.inf, 0.0, 0.0), 1, 1, (0,)), 'a corner at x inf'),
    ((0.1, Pose(0.0, 1e9, 0.0), 1, 1, (0,)), 'a corner at x 0, y 1e+09'),
    ((0.1, CORNER, 0, 5, ()), '0 x 5 cells'),
    ((0.1, CORNER, 100000, 100000, (0,)), 'expected 1 to 40000000'),
    ((0.1, CORNER, 3, 2, (0,) * 5), '5 values for 3 x 2 cells')])
def test_a_message_that_cannot_be_is_refused(fields, words):
    with pytest.raises(GridError) as refused:
        grid_of(*fields)
    assert words in str(refused.value)


PICTURE = [[0, 255, 205], [254, 0, 100]]


@pytest.mark.parametrize('changed, picture, cells', [
    ('', PICTURE, [[0, 100, -1], [100, 0, -1]]),
    ('negate: 1', PICTURE, [[100, 0, -1], [0, 100, 100]]),
    ('mode: raw', [[0, 100, 205]], [[0, 100, -1]]),
    ('mode: scale', [[0, 255, 155]], [[100, 0, 43]]),
    ('mode: scale', [[[9, 9, 9, 255], [155, 155, 155, 255], [155, 155, 155, 0]]],
     [[100, 43, -1]]),
    ('', [[[0, 0, 0], [255, 255, 255]]], [[100, 0]])])
def test_a_file_is_read_as_map_server_reads_it(changed, picture, cells):
    text = YAML.replace('negate: 0\n', '') + changed
    grid = read_map(text, 'hall.yaml', loaded(picture))
    assert isinstance(grid, Grid)
    assert (grid.resolution_m, grid.origin) == (0.5, CORNER)
    assert grid.cells.tolist() == cells


@pytest.mark.parametrize('old, new, words', [
    ('resolution: 0.5', 'resolution: 0', 'hall.yaml: resolution: expected a number'),
    ('resolution: 0.5', 'resolution: .nan', 'hall.yaml: resolution: expected a number'),
    ('[-1.0, 2.0, 0.0]', '[1, 2]', 'origin: expected [x, y, yaw]'),
    ('[-1.0, 2.0, 0.0]', '[1, 2, .inf]', 'origin: expected [x, y, yaw]'),
    ('negate: 0', 'negate: 2', 'negate: expected 0 or 1'),
    ('negate: 0', 'mode: grey', 'mode: expected trinary, scale or raw'),
    ('0.196', '0.7', 'free_thresh: expected less than occupied_thresh'),
    ('image: hall.pgm', '', 'image: is missing')])
def test_a_file_that_cannot_be_used_is_refused_by_key(old, new, words):
    with pytest.raises(ConfigError) as refused:
        read_map(YAML.replace(old, new), 'hall.yaml', loaded(PICTURE))
    assert words in str(refused.value)


def test_keys_of_others_and_16_bits_are_read_as_map_server_does():
    deep = np.array(PICTURE, dtype=np.uint16) * 256 + 77
    grid = read_map(YAML + 'author: somebody\n', 'hall.yaml', lambda name: deep)
    assert grid.cells.tolist() == read_map(YAML, 'hall.yaml', loaded(PICTURE)).cells.tolist()


@pytest.mark.parametrize('head, size', [
    (b'\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x75\x30\0\0\x01\x02\x08', (30000, 258)),
    (b'P5 30000 258 255\n', (30000, 258)),
    (b'P5\n# CREATOR: map_saver 0.050 m/pix\n30000 258\n255\n', (30000, 258)),
    (b'BM' + bytes(16) + b'\x30\x75\0\0' + b'\xfe\xfe\xff\xff', (30000, 258)),
    (b'\x89PNG\r\n\x1a\n', None), (b'P5\n', None), (b'\xff\xd8\xff', None), (b'', None)])
def test_the_size_of_a_picture_is_in_its_head(head, size):
    assert picture_size(head) == size


@pytest.mark.parametrize('load', [
    lambda name: None, lambda name: np.zeros((2, 2)), lambda name: np.zeros(4, dtype=np.uint8)])
def test_a_picture_that_cannot_be_read_is_refused_by_name(load):
    with pytest.raises(ConfigError) as refused:
        read_map(YAML, 'hall.yaml', load)
    assert "image: 'hall.pgm' cannot be read as a picture" in str(refused.value)
