# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera's topics, and the figures of its stream."""
import pytest

from mhri.camera.image_message import COMPRESSED_TYPE, RAW_TYPE
from mhri.camera.stream_meter import StreamMeter
from mhri.camera.transports import choose_offer, find_offers, may_carry

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
