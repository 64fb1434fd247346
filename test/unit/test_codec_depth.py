# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth pictures: exact to the pixel in every format in the field; colours; what is refused."""
import os
import struct
import sys

import cv2
import numpy as np
import pytest

from mhri.camera.depth_codec import decode_depth, encode_depth, parse_format
from mhri.camera.depth_colour import colour_at, DepthColour
from mhri.camera.images import FrameError
from mhri.camera.raw_image import decode_raw_depth, RawImage

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.pictures import colour_picture, depth_picture  # noqa: E402

MM = depth_picture(160, 120)
M = np.where(MM > 0, MM / np.float32(1000.0), np.nan).astype(np.float32)
HEADER = struct.pack('<iff', 0, 0.0, 0.0)


def same(found, expected):
    return found.dtype == np.float32 and found.shape == expected.shape and bool(
        ((found == expected) | (np.isnan(found) & np.isnan(expected))).all())


def png(pixels):
    return cv2.imencode('.png', pixels)[1].tobytes()


def test_two_cameras_do_not_see_each_others_depth():
    """Each has a thread of its own and may be quantised differently; here they take turns."""
    near, far = (encode_depth(np.full((1, 1), 2.0, np.float32), 'rvl', depth_max_m=most)
                 for most in (5.0, 10.0))

    def turn(frame, event, _):
        if event == 'line' and frame.f_code.co_filename == decode_depth.__code__.co_filename:
            decode_depth(*far)
        return turn

    before = sys.gettrace()
    sys.settrace(turn)
    try:
        depth, _, _ = decode_depth(*near)
    finally:
        sys.settrace(before)
    assert depth[0, 0] == pytest.approx(2.0, abs=0.01)


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


def test_legacy_without_encoding_knows_inverse_depth_by_its_header():
    _, data = encode_depth(M, 'png')
    assert same(decode_depth('compressedDepth', data)[0], decode_depth('32FC1; compressedDepth',
                                                                       data)[0])


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


@pytest.mark.parametrize('fmt, expected', [
    ('32FC1; compressedDepth rvl', ('32FC1', 'rvl')), ('16UC1; compressedDepth', ('16UC1', 'png')),
    ('compressedDepth', ('', 'png')), ('compressedDepth rvl', ('', 'rvl')),
])
def test_formats(fmt, expected):
    assert parse_format(fmt) == expected


@pytest.mark.parametrize('order', ['<', '>'])
@pytest.mark.parametrize('padding', [0, 8])
def test_raw_depth(order, padding):
    for encoding, pixels in (('16UC1', MM), ('32FC1', M)):
        size = pixels.dtype.itemsize
        padded = np.zeros((120, 160 + padding), pixels.dtype.newbyteorder(order))
        padded[:, :160] = pixels
        image = RawImage(120, 160, encoding, order == '>', (160 + padding) * size, padded.tobytes())
        assert same(decode_raw_depth(image)[0], M)


def test_raw_metres_that_are_none():
    pixels = np.array([[np.nan, np.inf, -np.inf, 0.0, -2.0, 1.5]], '<f4')
    depth, full = decode_raw_depth(RawImage(1, 6, '32FC1', 0, 24, pixels.tobytes()))
    assert full == (6, 1)
    assert same(depth, np.array([[np.nan] * 5 + [1.5]], np.float32))


def test_raw_depth_of_another_encoding_is_refused():
    with pytest.raises(FrameError, match='rgb8'):
        decode_raw_depth(RawImage(1, 1, 'rgb8', 0, 3, b'\0\0\0'))


def test_colours_of_a_fixed_range():
    depth = np.array([[0.5, 1.0, 3.0, 5.0, 9.0, np.nan]], np.float32)
    rgb, depth_range = DepthColour((1.0, 5.0)).colour(depth, 0.0)
    assert depth_range == (1.0, 5.0) and rgb.dtype == np.uint8
    colours = [tuple(int(value) for value in pixel) for pixel in rgb[0]]
    assert colours[0] == colours[1] == colour_at(1.0, depth_range)
    assert colours[3] == colours[4] == colour_at(5.0, depth_range)
    # Near is yellow, far is purple; invalid is grey, and no colour of the map is.
    assert colours[1][0] > 200 and colours[1][1] > 200 and colours[1][2] < 80
    assert colours[3][2] > colours[3][1] and len(set(colours[5])) == 1
    for step in range(256):
        assert np.ptp(colour_at(1.0 + step / 64, depth_range)) > 40


def test_lightness_grows_evenly_towards_near():
    ramp = np.linspace(5.0, 1.0, 256, dtype=np.float32)[None]
    rgb, _ = DepthColour((1.0, 5.0)).colour(ramp, 0.0)
    lightness = cv2.cvtColor(rgb.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)[0, :, 0]
    steps = np.diff(cv2.blur(lightness, (1, 15)).ravel()[8:-8])
    assert (steps > 0).all() and steps.max() < 3 * steps.min()


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
