# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures for a bad radio: cut in pieces of which some may be lost, and made small."""
import math
import random
import struct

import cv2
import numpy as np
import pytest

from mhri.link.frames import FrameError
from mhri.link.pieces import PieceAssembler, MAX_PIECES, PIECE_BYTES, split
from mhri.link.picture_shrinker import PictureShrinker


# --- pieces

BODY = bytes(range(256)) * 40


def came(pieces):
    """Return the pictures that come of pieces."""
    gathered = PieceAssembler()
    return [whole for whole in map(gathered.add, pieces) if whole]


@pytest.mark.parametrize('group', [0, 3, 6])
def test_a_picture_comes_together_of_its_pieces_in_any_order(group):
    pieces = split(7, 12.5, BODY, group)
    assert max(map(len, pieces)) < PIECE_BYTES + 50
    random.Random(1).shuffle(pieces)
    whole, = came(pieces + pieces)
    assert (whole.stamp_s, whole.body) == (12.5, BODY)


@pytest.mark.parametrize('size', [1, 2, 1199, 1201, 3000, 10241])
@pytest.mark.parametrize('group', [1, 2, 3, 6])
def test_any_one_piece_may_be_lost_where_there_are_spare_ones(size, group):
    body = random.Random(size).getrandbits(8 * size).to_bytes(size, 'big')
    pieces = split(1, 1.0, body, group)
    for place in range(len(pieces)):
        assert [whole.body for whole in came(pieces[:place] + pieces[place + 1:])] == [body]


def test_one_of_each_group_may_be_lost():
    pieces = split(1, 1.0, BODY, 3)
    # Of nine pieces and three spare ones.
    assert len(pieces) == 12
    assert came(pieces[3:])[0].body == BODY
    assert not came([piece for place, piece in enumerate(pieces) if place not in (0, 3)])


def test_a_picture_that_is_too_large_is_not_cut():
    assert split(1, 1.0, bytes(PIECE_BYTES * MAX_PIECES + 1)) == []


@pytest.mark.parametrize('data', [b'', bytes(20)] + [
    struct.pack('>IHHId', 1, *shape, 0.0) + b'x' * size for shape, size in (
        ((5, 0, 2000), 9), ((0, 0, 0), 9), ((0, 0, 2 ** 31), 9), ((0, 9, 2000), 9),
        ((3, 1, 2000), 9), ((0, 0, 2000), 1001))])
def test_a_piece_that_is_none(data):
    with pytest.raises(FrameError):
        PieceAssembler().add(data)


def test_pieces_that_do_not_fit_each_other():
    gathered = PieceAssembler()
    gathered.add(split(1, 1.0, BODY)[0])
    with pytest.raises(FrameError):
        gathered.add(split(1, 1.0, BODY[:3000])[1])


# --- smaller pictures

def picture(data):
    """Return a sensor_msgs/CompressedImage as bytes."""
    texts = b''.join(struct.pack('<I', len(text)) + text for text in (b'camera', b'jpeg', data))
    return struct.pack('<III', 7, 11, 22) + texts


def jpeg(width=640, height=480):
    """Return a jpeg of a picture with many edges."""
    pixels = np.random.RandomState(1).randint(0, 255, (height // 8, width // 8, 3), np.uint8)
    pixels = cv2.resize(pixels, (width, height), interpolation=cv2.INTER_LINEAR)
    return cv2.imencode('.jpg', pixels, [cv2.IMWRITE_JPEG_QUALITY, 90])[1].tobytes()


@pytest.mark.parametrize('most', [20000, 8000, 4000])
def test_a_picture_is_made_as_small_as_it_must_be(most):
    data = picture(jpeg())
    found = PictureShrinker().fit(data, most)
    assert 0.2 * most < len(found) <= most < len(data)
    begin = data.index(b'jpeg') + 8
    assert found[:begin - 4] == data[:begin - 4]
    assert struct.unpack_from('<I', found, begin - 4)[0] == len(found) - begin
    pixels = cv2.imdecode(np.frombuffer(found[begin:], np.uint8), cv2.IMREAD_COLOR)
    assert pixels.shape[1] * 3 == pixels.shape[0] * 4


@pytest.mark.parametrize('data', [picture(b'no picture' * 99), b'', b'short', picture(b'')])
def test_what_is_no_picture_stays_as_it_is(data):
    assert PictureShrinker().fit(data, 1) == data


def test_a_picture_that_fits_is_not_touched():
    data = picture(jpeg(64, 48))
    assert PictureShrinker().fit(data, math.inf) is data
