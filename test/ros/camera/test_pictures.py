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
from mhri.camera.shades import Shades
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


def shown(image, view=None):
    """Return (rgb, size as sent, values of black and white) of a raw picture."""
    pixels, full = decode_raw(image, view)
    rgb, values = Shades().rgb(pixels, 0.0)
    return rgb, full, values


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
    rgb, full, _ = shown(raw(encoding, data.tobytes()), view)
    assert full == (64, 48) and rgb.shape == ((24, 32, 3) if view else (48, 64, 3))
    assert rgb.flags.c_contiguous and np.abs(rgb.astype(int) - RED).max() <= 3


@pytest.mark.parametrize('encoding', ['mono8', '8UC1'])
def test_raw_grey(encoding):
    pixels = np.full((48, 64), 90, np.uint8)
    rgb, _, values = shown(raw(encoding, pixels.tobytes()))
    assert (rgb == 90).all() and values is None


@pytest.mark.parametrize('encoding, kind, low, high', [
    ('mono16', '<u2', 0, 1023), ('mono16', '<u2', 7200, 8100), ('16UC1', '<u2', 0, 65535),
    ('16SC1', '<i2', -300, 4000), ('32SC1', '<i4', -5, 70000), ('32FC1', '<f4', 0.0, 1.0),
    ('32FC1', '<f4', 273.1, 310.0), ('64FC1', '<f8', -1.0, 1.0), ('8SC1', 'i1', -100, 100)])
@pytest.mark.parametrize('view', [None, (32, 24)])
def test_grey_of_other_numbers_is_seen_whatever_part_of_them_it_fills(
        encoding, kind, low, high, view):
    """A thermal camera of 14 bits leaves the top of its 16 bits empty."""
    pixels = np.linspace(low, high, 48 * 64).reshape(48, 64).astype(kind)
    rgb, full, values = shown(raw(encoding, pixels.tobytes()), view)
    assert full == (64, 48) and len(np.unique(rgb)) > 140
    assert rgb[0, 0, 0] == 0 and rgb[-1, -1, 0] == 255
    assert values == pytest.approx(np.percentile(pixels, (2, 98)), abs=0.03 * (high - low))


def test_metres_that_are_none_are_black_and_count_for_nothing():
    pixels = np.array([[np.nan, np.inf, -np.inf] + [1.0] * 30 + [2.0] * 31] * 48, '<f4')
    rgb, _, values = shown(raw('32FC1', pixels.tobytes()))
    assert values == pytest.approx((1.0, 2.0)) and not rgb[:, [0, 2]].any()


@pytest.mark.parametrize('encoding', ['rgb16', 'bayer_rggb16'])
@pytest.mark.parametrize('bits', [10, 12, 14, 16])
def test_colours_of_fewer_bits_than_their_numbers_keep_their_balance(encoding, bits):
    white = 2 ** bits - 1
    pixels = np.full((48, 64, 3), white // 2, '<u2')
    pixels[24:] = white
    pixels = pixels if encoding == 'rgb16' else np.ascontiguousarray(pixels[..., 0])
    rgb, _, values = shown(raw(encoding, pixels.tobytes()))
    assert values is None
    assert abs(int(rgb[10, 30, 0]) - 127) <= 1 and (rgb[40, 30] == 255).all()


@pytest.mark.parametrize('colours', [False, True])
def test_a_png_of_16_bits_is_seen(colours):
    pixels = np.linspace(0, 1023, 48 * 64).reshape(48, 64).astype(np.uint16)
    coded = np.dstack([pixels // 4, pixels // 2, pixels]) if colours else pixels
    message = compressed_message(
        'bgr16; png compressed bgr16' if colours else 'mono16; png compressed ',
        cv2.imencode('.png', coded)[1].tobytes())
    frame, transport = read('rgb', COMPRESSED_TYPE, message)
    assert transport == 'png' and len(np.unique(frame.rgb)) > 200
    assert (frame.grey_range is None) == colours
    if colours:
        assert abs(int(frame.rgb[-1, -1, 0]) - 255) < 2 and frame.rgb[-1, -1, 2] in (63, 64)


def test_raw_big_endian_and_padded_rows():
    pixels = np.arange(48 * 64).reshape(48, 64).astype('>u2') * 21
    padded = np.zeros((48, 70), '>u2')
    padded[:, :64] = pixels
    found = decode_raw(raw('mono16', padded.tobytes(), step=140, is_bigendian=1))[0]
    assert np.array_equal(found, pixels)
    # Whatever number says so: it is a bool.
    assert np.array_equal(decode_raw(raw('mono16', padded.tobytes(), step=140, is_bigendian=7))[0],
                          pixels)
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
    (raw('bayer_rggb12', b'\0' * 9999), 'encoding'), (raw('16UC2', b'\0' * 99999), '16UC2'),
    (raw('32FC3', b'\0' * 99999), '32FC3.*color'), (raw('8UC0', b'\0' * 9999), '8UC0'),
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
    colour = DepthColour() if kind == 'depth' else Shades()
    return read_picture(kind, message_type, data, view, colour, 12.5)


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
    ('depth', RAW_TYPE, RAW, 'rgb8'),
    ('depth', COMPRESSED_TYPE, JPEG, "'jpeg'"), ('rgb', COMPRESSED_TYPE, RAW, 'truncated|bytes'),
])
def test_one_for_the_other(kind, message_type, data, words):
    with pytest.raises(FrameError, match=words):
        read(kind, message_type, data)
