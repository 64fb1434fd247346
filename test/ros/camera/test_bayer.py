# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compressed Bayer mosaics: the pixels of the raw ones, as image_transport and cv_bridge make them.

The formats are those that compressed_publisher.cpp writes.
"""
import cv2
import numpy as np
import pytest

from mhri.camera.image_message import COMPRESSED_TYPE, RawImage
from mhri.camera.images import FrameError
from mhri.camera.ros.pictures import decode_raw, read_picture
from mhri.camera.shades import Shades
from support.pictures import colour_picture, compressed_message

PICTURE = colour_picture(320, 240)
PATTERNS = ('rggb', 'bggr', 'gbrg', 'grbg')


def mosaic_of(pattern, bits):
    """Return what a sensor with a pattern sees of the picture."""
    mosaic = np.empty(PICTURE.shape[:2], np.uint8)
    for place, colour in enumerate(pattern):
        window = (slice(place // 2, None, 2), slice(place % 2, None, 2))
        mosaic[window] = PICTURE[window][..., 'rgb'.index(colour)]
    return mosaic if bits == 8 else mosaic.astype(np.uint16) << 8


def raw_of(mosaic, encoding, view=None):
    height, width = mosaic.shape
    image = RawImage(height, width, encoding, 0, 0, mosaic.tobytes())
    return Shades().rgb(decode_raw(image, view)[0], 0.0)[0]


def decode_compressed(fmt, data, view=None):
    frame, kind = read_picture('rgb', COMPRESSED_TYPE, compressed_message(fmt, data), view,
                               Shades(), 0.0)
    return frame.rgb, frame.full_size, kind


def near(rgb, other):
    """Return how far two pictures are apart on average."""
    return np.abs(rgb.astype(int) - other).mean()


@pytest.mark.parametrize('view', [None, (100, 75)])
@pytest.mark.parametrize('pattern', PATTERNS)
@pytest.mark.parametrize('bits', [8, 16])
def test_a_png_is_pixel_by_pixel_what_the_raw_mosaic_is(pattern, bits, view):
    mosaic, encoding = mosaic_of(pattern, bits), 'bayer_{}{}'.format(pattern, bits)
    data = cv2.imencode('.png', mosaic)[1].tobytes()
    rgb, full, kind = decode_compressed(encoding + '; png compressed ', data, view)
    assert (full, kind) == ((320, 240), 'png') and rgb.flags.c_contiguous
    assert np.array_equal(rgb, raw_of(mosaic, encoding, view))
    if view is None:
        assert near(rgb, PICTURE) < 6.0, 'the colours of what the sensor saw'


@pytest.mark.parametrize('view', [None, (40, 30)])
@pytest.mark.parametrize('pattern', PATTERNS)
def test_a_jpeg_is_what_its_own_mosaic_is(pattern, view):
    mosaic, encoding = mosaic_of(pattern, 8), 'bayer_{}8'.format(pattern)
    data = cv2.imencode('.jpg', mosaic, [cv2.IMWRITE_JPEG_QUALITY, 95])[1]
    rgb, full, kind = decode_compressed(encoding + '; jpeg compressed ', data.tobytes(), view)
    assert (full, kind) == ((320, 240), 'jpeg')
    assert np.array_equal(rgb, raw_of(cv2.imdecode(data, cv2.IMREAD_UNCHANGED), encoding, view))
    if view is None:
        assert near(rgb, raw_of(mosaic, encoding)) < 6.0


@pytest.mark.parametrize('ending', ['.jpg', '.png'])
def test_what_has_colours_already_is_left_alone(ending):
    data = cv2.imencode(ending, PICTURE[..., ::-1])[1].tobytes()
    rgb = decode_compressed('bayer_rggb8; jpeg compressed bgr8', data)[0]
    assert np.array_equal(rgb, decode_compressed('', data)[0])


@pytest.mark.parametrize('size', [(1, 1), (2, 1), (3, 2), (321, 243)])
def test_any_size(size):
    data = cv2.imencode('.png', np.full(size[::-1], 77, np.uint8))[1].tobytes()
    rgb = decode_compressed('bayer_grbg8; png compressed ', data)[0]
    assert rgb.shape == size[::-1] + (3,)


def test_a_damaged_one_is_refused():
    data = cv2.imencode('.png', mosaic_of('rggb', 8))[1].tobytes()
    with pytest.raises(FrameError):
        decode_compressed('bayer_rggb8; png compressed ', data[:len(data) // 2])
