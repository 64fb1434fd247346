# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pictures that a screen passes on to its readers: as they come, and compressed if raw."""
import io

import numpy as np
import pytest
import rospy
from sensor_msgs.msg import CompressedImage, Image

from mhri.camera.ros.picture_relay import PictureRelay
from mhri.camera.ros.pictures import read_depth, read_picture
from mhri.camera.shades import Shades

RED = np.full((48, 64, 3), (200, 40, 30), np.uint8)


class Publisher:
    """Keeps what is published."""

    def __init__(self):
        self.said = []

    def get_num_connections(self):
        return 1

    def publish(self, topic, picture):
        self.said.append((topic, picture))

    def unregister(self):
        self.said.append(None)


def wire(message):
    message.header.seq, message.header.stamp = 7, rospy.Time(12, 34)
    message.header.frame_id = 'lens'
    buffer = io.BytesIO()
    message.serialize(buffer)
    return message._type, buffer.getvalue()


def raw(encoding, pixels):
    return wire(Image(height=48, width=64, encoding=encoding, step=pixels.nbytes // 48,
                      data=pixels.tobytes()))


class Screen:
    """A camera's subscription, its clock, and what is passed on at so many pictures a second."""

    def __init__(self, hz=-1.0, kind='rgb'):
        self.now, self.received, self.publisher = 100.0, [], Publisher()
        self.relay = PictureRelay(lambda: self.now, lambda: self.publisher)
        self.relay.open()
        self.relay.limit('recorder', hz)
        self.receive = self.relay.relaying(
            '/a/image', lambda *message: self.received.append(message), kind)

    def topics(self, picture, period_s, count=20):
        for _ in range(count):
            self.receive(*picture)
            self.now += period_s
        return [topic for topic, _ in self.publisher.said]


def message_of(picture):
    message = CompressedImage()
    message.deserialize(picture)
    return message


def test_compressed_pictures_are_passed_on_as_they_come():
    screen, picture = Screen(), wire(CompressedImage(format='jpeg', data=b'\xff\xd8'))
    assert screen.topics(picture, 0.03) == ['/a/image'] * 20
    assert screen.publisher.said[0][1] == picture[1] and len(screen.received) == 20


def test_raw_pictures_become_jpegs_of_the_same_stamp_and_few_of_them():
    screen = Screen()
    assert screen.topics(raw('rgb8', RED), 0.03, 60) == ['/a/image/compressed'] * 10
    picture = screen.publisher.said[0][1]
    header = message_of(picture).header
    assert (header.stamp, header.frame_id) == (rospy.Time(12, 34), 'lens')
    frame, transport = read_picture('rgb', CompressedImage._type, picture, None, Shades(), 0.0)
    assert transport == 'jpeg' and np.abs(frame.rgb.astype(int) - RED).max() < 12
    assert len(screen.received) == 60, 'the screen sees them all'


def test_fewer_raw_pictures_where_the_recorder_keeps_fewer():
    assert len(Screen(2.0).topics(raw('mono8', RED[:, :, 0]), 0.1, 20)) == 4
    assert Screen(0.0).topics(raw('rgb8', RED), 0.1) == []


@pytest.mark.parametrize('encoding, dtype, scale', [('16UC1', '<u2', 1000.0), ('32FC1', '<f4', 1)])
def test_raw_depth_stays_depth(encoding, dtype, scale):
    metres = np.linspace(0.4, 60.0, 48 * 64).reshape(48, 64)
    metres[0, 0] = 0.0
    screen = Screen(kind='depth')
    assert screen.topics(raw(encoding, (metres * scale).astype(dtype)), 1.0, 1) == [
        '/a/image/compressedDepth']
    depth, _, transport = read_depth(CompressedImage._type, screen.publisher.said[0][1])
    assert transport == 'compressedDepth png' and np.isnan(depth[0, 0])
    assert np.nanmax(np.abs(depth - metres)) < 0.0011


def test_what_a_thermal_camera_sends_becomes_a_jpeg_of_its_shades():
    screen = Screen()
    kelvin = np.linspace(7200, 8100, 48 * 64).reshape(48, 64).astype('<u2')
    assert screen.topics(raw('16UC1', kelvin), 1.0, 1) == ['/a/image/compressed']
    frame, _ = read_picture('rgb', CompressedImage._type, screen.publisher.said[0][1], None,
                            Shades(), 0.0)
    assert frame.rgb.min() < 10 and frame.rgb.max() > 245


def test_what_cannot_be_decoded_is_left_out():
    screen = Screen()
    assert screen.topics(raw('strange', RED), 1.0) == []
    assert screen.topics(wire(Image(height=9, width=9, encoding='rgb8', step=27)), 1.0) == []
    screen.relay.limit('recorder', 0.0)
    assert screen.topics(raw('rgb8', RED), 1.0) == []
    assert len(screen.received) == 60


JPEG = CompressedImage(format='jpeg', data=b'\xff\xd8')


@pytest.mark.parametrize('recorder, web, of_robots, a_second', [
    (2.0, 5.0, {}, 5), (5.0, 2.0, {}, 5), (0.0, 0.0, {}, 0), (0.0, 5.0, {}, 5), (-1.0, 5.0, {}, 30),
    (2.0, 5.0, {'a': 15.0}, 15), (2.0, 5.0, {'b': 15.0}, 5), (2.0, 0.0, {'a': 15.0}, 15)])
def test_the_reader_that_wants_most_of_a_camera_counts(recorder, web, of_robots, a_second):
    screen = Screen(recorder)
    screen.relay.limit('web', web, of_robots)
    relayed = len(screen.topics(wire(JPEG), 1.0 / 30.0, 300)) / 10.0
    assert a_second <= relayed <= 1.15 * a_second


def test_the_wish_of_a_reader_that_has_gone_no_longer_counts():
    screen = Screen(0.0)
    screen.relay.limit('web', 5.0, {'a': 15.0})
    screen.relay.limit('web', 0.0)
    assert screen.topics(wire(JPEG), 0.1) == []


def test_a_raw_picture_has_the_name_under_which_it_is_relayed():
    screen = Screen()
    assert screen.relay.name_of('/a/image') == '/a/image'
    screen.topics(raw('rgb8', RED), 1.0, 1)
    assert screen.relay.name_of('/a/image') == '/a/image/compressed'


def test_the_relay_ends_with_the_last_screen_that_uses_it():
    screen = Screen()
    screen.relay.open()
    screen.relay.close()
    assert screen.topics(wire(JPEG), 1.0, 2) == ['/a/image'] * 2
    screen.relay.close()
    assert screen.publisher.said[-1] is None
    screen.receive(*wire(JPEG))
    assert len(screen.publisher.said) == 3 and len(screen.received) == 3
