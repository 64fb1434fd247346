# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the rules, which know no ROS, believe of messages is what ROS writes."""
import io

from sensor_msgs.msg import CompressedImage, Image

from mhri.camera.image_message import read_compressed, read_raw
from mhri.msg import PanelRequest
from mhri.screen import requests


def on_the_wire(message):
    message.header.frame_id = 'some_camera'
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def test_pictures():
    assert read_compressed(on_the_wire(CompressedImage(format='jpeg', data=b'1234'))) == (
        'jpeg', b'1234')
    assert read_raw(on_the_wire(Image(height=1, width=2, encoding='mono8', is_bigendian=1, step=4,
                                      data=b'5678'))) == (1, 2, 'mono8', 1, 4, b'5678')


def test_actions_of_requests():
    assert set(requests.ACTIONS) == {value for name, value in vars(PanelRequest).items()
                                     if name.isupper() and isinstance(value, str)}
