# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Colour pictures, compressed and raw: the right colours at the right size, and what is refused."""
import concurrent.futures
import struct

import cv2
import numpy as np
import pytest

from mhri.camera import jpeg, turbojpeg
from mhri.camera.image_codec import decode_compressed, read_size
from mhri.camera.images import fit, FrameError

from support.pictures import colour_picture

RED = (220, 30, 20)
PICTURE = colour_picture(320, 240)


def flat(rgb=RED, width=64, height=48):
    return np.full((height, width, 3), rgb, np.uint8)


def encode(rgb, ending='.jpg', order=cv2.COLOR_RGB2BGR):
    return cv2.imencode(ending, rgb if order is None else cv2.cvtColor(rgb, order))[1].tobytes()


@pytest.mark.parametrize('fmt, ending, order', [
    ('', '.jpg', cv2.COLOR_RGB2BGR), ('png', '.png', cv2.COLOR_RGB2BGR),
    ('rgb8; jpeg compressed bgr8', '.jpg', cv2.COLOR_RGB2BGR),
    ('bgra8; png compressed bgr8', '.png', cv2.COLOR_RGB2BGR),
    ('bgr8; png compressed ', '.png', cv2.COLOR_RGB2BGR),
    # Written without the change to bgr8: the coder's colours are the other way round.
    ('rgb8; png compressed ', '.png', None), ('rgb8; png compressed', '.png', None),
    ('rgb8; jpeg compressed rgb8', '.jpg', cv2.COLOR_RGB2BGR),
])
def test_red_is_red(fmt, ending, order):
    rgb, full, kind = decode_compressed(fmt, encode(flat(), ending, order))
    assert full == (64, 48) and kind == {'.jpg': 'jpeg', '.png': 'png'}[ending]
    assert rgb.dtype == np.uint8 and rgb.shape == (48, 64, 3) and rgb.flags.c_contiguous
    assert np.abs(rgb.astype(int) - RED).max() <= (4 if kind == 'jpeg' else 0)


@pytest.mark.parametrize('ending, fmt', [('.jpg', 'mono8; jpeg compressed '),
                                         ('.png', 'mono8; png compressed '),
                                         ('.png', 'mono16; png compressed ')])
def test_grey_is_grey(ending, fmt):
    grey = np.full((48, 64), 90, np.uint8)
    rgb = decode_compressed(fmt, encode(grey, ending, None))[0]
    assert np.abs(rgb.astype(int) - 90).max() <= 1 and rgb.shape == (48, 64, 3)


@pytest.mark.parametrize('ending', ['.jpg', '.png'])
@pytest.mark.parametrize('view, shape', [
    (None, (240, 320)), ((1000, 1000), (240, 320)), ((200, 200), (150, 200)),
    ((160, 500), (120, 160)), ((80, 60), (60, 80)), ((1, 1), (1, 1))])
def test_size_shown(ending, view, shape):
    rgb, full, _ = decode_compressed('', encode(PICTURE, ending), view)
    assert rgb.shape == shape + (3,) and full == (320, 240)
    if shape[0] >= 60:
        expected = cv2.resize(PICTURE, shape[::-1], interpolation=cv2.INTER_AREA)
        assert np.abs(cv2.blur(rgb, (5, 5)).astype(int) - cv2.blur(expected, (5, 5))).mean() < 4.0


JPEG, PNG = encode(PICTURE), encode(PICTURE, '.png')


@pytest.fixture(params=['libturbojpeg', 'cv2'])
def decoder(request, monkeypatch):
    if request.param == 'cv2':
        monkeypatch.setattr(turbojpeg, 'load', lambda: None)
    assert bool(turbojpeg.load()) == (request.param != 'cv2'), 'apt install libturbojpeg0'
    return request.param


@pytest.mark.parametrize('size', [(320, 240), (321, 243), (7, 5), (1, 1)])
@pytest.mark.parametrize('subsampling', [0x411111, 0x221111, 0x111111])
def test_both_decoders_make_the_same_pixels(size, subsampling, monkeypatch):
    options = [cv2.IMWRITE_JPEG_QUALITY, 80]
    if hasattr(cv2, 'IMWRITE_JPEG_SAMPLING_FACTOR'):
        options += [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, subsampling]
    data = cv2.imencode('.jpg', colour_picture(*size), options)[1].tobytes()
    ours = decode_compressed('jpeg', data)[0]
    assert np.array_equal(ours, cv2.imdecode(np.frombuffer(data, np.uint8), 1)[..., ::-1])
    third = tuple(max(1, side // 3) for side in size)
    small = decode_compressed('jpeg', data, third)[0]
    monkeypatch.setattr(turbojpeg, 'load', lambda: None)
    assert np.array_equal(ours, decode_compressed('jpeg', data)[0])
    other = decode_compressed('jpeg', data, third)[0]
    assert small.shape == other.shape
    # OpenCV 4.2 decodes a jpeg in memory at its full size whatever it is asked for, and the resize
    # does the rest: another filter, which shows most in a picture of one pixel.
    halved = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_REDUCED_COLOR_2)
    limit = 0.5 if halved.shape[0] < size[1] or size == (1, 1) else 12.0
    assert np.abs(small.astype(int) - other).mean() < limit


def test_a_jpeg_the_library_refuses_goes_to_the_other_decoder():
    assert jpeg.decode_jpeg(JPEG, (10, 10)) is None, 'not its size'
    assert jpeg.decode_jpeg(b'\xff\xd8\xff\xd9', (10, 10)) is None


@pytest.mark.parametrize('size', [(320, 240), (33, 17), (1, 1)])
def test_what_is_written_can_be_read(decoder, size):
    picture = colour_picture(*size)
    data = jpeg.encode_jpeg(picture)
    rgb, full, kind = decode_compressed('rgb8; jpeg compressed bgr8', data)
    assert (full, kind) == (size, 'jpeg')
    assert np.abs(cv2.blur(rgb, (5, 5)).astype(int) - cv2.blur(picture, (5, 5))).mean() < 6.0
    assert len(jpeg.encode_jpeg(picture, 20)) <= len(data)
    beside = cv2.imencode('.jpg', picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 80])[1]
    assert abs(len(data) - len(beside)) <= 0.02 * len(beside) + 20
    assert jpeg.encode_jpeg(picture[::-1, ::-1]), 'in whatever order it lies'


def test_a_smear_is_a_picture(decoder):
    damaged = bytearray(JPEG)
    damaged[len(JPEG) // 2:len(JPEG) // 2 + 40] = b'\x55' * 40
    rgb = decode_compressed('jpeg', bytes(damaged))[0]
    assert rgb.shape == (240, 320, 3) and np.abs(rgb[:60].astype(int) - PICTURE[:60]).mean() < 12.0


def test_decoding_in_many_threads_at_once():
    data = [encode(np.roll(PICTURE, 20 * number, 1)) for number in range(8)]
    expected = [decode_compressed('jpeg', one)[0] for one in data]
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda one: decode_compressed('jpeg', one)[0], data * 20))
    assert all(np.array_equal(one, expected[at % 8]) for at, one in enumerate(found))


def with_size(jpeg, width, height):
    place = jpeg.index(b'\xff\xc0')
    return jpeg[:place + 5] + struct.pack('>HH', height, width) + jpeg[place + 9:]


@pytest.mark.parametrize('what, data, words', [
    ('nothing', b'', 'empty'), ('text', b'hello world, hello', 'neither jpeg nor png'),
    ('half a jpeg', JPEG[:len(JPEG) // 2], 'truncated'),
    ('most of a jpeg', JPEG[:-40], 'truncated'),
    ('a jpeg head', JPEG[:30], 'truncated'), ('three bytes', JPEG[:3], 'truncated'),
    ('a jpeg without size', b'\xff\xd8\xff\xda\x00\x02\xff\xd9', 'its size'),
    ('no marker', JPEG[:20] + b'\0' * 400, 'no marker'),
    ('an absurd jpeg', with_size(JPEG, 65000, 65000), '65000 x 65000'),
    ('an empty jpeg', with_size(JPEG, 0, 10), '0 x 10'),
    ('half a png', PNG[:len(PNG) // 2], 'truncated'), ('a png head', PNG[:20], 'truncated'),
    ('an absurd png', PNG[:16] + struct.pack('>II', 1 << 30, 4) + PNG[24:], 'pixels'),
    ('a damaged png', PNG[:3000] + b'\0' * 64 + PNG[3064:], 'corrupted'),
])
def test_wrong_pictures_are_refused(what, data, words, decoder):
    with pytest.raises(FrameError, match=words):
        decode_compressed('jpeg', data)


@pytest.mark.parametrize('missing', [1, 2])
def test_a_whole_picture_without_its_end_marker_is_shown(missing, decoder):
    if decoder == 'cv2':
        with pytest.raises(FrameError, match='end marker'):
            decode_compressed('jpeg', JPEG[:-missing])
    else:
        rgb = decode_compressed('jpeg', JPEG[:-missing])[0]
        assert np.array_equal(rgb, decode_compressed('jpeg', JPEG)[0])


def test_what_cameras_add_is_ignored():
    assert read_size(JPEG + b'\0' * 100) == ('jpeg', (320, 240))
    comment = b'\xff\xfe' + struct.pack('>H', 20) + b'\xff\xd9' * 9
    assert read_size(JPEG[:2] + comment + JPEG[2:]) == ('jpeg', (320, 240))
    progressive = cv2.imencode('.jpg', PICTURE, [cv2.IMWRITE_JPEG_PROGRESSIVE, 1])[1].tobytes()
    assert decode_compressed('jpeg', progressive)[1] == (320, 240)
    assert decode_compressed('jpeg', memoryview(bytearray(JPEG)))[0].shape == (240, 320, 3)


@pytest.mark.parametrize('full, view, expected', [
    ((640, 480), (320, 480), (320, 240)), ((1, 1000), (10, 10), (1, 10))])
def test_fit(full, view, expected):
    assert fit(full, view) == expected
