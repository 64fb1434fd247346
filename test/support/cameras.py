# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cameras that send one picture; as a process: ``cameras.py TOPIC``."""
import os
import sys
import threading
import unittest

import cv2
import rospy
from sensor_msgs.msg import CompressedImage, Image

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))


from support.pictures import colour_picture  # noqa: E402
from support.node_tools import Process  # noqa: E402

RGB = colour_picture(320, 240)
RATE_HZ = 30.0


def jpeg(rgb=RGB, fmt='rgb8; jpeg compressed bgr8'):
    """Return a picture as image_transport compresses it."""
    return CompressedImage(format=fmt, data=cv2.imencode('.jpg', rgb[..., ::-1])[1].tobytes())


def raw(encoding, pixels):
    """Return a picture as it is."""
    return Image(height=pixels.shape[0], width=pixels.shape[1], encoding=encoding,
                 step=pixels.strides[0], data=pixels.tobytes())


class Camera:
    """Publishes a message at 30 Hz until it is stopped; ``message`` may be changed meanwhile."""

    def __init__(self, topic, message):
        self.message = message
        self.publisher = rospy.Publisher(topic, type(message), queue_size=1)
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._done.wait(1.0 / RATE_HZ):
            self.publisher.publish(self.message)

    def stop(self):
        """Publish nothing more."""
        self._done.set()
        self._thread.join()
        self.publisher.unregister()


class CameraProcess(Process):
    """A camera in a process of its own, to be killed."""

    def __init__(self, topic, name):
        super().__init__([sys.executable, os.path.realpath(__file__), topic, '__name:=' + name])


class CameraCase(unittest.TestCase):
    """Tests that end what they began."""

    def setUp(self):
        self._begun = []

    def tearDown(self):
        for thing in reversed(self._begun):
            getattr(thing, 'stop', getattr(thing, 'end', getattr(thing, 'close', None)))()

    def begin(self, thing):
        """Return a thing that is ended after the test."""
        self._begun.append(thing)
        return thing


if __name__ == '__main__':
    rospy.init_node('camera')
    Camera(sys.argv[1], jpeg())
    rospy.spin()
