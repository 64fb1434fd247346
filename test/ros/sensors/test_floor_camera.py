# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The camera above the floor: known once camera_info has come and its height is known."""
import io
from types import SimpleNamespace

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo

from mhri.base.tf_tree import OdometryFrames
from mhri.sensors.ros import floor_camera
from mhri.sensors.ros.floor_camera import FloorCameraFeed

FRAMES = OdometryFrames('base_footprint', 'odom')


class Wire:
    """Subscriptions of one feed, by topic; open ones only."""

    def __init__(self):
        self.open = {}

    def __call__(self, topic, on_bytes):
        self.open[topic] = on_bytes
        return SimpleNamespace(close=lambda: self.open.pop(topic))


@pytest.fixture
def wire(monkeypatch):
    made = Wire()
    monkeypatch.setattr(floor_camera, 'Subscription', made)
    monkeypatch.setattr(floor_camera, 'SHARED', SimpleNamespace(
        open=lambda user: None, close=lambda user: None, matrix=lambda base, frame: None,
        child_above=lambda odometry, frame: ''))
    return made


def bytes_of(**changes):
    """Return the bytes of a usable camera_info, with changes."""
    message = CameraInfo(**{**dict(width=640, height=480, K=[
        554.0, 0.0, 319.5, 0.0, 554.0, 239.5, 0.0, 0.0, 1.0]), **changes})
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def feed_of(height_m):
    """Return the feed of a robot whose type has the height of its camera."""
    return FloorCameraFeed.of('bot1', SimpleNamespace(
        rgb=('camera/rgb/image_raw',), depth_x_m=-0.1, depth_z_m=height_m), 'rgb')


def test_a_camera_by_its_type_and_no_subscription_after_the_end(wire):
    feed = feed_of(0.3)
    feed.open()
    assert list(wire.open) == ['/bot1/camera/rgb/camera_info'] and feed.take(FRAMES) is None
    wire.open['/bot1/camera/rgb/camera_info']('sensor_msgs/CameraInfo', bytes_of())
    camera = feed.take(FRAMES)
    assert camera.matrix[:3, 3].tolist() == [-0.1, 0.0, 0.3]
    assert camera.project(np.array([[0.9, 0.0]]))[0, 0] == pytest.approx(0.5)
    feed.close()
    assert not wire.open


@pytest.mark.parametrize('height_m, data', [
    (0.0, bytes_of()), (0.3, b'\x01'), (0.3, bytes_of(K=[0.0] * 9)), (0.3, bytes_of(width=0)),
    (0.3, bytes_of(K=[float('nan')] * 9))])
def test_what_is_not_known_is_not_guessed(wire, height_m, data):
    feed = feed_of(height_m)
    feed.open()
    wire.open['/bot1/camera/rgb/camera_info']('sensor_msgs/CameraInfo', data)
    assert feed.take(FRAMES) is None


def test_a_type_without_a_camera_has_none():
    assert FloorCameraFeed.of('bot1', SimpleNamespace(rgb=()), 'rgb') is None
