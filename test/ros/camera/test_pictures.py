# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera's message off the wire into a frame: raw ones by cv_bridge, and what is refused."""
import cv2
import numpy as np
import pytest

from mhri.camera.depth_codec import encode_depth
from mhri.camera.depth_colour import DepthColour
from mhri.camera.image_message import COMPRESSED_TYPE, RAW_TYPE, RawImage
from mhri.camera.images import FrameError
from mhri.camera.ros.pictures import decode_raw, decode_raw_depth, read_picture
from support.pictures import colour_picture, compressed_message
from support.pictures import depth_picture, raw_message

RED = (220, 30, 20)
PICTURE = colour_picture(320, 240)
MM = depth_picture(160, 120)
M = np.where(MM > 0, MM / np.float32(1000.0), np.nan).astype(np.float32)


def flat(rgb=RED, width=64, height=48):
    return np.full((height, width, 3), rgb, np.uint8)


def same(found, expected):
    return found.dtype == np.float32 and found.shape == expected.shape and bool(
        ((found == expected) | (np.isnan(found) & np.isnan(expected))).all())


def raw(encoding, data, width=64, height=48, step=0, is_bigendian=0):
    return RawImage(height, width, encoding, is_bigendian, step, data)


def yuv(pattern, width=64, height=48):
    # That of cameras: ITU-R BT.601, 16..235.
    r, g, b = RED
    y = round(16 + (65.738 * r + 129.057 * g + 25.064 * b) / 256)
    u = round(128 + (-37.945 * r - 74.494 * g + 112.439 * b) / 256)
    v = round(128 + (112.439 * r - 94.154 * g - 18.285 * b) / 256)
    pair = [{'y': y, 'u': u, 'v': v}[letter] for letter in pattern]
    return np.tile(np.array(pair, np.uint8), width * height // 2)


@pytest.mark.parametrize('encoding, data', [
    ('rgb8', flat()), ('bgr8', flat(RED[::-1])), ('8UC3', flat(RED[::-1])),
    ('rgba8', np.dstack([flat(), flat()[..., 0]])),
    ('bgra8', np.dstack([flat(RED[::-1]), flat()[..., 0]])),
    ('yuv422', yuv('uyvy')), ('yuv422_yuy2', yuv('yuyv')),
    ('yuyv', yuv('yuyv')), ('uyvy', yuv('uyvy')),
    ('rgb16', flat().astype('<u2') * 257), ('bgra16', np.dstack([
        flat(RED[::-1]), flat()[..., 0]]).astype('<u2') * 257),
])
@pytest.mark.parametrize('view', [None, (32, 24)])
def test_raw_red_is_red(encoding, data, view):
    rgb, full = decode_raw(raw(encoding, data.tobytes()), view)
    assert full == (64, 48) and rgb.shape == ((24, 32, 3) if view else (48, 64, 3))
    assert rgb.flags.c_contiguous and np.abs(rgb.astype(int) - RED).max() <= 3


@pytest.mark.parametrize('encoding, kind', [('mono8', 'u1'), ('8UC1', 'u1'), ('mono16', '<u2')])
def test_raw_grey(encoding, kind):
    pixels = np.full((48, 64), 90 if kind == 'u1' else 90 * 256, kind)
    assert (decode_raw(raw(encoding, pixels.tobytes()))[0] == 90).all()


def test_raw_big_endian_and_padded_rows():
    pixels = np.arange(48 * 64).reshape(48, 64).astype('>u2') * 21
    padded = np.zeros((48, 70), '>u2')
    padded[:, :64] = pixels
    rgb = decode_raw(raw('mono16', padded.tobytes(), step=140, is_bigendian=1))[0]
    assert np.array_equal(rgb[..., 0], np.rint(pixels / 257.0))
    # Whatever number says so: it is a bool.
    assert np.array_equal(decode_raw(raw('mono16', padded.tobytes(), step=140, is_bigendian=7))[0],
                          rgb)
    # The last row may end with its last pixel.
    rows = np.zeros((48, 200), np.uint8)
    rows[:, :192] = PICTURE[:48, :64].reshape(48, 192)
    assert np.array_equal(decode_raw(raw('rgb8', rows.tobytes()[:-8], step=200))[0],
                          PICTURE[:48, :64])


def test_raw_is_not_changed_and_not_shared():
    data = bytearray(PICTURE.tobytes())
    rgb = decode_raw(raw('bgr8', data, 320, 240))[0]
    assert bytes(data) == PICTURE.tobytes()
    assert np.array_equal(rgb, PICTURE[..., ::-1])


@pytest.mark.parametrize('image, words', [
    (raw('rgb8', b'\0' * 100), 'truncated'), (raw('', b'\0' * 100), 'encoding'),
    (raw('bayer_rggb12', b'\0' * 9999), 'encoding'), (raw('16UC1', b'\0' * 9999), '16UC1.*color'),
    (raw('32FC1', b'\0' * 99999), '32FC1.*color'), (raw('8UC0', b'\0' * 9999), '8UC0'),
    (raw('8UC99999999999999', b'\0' * 9999999), '8UC999'), (raw('8UC5', b'\0' * 99999), '8UC5'),
    (raw('64FC512', b'\0' * 9999, 1, 1), '64FC512'), (raw('\0\uffff', b'\0' * 99999), 'encoding'),
    (raw('rgb8', b'\0' * 9216, step=100), 'rows of 100'), (raw('rgb8', b'', 0, 0), '0 x 0'),
    (raw('rgb8', b'', 4000000000, 4000000000), '4000000000 x'),
    (raw('yuv422', b'\0' * 9999, width=63), 'odd width'),
])
def test_wrong_raw_is_refused(image, words):
    with pytest.raises(FrameError, match=words):
        decode_raw(image)


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


SMALL = colour_picture(64, 48)
SMALL_MM = depth_picture(64, 48)
JPEG = compressed_message('jpeg', cv2.imencode('.jpg', SMALL[..., ::-1])[1].tobytes())
RAW = raw_message('rgb8', 48, 64, SMALL.tobytes(), 192)
DEPTH = compressed_message(*encode_depth(SMALL_MM, 'rvl'))
RAW_DEPTH = raw_message('16UC1', 48, 64, SMALL_MM.tobytes(), 128)


def read(kind, message_type, data, view=None):
    return read_picture(kind, message_type, data, view, DepthColour(), 12.5)


@pytest.mark.parametrize('kind, message_type, data, transport', [
    ('rgb', COMPRESSED_TYPE, JPEG, 'jpeg'), ('rgb', RAW_TYPE, RAW, 'raw'),
    ('depth', COMPRESSED_TYPE, DEPTH, 'compressedDepth rvl'),
    ('depth', RAW_TYPE, RAW_DEPTH, 'raw'),
])
def test_every_kind(kind, message_type, data, transport):
    for view, shape in ((None, (48, 64)), ((16, 16), (12, 16))):
        frame, found = read(kind, message_type, data, view)
        assert found == transport and frame.kind == kind and frame.received_s == 12.5
        assert frame.full_size == (64, 48) and frame.rgb.shape == shape + (3,)
        assert frame.rgb.flags.c_contiguous
        assert (frame.depth_m is None) == (frame.depth_range_m is None) == (kind == 'rgb')
        if kind == 'depth':
            assert frame.depth_m.shape == shape
            known = np.append(SMALL_MM[SMALL_MM > 0] / np.float32(1000), np.float32(np.nan))
            assert np.isin(frame.depth_m[frame.depth_m == frame.depth_m], known).all()


@pytest.mark.parametrize('data', [JPEG, RAW], ids=['jpeg', 'raw'])
def test_cut_off_anywhere(data):
    message_type = COMPRESSED_TYPE if data is JPEG else RAW_TYPE
    for length in list(range(60)) + [len(data) - 1]:
        with pytest.raises(FrameError):
            read('rgb', message_type, data[:length])


@pytest.mark.parametrize('kind, message_type, data, words', [
    ('rgb', 'std_msgs/String', b'', 'std_msgs/String is not a picture'),
    ('rgb', COMPRESSED_TYPE, DEPTH, 'neither jpeg nor png'),
    ('rgb', RAW_TYPE, RAW_DEPTH, '16UC1'), ('depth', RAW_TYPE, RAW, 'rgb8'),
    ('depth', COMPRESSED_TYPE, JPEG, "'jpeg'"), ('rgb', COMPRESSED_TYPE, RAW, 'truncated|bytes'),
])
def test_one_for_the_other(kind, message_type, data, words):
    with pytest.raises(FrameError, match=words):
        read(kind, message_type, data)
