# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated camera on the graph: every topic, its rate, what it says, and its idleness."""
import unittest

import cv2
import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from mhri.base.robot_types import Limits, RobotType
from mhri.camera.depth_codec import decode_depth
from mhri.sim.camera import Camera
from mhri.sim.plan import Landmark, Plan
from mhri.sim.ros.camera_node import SimCamera
from support.heard import Heard, TIMEOUT_S
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('sim_camera')

PLAN = Plan('test', np.array([(0, 0, 4, 0), (4, 0, 4, 2), (4, 2, 0, 2), (0, 2, 0, 0)], float), 2.4,
            (220, 220, 210), (150, 140, 126),
            (Landmark('red', (204, 40, 40), 3.0, 1.0, 0.2, 1.2),), ((1.0, 1.0, 0.0),))
NOBODY = np.zeros(0, [('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                      ('colour', 'u1', 3)])
POSE = (1.0, 1.0, 0.0)
RGB, DEPTH = 'camera/rgb/image_raw', 'camera/depth/image_raw'
# A machine under load may be late for so long.
LOADED_S, OLD_S = 120.0, 60.0


class Counted:
    """Counts how often a camera is asked where it is: once for each frame that is drawn."""

    def __init__(self):
        self.frames = 0

    def __call__(self):
        self.frames += 1
        return POSE


class SimCameraTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        camera = Camera(PLAN)
        view = camera.look(*POSE, NOBODY)
        cls.rgb, cls.depth = camera.rgb(view), camera.depth(view)

    def start(self, name, depth_format='png', rgb=(RGB,), depth=(DEPTH,)):
        """Start a camera; return what counts its frames."""
        template = RobotType('test', 'test', 'turtlebot', Limits(1.0, 1.0), rgb=rgb, depth=depth)
        counted = Counted()
        camera = SimCamera(name, template, PLAN, counted, lambda: NOBODY, depth_format)
        camera.start()
        self.addCleanup(camera.stop)
        return counted

    def hear(self, topic, message_class):
        heard = Heard(topic, message_class)
        self.addCleanup(heard.close)
        return heard

    def check_header(self, message, name):
        self.assertEqual(message.header.frame_id, name + '/camera_rgb_optical_frame')
        self.assertLess(abs((rospy.Time.now() - message.header.stamp).to_sec()), OLD_S)

    def test_raw(self):
        self.start('raw')
        for topic, encoding, pixels in ((RGB, 'rgb8', self.rgb), (DEPTH, '16UC1', self.depth)):
            message = self.hear('/raw/' + topic, Image).wait(1)[0][1]
            self.check_header(message, 'raw')
            self.assertEqual((message.width, message.height, message.encoding, message.step),
                             (640, 480, encoding, 640 * pixels.itemsize * (
                                 3 if pixels.ndim == 3 else 1)))
            self.assertEqual(message.data, pixels.tobytes())

    def test_jpeg(self):
        self.start('jpeg')
        message = self.hear('/jpeg/' + RGB + '/compressed', CompressedImage).wait(1)[0][1]
        self.check_header(message, 'jpeg')
        self.assertEqual(message.format, 'rgb8; jpeg compressed bgr8')
        found = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
        self.assertLess(np.abs(found.astype(int) - self.rgb).mean(), 3.0)
        red, green, blue = found[240, 320]
        self.assertTrue(red > 2 * green and red > 2 * blue)

    def test_compressed_depth_is_exact(self):
        for codec in ('png', 'rvl'):
            self.start(codec, codec)
            message = self.hear('/{}/{}/compressedDepth'.format(codec, DEPTH),
                                CompressedImage).wait(1)[0][1]
            self.check_header(message, codec)
            self.assertEqual(message.format, '16UC1; compressedDepth ' + codec)
            metres, _, transport = decode_depth(message.format, message.data)
            self.assertEqual(transport, 'compressedDepth ' + codec)
            np.testing.assert_array_equal(np.rint(np.nan_to_num(metres) * 1000.0), self.depth)

    def test_nobody_there_nothing_drawn(self):
        counted = self.start('idle')
        info = self.hear('/idle/camera/rgb/camera_info', CameraInfo)
        info.wait(10)
        self.assertEqual(counted.frames, 0)
        picture = self.hear('/idle/' + RGB, Image)
        picture.wait(2)
        picture.close()

        def rests():
            before = counted.frames
            info.wait(10)
            return counted.frames == before
        wait_for(rests, TIMEOUT_S, 'the camera to rest')
