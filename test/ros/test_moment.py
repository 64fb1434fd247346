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

from mhri.camera.images import FrameError
from mhri.camera.recompressed import recompressed
from mhri.graph.ros.resources import robot_types
from mhri.link.smaller import Smaller
from mhri.session.ros.moment import jpeg_of, Moment


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


def test_a_picture_that_is_too_large_for_a_jpeg_is_left_out():
    pixels = np.zeros((1, 65501, 3), np.uint8)
    message = CompressedImage(format='png', data=cv2.imencode('.png', pixels)[1].tobytes())
    data = io.BytesIO()
    message.serialize(data)
    assert jpeg_of(b'    ' + data.getvalue()) is None
    assert Smaller().fit(data.getvalue(), 100) == data.getvalue()
    raw, data = Image(height=1, width=65501, encoding='rgb8', step=3 * 65501,
                      data=pixels.tobytes()), io.BytesIO()
    raw.serialize(data)
    with pytest.raises(FrameError, match='65501'):
        recompressed(data.getvalue())
