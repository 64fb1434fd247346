# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera's topics, and the figures of its stream."""
import pytest

from mhri.camera.image_message import COMPRESSED_TYPE, RAW_TYPE
from mhri.camera.stream_meter import StreamMeter
from mhri.camera.transports import find_offers, may_carry, Speakers

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


OFFERS = find_offers('rgb', TOPICS, {'/bot1/a/compressed': COMPRESSED_TYPE,
                                     '/bot1/a': RAW_TYPE, '/bot1/b': RAW_TYPE})
PACKED, FIRST, SECOND = (offer.topic for offer in OFFERS)


def chosen(speakers, now, transport='auto', offers=OFFERS):
    """Return (topic to receive or None, topics to watch), and receive it."""
    offer, silent = speakers.choose(offers, transport, now)
    topic = offer and offer.topic
    if topic != getattr(speakers, 'in_test', None):
        speakers.in_test = topic
        speakers.hold(topic, now)
    return topic, [one.topic for one in silent]


def test_choice():
    for transport, topic in (('auto', PACKED), ('raw', FIRST), ('other', None)):
        assert chosen(Speakers(), 0.0, transport) == (topic, [])
    assert chosen(Speakers(), 0.0, offers=[]) == (None, [])


def test_advertised_is_not_spoken():
    speakers = Speakers()
    assert chosen(speakers, 100.0) == (PACKED, [])
    assert chosen(speakers, 101.0) == (PACKED, [])
    assert chosen(speakers, 102.0) == (FIRST, [PACKED]), 'within 3 s'
    speakers.heard(FIRST, 103.0)
    assert chosen(speakers, 110.0) == (FIRST, [PACKED])
    speakers.heard(PACKED, 110.0)
    assert chosen(speakers, 110.0) == (PACKED, []), 'back when it speaks'
    for now in range(110, 160, 8):
        speakers.heard(PACKED, now)
        assert chosen(speakers, now + 7.9) == (PACKED, []), 'a slow camera'


def test_where_all_are_silent_all_are_listened_to():
    speakers = Speakers()
    times = (100.0, 102.0, 104.0, 106.0, 200.0)
    assert [chosen(speakers, now)[0] for now in times] == [PACKED, FIRST, SECOND, SECOND, SECOND]
    assert chosen(speakers, 201.0) == (SECOND, [PACKED, FIRST])
    speakers.heard(FIRST, 202.0)
    assert chosen(speakers, 202.0) == (FIRST, [PACKED])


def test_what_cannot_be_received_is_passed_over_and_the_only_one_never():
    speakers = Speakers()
    speakers.skip(PACKED)
    assert chosen(speakers, 100.0) == (FIRST, [PACKED])
    assert chosen(speakers, 100.0, 'compressed') == (PACKED, [])


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
