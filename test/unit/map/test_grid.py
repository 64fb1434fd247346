# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of cells: what a message and a file of map_server say, and what cannot be."""
import math

import numpy as np
import pytest

from mhri.base.config import ConfigError
from mhri.base.geometry import Pose
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


def test_values_that_are_no_occupancy_are_unknown():
    assert grid_of(1.0, CORNER, 3, 1, (-2, 101, 100)).cells.tolist() == [[-1, -1, 100]]


@pytest.mark.parametrize('fields, words', [
    ((0.0, CORNER, 1, 1, (0,)), '0 m'), ((math.nan, CORNER, 1, 1, (0,)), 'nan m'),
    ((0.1, Pose(math.inf, 0.0, 0.0), 1, 1, (0,)), 'x inf'),
    ((0.1, Pose(0.0, 1e9, 0.0), 1, 1, (0,)), 'y 1e+09'), ((0.1, CORNER, 0, 5, ()), '0 x 5'),
    ((0.1, CORNER, 100000, 100000, (0,)), '40000000'),
    ((0.1, CORNER, 3, 2, (0,) * 5), '3 x 2')])
def test_an_impossible_message_is_refused(fields, words):
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


@pytest.mark.parametrize('old, new, key', [
    ('resolution: 0.5', 'resolution: 0', 'resolution'),
    ('resolution: 0.5', 'resolution: .nan', 'resolution'), ('[-1.0, 2.0, 0.0]', '[1, 2]', 'origin'),
    ('[-1.0, 2.0, 0.0]', '[1, 2, .inf]', 'origin'), ('negate: 0', 'negate: 2', 'negate'),
    ('negate: 0', 'mode: grey', 'mode'), ('0.196', '0.7', 'free_thresh'),
    ('image: hall.pgm', '', 'image')])
def test_an_unusable_file_is_refused_by_key(old, new, key):
    with pytest.raises(ConfigError) as refused:
        read_map(YAML.replace(old, new), 'hall.yaml', loaded(PICTURE))
    assert (refused.value.origin, refused.value.key) == ('hall.yaml', key)


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
    assert refused.value.key == 'image' and 'hall.pgm' in str(refused.value)
