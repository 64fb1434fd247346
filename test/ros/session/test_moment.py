# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is noted of a moment of a session: where robots are, by what can be."""
import io
from types import SimpleNamespace

import cv2
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from sensor_msgs.msg import CompressedImage, Image

from mhri.camera.depth_codec import encode_depth
from mhri.camera.images import FrameError
from mhri.camera.ros.recompressed import recompressed
from mhri.camera.shades import Shades
from mhri.graph.ros.resources import robot_types
from mhri.link.picture_shrinker import PictureShrinker
from mhri.session.ros.moment import jpeg_of, Moment

JPEG = cv2.imencode('.jpg', np.full((12, 16, 3), 128, np.uint8))[1].tobytes()


def moment(x_m, speed_mps):
    """Return the moment of one robot that says so."""
    message, buffer = Odometry(), io.BytesIO()
    message.pose.pose.position.x, message.pose.pose.orientation.w = x_m, 1.0
    message.twist.twist.linear.x = speed_mps
    message.serialize(buffer)

    def newest(topic):
        return SimpleNamespace(fields={'type': 'nav_msgs/Odometry', 'topic': topic},
                               frame=4 * b' ' + buffer.getvalue()) if 'odom' in topic else None
    return Moment(SimpleNamespace(newest=newest),
                  SimpleNamespace(kinds={'bot1': robot_types()[0]['generic']}))


def test_a_robot_is_nowhere_by_odometry_that_cannot_be():
    assert moment(1.5, 0.3).poses() == {'bot1': [1.5, 0.0, 0.0, 'bot1/odom']}
    assert moment(1e30, 0.3).poses() == moment(1.5, 1e30).poses() == {}


def frame_of(message):
    """Return a message as the tap has it."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return SimpleNamespace(frame=4 * b' ' + buffer.getvalue())


def test_depth_is_kept_beside_the_picture():
    depth_m = np.full((60, 160), 3.0, np.float32)
    depth_m[:, :80] = 1.0
    form, data = encode_depth(depth_m)
    names = 'camera/rgb/image_raw/compressed', 'camera/depth/image_raw/compressedDepth'
    pictures = {'/bot1/' + names[0]: frame_of(CompressedImage(format='jpeg', data=JPEG)),
                '/bot1/' + names[1]: frame_of(CompressedImage(format=form, data=data)),
                '/bot2/' + names[1]: frame_of(CompressedImage(format=form, data=data[:40]))}
    kind = SimpleNamespace(rgb=(names[0].rpartition('/')[0],), depth=(names[1].rpartition('/')[0],))
    stills = dict(Moment(SimpleNamespace(pictures=lambda within_s: pictures),
                         SimpleNamespace(kinds={'bot1': kind, 'bot2': kind})).stills('m1'))
    assert list(stills) == ['stills/m1_bot1.jpg', 'stills/m1_bot1-depth.jpg']
    assert stills['stills/m1_bot1.jpg'] == JPEG
    near, far = cv2.imdecode(np.frombuffer(stills['stills/m1_bot1-depth.jpg'], np.uint8),
                             cv2.IMREAD_COLOR)[30, [20, 140]].astype(int)
    assert near[1] > 150 > near[0] and far[0] > far[1], 'yellow is near, purple is far'


def test_a_picture_that_is_too_large_for_a_jpeg_is_left_out():
    pixels = np.zeros((1, 65501, 3), np.uint8)
    message = CompressedImage(format='png', data=cv2.imencode('.png', pixels)[1].tobytes())
    data = io.BytesIO()
    message.serialize(data)
    assert jpeg_of(b'    ' + data.getvalue()) is None
    assert PictureShrinker().fit(data.getvalue(), 100) == data.getvalue()
    raw, data = Image(height=1, width=65501, encoding='rgb8', step=3 * 65501,
                      data=pixels.tobytes()), io.BytesIO()
    raw.serialize(data)
    with pytest.raises(FrameError, match='65501'):
        recompressed(data.getvalue(), 'rgb', Shades(), 0.0)
