# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""RVL against a plain decoder that goes number by number, and against streams made by hand."""
import struct

import numpy as np
import pytest

from mhri.camera.images import FrameError
from mhri.camera.rvl import decode_rvl, encode_rvl

from support.pictures import depth_picture


class Nibbles:
    """The reference: one nibble at a time, as the paper tells it."""

    def __init__(self, data):
        self._nibbles = iter([word >> shift & 15 for (word,) in struct.iter_unpack('<I', data)
                              for shift in range(28, -1, -4)])

    def read(self):
        value = shift = 0
        while True:
            nibble = next(self._nibbles)
            value |= (nibble & 7) << shift
            shift += 3
            if not nibble & 8:
                return value


def reference_decode(data, count):
    stream, pixels, previous = Nibbles(data), [], 0
    while len(pixels) < count:
        pixels += [0] * stream.read()
        for _ in range(stream.read()):
            zigzag = stream.read()
            previous += zigzag >> 1 ^ -(zigzag & 1)
            pixels.append(previous & 0xffff)
    return pixels


RANDOM = np.random.RandomState(3)
PICTURES = {
    'one pixel, invalid': [0], 'one pixel': [1], 'largest': [65535, 1, 65535, 0, 65535],
    'all invalid': [0] * 1000, 'all valid': [700] * 999, 'begins valid': [5, 0, 0, 6],
    'ends invalid': [0, 7, 7, 0], 'ends valid': [0, 0, 9], 'alternating': [0, 3] * 400,
    'seven nibbles': [0] * 300000 + [1], 'noise': RANDOM.randint(0, 65536, 5000),
    'sparse': RANDOM.randint(0, 65536, 5000) * (RANDOM.uniform(size=5000) < 0.1),
    'smooth': 2000 + np.cumsum(RANDOM.randint(-9, 10, 5000)),
    'scene': depth_picture(160, 120).ravel(),
}


@pytest.mark.parametrize('name', PICTURES)
def test_both_ways_as_the_reference(name):
    pixels = np.array(PICTURES[name], np.uint16)
    stream = encode_rvl(pixels)
    assert np.array_equal(decode_rvl(stream, len(pixels)), pixels)
    assert np.array_equal(reference_decode(stream, len(pixels)), pixels)


def test_numbers_across_the_parts_that_are_read_at_once():
    # Differences of 1 to 6 nibbles in every phase against the parts' borders.
    pixels = np.cumsum(RANDOM.choice([1, 5, 40, 300, 2500, 20000], 60000)).astype(np.uint16) | 1
    assert np.array_equal(decode_rvl(encode_rvl(pixels), len(pixels)), pixels)


def test_a_stream_made_by_hand():
    # 2 zeros, 3 others: 10 (+10 -> zigzag 20: nibbles c 2), 9 (-1 -> 1), 9 (0); 0 zeros left.
    assert decode_rvl(struct.pack('<I', 0x23c21000), 5).tolist() == [0, 0, 10, 9, 9]
    assert encode_rvl(np.array([0, 0, 10, 9, 9], np.uint16)) == struct.pack('<I', 0x23c21000)


SCENE = depth_picture(160, 120)
STREAM = encode_rvl(SCENE)


@pytest.mark.parametrize('what, stream, count, words', [
    ('nothing', b'', 10, 'truncated'),
    ('cut off', STREAM[:len(STREAM) // 2], SCENE.size, 'truncated'),
    ('last word lost', STREAM[:-4], SCENE.size, 'truncated'),
    ('more pixels than there are', STREAM, SCENE.size + 1, 'truncated'),
    ('fewer pixels than there are', STREAM, SCENE.size - 1, 'do not make'),
    ('zeros for ever', b'\0' * 4000, 10, 'truncated'),
    ('a number without end', b'\xff' * 400000, 10, 'digits'),
    ('a number too long', struct.pack('<III', 0xffffffff, 0xfff00000, 0), 10, 'digits'),
], ids=lambda value: value if isinstance(value, str) else '')
def test_wrong_streams_are_refused(what, stream, count, words):
    with pytest.raises(FrameError, match=words):
        decode_rvl(stream, count)


def test_no_damage_does_worse_than_a_named_error():
    random = np.random.RandomState(5)
    for _ in range(300):
        damaged = bytearray(STREAM)
        for place in random.randint(0, len(damaged), 8):
            damaged[place] = random.randint(0, 256)
        try:
            assert decode_rvl(bytes(damaged), SCENE.size).shape == (SCENE.size,)
        except FrameError:
            pass
