# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth pictures: exact to the pixel in every format in the field; colours; what is refused."""
import struct

import cv2
import numpy as np
import pytest

from mhri.camera.depth_codec import decode_depth, encode_depth
from mhri.camera.depth_colour import colour_at, DepthColour
from mhri.camera.images import FrameError

from support.pictures import colour_picture, depth_picture

MM = depth_picture(160, 120)
M = np.where(MM > 0, MM / np.float32(1000.0), np.nan).astype(np.float32)
HEADER = struct.pack('<iff', 0, 0.0, 0.0)


def same(found, expected):
    return found.dtype == np.float32 and found.shape == expected.shape and bool(
        ((found == expected) | (np.isnan(found) & np.isnan(expected))).all())


def png(pixels):
    return cv2.imencode('.png', pixels)[1].tobytes()


@pytest.mark.parametrize('codec', ['png', 'rvl'])
def test_millimetres_are_exact(codec):
    fmt, data = encode_depth(MM, codec)
    assert fmt == '16UC1; compressedDepth ' + codec
    depth, full, transport = decode_depth(fmt, data)
    assert same(depth, M) and full == (160, 120) and transport == 'compressedDepth ' + codec


@pytest.mark.parametrize('codec', ['png', 'rvl'])
def test_metres_are_as_exact_as_the_plugin_is(codec):
    fmt, data = encode_depth(M, codec)
    assert fmt == '32FC1; compressedDepth ' + codec
    depth, _, _ = decode_depth(fmt, data)
    # The plugin's own arithmetic, pixel by pixel.
    a, b = 100.0 * 101.0, 1.0 - 100.0 * 101.0 / 10.0
    quantised = np.where(M < 10.0, a / M + b, 0)
    expected = np.where(np.isnan(M), np.nan, a / (np.floor(quantised) - b))
    assert np.array_equal(np.isnan(depth), np.isnan(M))
    assert np.nanmax(np.abs(depth - expected)) < 1e-5
    assert np.nanmax(np.abs(depth - M) / M ** 2) < 1.0 / 10000.0


@pytest.mark.parametrize('fmt', ['16UC1; compressedDepth', 'mono16; compressedDepth png',
                                 '16UC1;compressedDepth png', 'compressedDepth',
                                 'compressedDepth png', '16UC1; compressedDepth '])
def test_names_in_the_field(fmt):
    assert same(decode_depth(fmt, HEADER + png(MM))[0], M)


def test_legacy_header_may_hold_anything_for_millimetres():
    for a, b in ((float('nan'), 1e38), (-5.0, 7.0), (1e-40, -1e-30)):
        data = struct.pack('<iff', 32767, a, b) + png(MM)
        assert same(decode_depth('16UC1; compressedDepth', data)[0], M)
        assert same(decode_depth('compressedDepth', data)[0], M)


def test_a_picture_made_by_hand():
    data = struct.pack('<iff', 0, 10100.0, -1009.0) + png(
        np.array([[0, 1, 1011, 9091]], np.uint16))
    depth, _, _ = decode_depth('32FC1; compressedDepth png', data)
    assert np.isnan(depth[0, 0])
    assert depth[0, 1:] == pytest.approx([10.0, 5.0, 1.0])
    rvl = HEADER + struct.pack('<ii', 5, 1) + struct.pack('<I', 0x23c21000)
    depth, _, _ = decode_depth('16UC1; compressedDepth rvl', rvl)
    assert same(depth, np.array([[np.nan, np.nan, 0.010, 0.009, 0.009]], np.float32))


def test_encoder_drops_what_cannot_be_told():
    metres = np.array([[np.nan, np.inf, -1.0, 0.0, 0.01, 12.0, 10.0, 2.0]], np.float32)
    depth, _, _ = decode_depth(*encode_depth(metres))
    assert np.isnan(depth[0, :7]).all() and depth[0, 7] == pytest.approx(2.0, abs=1e-3)
    depth, _, _ = decode_depth(*encode_depth(np.array([[0, 9999, 10000, 10001]], np.uint16)))
    assert np.isnan(depth[0]).tolist() == [True, False, False, True]


_, RVL = encode_depth(MM, 'rvl')
_, PNG = encode_depth(MM, 'png')


@pytest.mark.parametrize('fmt, data, words', [
    ('16UC1; compressedDepth png', b'', 'truncated'),
    ('16UC1; compressedDepth png', PNG[:12], 'truncated'),
    ('16UC1; compressedDepth png', PNG[:len(PNG) // 2], 'truncated'),
    ('16UC1; compressedDepth png', RVL, 'neither'),
    ('16UC1; compressedDepth png', HEADER + png(colour_picture(64, 48)), '16-bit grey'),
    ('16UC1; compressedDepth png',
     HEADER + cv2.imencode('.jpg', colour_picture(64, 48))[1].tobytes(), 'holds a jpeg'),
    ('16UC1; compressedDepth rvl', RVL[:16], 'truncated'),
    ('16UC1; compressedDepth rvl', RVL[:len(RVL) // 2], 'truncated'),
    ('16UC1; compressedDepth rvl', HEADER + struct.pack('<ii', 1 << 30, 1 << 30), 'refused'),
    ('16UC1; compressedDepth rvl', HEADER + struct.pack('<ii', -4, -4) + b'\0' * 8, 'refused'),
    ('16UC1; compressedDepth rvl', HEADER + struct.pack('<ii', 0, 4) + b'\0' * 8, 'refused'),
    ('32FC1; compressedDepth png', HEADER + png(MM), 'quantisation'),
    ('16UC1; compressedDepth zstd', PNG, 'format'), ('16UC1; png compressed ', png(MM), 'format'),
    ('bgr8; jpeg compressed bgr8', PNG, 'format'), ('', PNG, 'format'),
    ('rgb8; compressedDepth png', PNG, 'format'),
])
def test_wrong_depth_is_refused(fmt, data, words):
    with pytest.raises(FrameError, match=words):
        decode_depth(fmt, data)


def test_near_is_yellow_far_is_purple_and_invalid_is_grey():
    depth = np.array([[0.5, 1.0, 3.0, 5.0, 9.0, np.nan]], np.float32)
    rgb, depth_range = DepthColour().colour(depth, 0.0)
    colours = [tuple(int(value) for value in pixel) for pixel in rgb[0]]
    assert colours[:5] == [colour_at(value, depth_range) for value in depth[0, :5].tolist()]
    assert colours[0][0] > 200 and colours[0][1] > 200 and colours[0][2] < 80
    assert colours[4][2] > colours[4][1] and len(set(colours[5])) == 1
    for step in range(256):
        assert np.ptp(colour_at(0.5 + step / 30, depth_range)) > 40


def test_the_range_follows_without_flickering():
    near, far = M, M + np.float32(1.0)
    colour = DepthColour()
    first = colour.colour(near, 0.0)[1]
    valid = np.sort(near[~np.isnan(near)])
    assert first == pytest.approx(np.percentile(valid, (2, 98)), rel=0.02)
    jump = colour.colour(far, 0.033)[1]
    assert jump[0] - first[0] < 0.05
    for index in range(1, 200):
        jump = colour.colour(far, 0.033 * (index + 1))[1]
    assert jump == pytest.approx([value + 1.0 for value in first], abs=0.02)


@pytest.mark.parametrize('depth_m, expected', [(2.0, (1.75, 2.25)), (0.1, (0.0, 0.5))])
def test_a_flat_scene_has_a_range_of_some_width(depth_m, expected):
    depth = np.full((48, 64), depth_m, np.float32)
    assert DepthColour().colour(depth, 0.0)[1] == pytest.approx(expected)


def test_nothing_valid():
    colour = DepthColour()
    nothing = np.full((48, 64), np.nan, np.float32)
    rgb, depth_range = colour.colour(nothing, 0.0)
    assert depth_range is None and len(np.unique(rgb)) == 2
    kept = colour.colour(M[:48, :64], 1.0)[1]
    rgb, depth_range = colour.colour(nothing, 2.0)
    assert depth_range == kept and len(np.unique(rgb)) == 2


def test_legacy_without_encoding_knows_inverse_depth_by_its_header():
    _, data = encode_depth(M, 'png')
    assert same(decode_depth('compressedDepth', data)[0], decode_depth('32FC1; compressedDepth',
                                                                       data)[0])
