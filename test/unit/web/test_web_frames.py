# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Frames of the page and to it: what is valid, what is refused, what is passed on."""
import json
import math
import struct

import pytest

from mhri.web.frames import BadFrame, BURST, FrameRate, RATE_HZ, read_frame
from mhri.web.said import frame, picture_frame, picture_of, placed
from support.clock import Clock


@pytest.mark.parametrize('text, found', [
    ('{"ack": 7}', ('ack', 7)), ('{"look": "bot1"}', ('look', 'bot1')),
    ('{"look": null}', ('look', None)), ('{"visible": false}', ('visible', False)),
    ('{"hold": true}', ('hold', True)), ('{"stop": true}', ('stop', True)),
    ('{"stick": [0, -1, 0.5]}', ('stick', [0, -1, 0.5])), ('{"head": [0.1, -0.2]}', (
        'head', [0.1, -0.2]))])
def test_valid_frames(text, found):
    assert read_frame(text) == found


@pytest.mark.parametrize('text', [
    '', 'null', '1', '[]', '{}', '{', '{"ack": 1, "look": null}', '{"other": 1}', '{"ack": -1}',
    '{"ack": true}', '{"ack": 1.5}', '{"ack": "1"}', '{"ack": 9007199254740993}', '{"look": 1}',
    '{"look": "%s"}' % ('x' * 101), '{"visible": 1}', '{"hold": null}', '{"stop": false}',
    '{"stick": [0, 0]}', '{"stick": [0, 0, 0, 0]}', '{"stick": [0, 0, 1.01]}',
    '{"stick": [0, 0, true]}', '{"stick": [0, 0, "1"]}', '{"stick": [0, 0, NaN]}',
    '{"stick": [0, 0, Infinity]}', '{"stick": [0, 0, 1e999]}', '{"stick": {"0": 0}}',
    '{"stick": [0, 0, 1%s]}' % ('0' * 400), '{"head": [0, 4]}', '{"head": 1}', '[' * 4000],
    ids=lambda text: text[:40])
def test_everything_else_is_refused(text):
    with pytest.raises(BadFrame):
        read_frame(text)


def test_what_a_network_held_up_is_no_flood_and_a_flood_is():
    clock = Clock()
    rate = FrameRate(clock)
    for _ in range(int(BURST)):
        rate.check()
    with pytest.raises(BadFrame):
        rate.check()
    clock.now += 3.0 / RATE_HZ
    rate.check()


def test_numbers_that_json_does_not_have_are_null_and_texts_are_bounded():
    said = json.loads(frame('state', {'a': math.nan, 'b': [math.inf, 1.23456789], 'c': 'x' * 999,
                                      'd': [0] * 999}, age_s=None))
    assert said['state']['a'] is None and said['state']['b'] == [None, 1.2346]
    assert len(said['state']['c']) <= 300 and len(said['state']['d']) == 200
    assert said['state']['age_s'] is None


def compressed(kind, data):
    """Return the bytes of a sensor_msgs/CompressedImage."""
    return struct.pack('<III', 0, 0, 0) + struct.pack('<I', 0) + b''.join(
        struct.pack('<I', len(part)) + part for part in (kind, data))


@pytest.mark.parametrize('kind, data, found', [
    (b'rgb8; jpeg compressed bgr8', b'\xff\xd8picture', ('jpeg', b'\xff\xd8picture')),
    (b'png', b'\x89PNGpicture', ('png', b'\x89PNGpicture')),
    (b'16UC1; compressedDepth png', b'x' * 12 + b'\x89PNGpicture', ('depth', b'\x89PNGpicture')),
    (b'16UC1; compressedDepth rvl', b'x' * 12 + b'rvl', None),
    (b'jpeg', b'<script>', None), (b'', b'', None)])
def test_pictures_are_passed_on_as_they_came(kind, data, found):
    assert picture_of(compressed(kind, data)) == found


def test_a_torn_picture_is_none():
    whole = compressed(b'jpeg', b'\xff\xd8picture')
    assert {picture_of(whole[:size]) for size in range(len(whole))} == {None}


def test_a_picture_has_its_header_in_front():
    data = picture_frame(7, 'bot1', '/bot1/camera', 0.1234, 'jpeg', b'\xff\xd8')
    size, = struct.unpack_from('>I', data)
    assert json.loads(data[4:4 + size].decode()) == {
        'n': 7, 'robot': 'bot1', 'topic': '/bot1/camera', 'age_s': 0.123, 'format': 'jpeg'}
    assert data[4 + size:] == b'\xff\xd8'


def test_only_robots_whose_place_is_known_are_on_the_map():
    robot = {'name': 'bot1', 'placed': True, 'x': 1.0, 'y': 2.0, 'yaw': 3.0, 'place_age_s': 4.0}
    assert placed([robot, dict(robot, placed=False)]) == [
        {'name': 'bot1', 'x': 1.0, 'y': 2.0, 'yaw': 3.0, 'age_s': 4.0}]
