# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera's message off the wire into a frame; its topics; its figures."""
import os
import sys

import cv2
import numpy as np
import pytest

from mhri.camera.depth_codec import encode_depth
from mhri.camera.depth_colour import DepthColour
from mhri.camera.image_message import COMPRESSED_TYPE, RAW_TYPE, read_picture
from mhri.camera.images import FrameError
from mhri.camera.stream_meter import StreamMeter
from mhri.camera.transports import choose_offer, find_offers, may_carry

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.pictures import colour_picture, compressed_message  # noqa: E402
from support.pictures import depth_picture, raw_message  # noqa: E402

RGB = colour_picture(64, 48)
MM = depth_picture(64, 48)
JPEG = compressed_message('jpeg', cv2.imencode('.jpg', RGB[..., ::-1])[1].tobytes())
RAW = raw_message('rgb8', 48, 64, RGB.tobytes(), 192)
DEPTH = compressed_message(*encode_depth(MM, 'rvl'))
RAW_DEPTH = raw_message('16UC1', 48, 64, MM.tobytes(), 128)


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
            known = np.append(MM[MM > 0] / np.float32(1000), np.float32(np.nan))
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


TOPICS = ['/bot1/a', '/bot1/b']


@pytest.mark.parametrize('kind, published, expected', [
    ('rgb', {}, []), ('rgb', {'/bot1/a': RAW_TYPE}, [('raw', '/bot1/a')]),
    ('rgb', {'/bot1/a': RAW_TYPE, '/bot1/a/compressed': COMPRESSED_TYPE},
     [('compressed', '/bot1/a/compressed'), ('raw', '/bot1/a')]),
    ('rgb', {'/bot1/b': RAW_TYPE, '/bot1/a/compressed': 'std_msgs/String'}, [('raw', '/bot1/b')]),
    ('rgb', {'/bot1/a/compressedDepth': COMPRESSED_TYPE}, []),
    ('depth', {'/bot1/a/compressed': COMPRESSED_TYPE, '/bot1/b/compressedDepth': COMPRESSED_TYPE},
     [('compressedDepth', '/bot1/b/compressedDepth')]),
])
def test_offers(kind, published, expected):
    assert find_offers(kind, TOPICS, published) == expected


def test_choice():
    offers = find_offers('rgb', TOPICS, {'/bot1/a/compressed': COMPRESSED_TYPE,
                                         '/bot1/b': RAW_TYPE})
    assert choose_offer(offers, 'auto').topic == '/bot1/a/compressed'
    assert choose_offer(offers, 'raw').topic == '/bot1/b'
    assert choose_offer(offers, 'other') is None and choose_offer([], 'auto') is None


@pytest.mark.parametrize('transport, topic, expected', [
    ('auto', '/a', True), ('raw', '/a', True), ('raw', '/a/compressed', False),
    ('compressed', '/a/compressed', True), ('compressed', '/a', False),
])
def test_which_topic_may_carry_a_transport(transport, topic, expected):
    assert may_carry('rgb', transport, topic) == expected


def test_meter():
    meter = StreamMeter()
    assert meter.read(0.0) == (0.0, 0.0)
    for index in range(90):
        meter.add(index / 30, 1000)
    rate_hz, bits_per_s = meter.read(3.0)
    assert rate_hz == pytest.approx(30.0, rel=0.02)
    assert bits_per_s == pytest.approx(240000.0, rel=0.02)
    assert meter.read(4.0)[0] < 20.0
    assert meter.read(5.1) == (0.0, 0.0)
