#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated camera on the graph: every topic, its rate, what it says, and its idleness."""
import os
import sys
import threading
import time
import unittest

import cv2
import numpy as np
import rospy
import rostest
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.base.robot_types import Limits, RobotType  # noqa: E402
from mhri.camera.depth_codec import decode_depth  # noqa: E402
from mhri.sim.camera import Camera  # noqa: E402
from mhri.sim.plan import Landmark, Plan  # noqa: E402
from mhri.sim.ros.camera_node import SimCamera  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

PLAN = Plan('test', np.array([(0, 0, 4, 0), (4, 0, 4, 2), (4, 2, 0, 2), (0, 2, 0, 0)], float), 2.4,
            (220, 220, 210), (150, 140, 126),
            (Landmark('red', (204, 40, 40), 3.0, 1.0, 0.2, 1.2),), ((1.0, 1.0, 0.0),))
NOBODY = np.zeros(0, [('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                      ('colour', 'u1', 3)])
POSE = (1.0, 1.0, 0.0)
RGB, DEPTH = 'camera/rgb/image_raw', 'camera/depth/image_raw'
PATIENCE_S = 20.0
# A machine under load may be late for so long.
LOADED_S, OLD_S = 60.0, 10.0


class Heard:
    """The messages of a topic."""

    def __init__(self, topic, message_class):
        self._changed = threading.Condition()
        self.messages = []
        self._subscriber = rospy.Subscriber(topic, message_class, self._on_message, queue_size=5,
                                            buff_size=2 ** 24, tcp_nodelay=True)

    def _on_message(self, message):
        with self._changed:
            self.messages.append((time.monotonic(), message))
            self._changed.notify_all()

    def wait(self, count, begin=None):
        """Return so many more messages, or those after the first ``begin``, and when each came."""
        with self._changed:
            begin = len(self.messages) if begin is None else begin
            assert self._changed.wait_for(
                lambda: len(self.messages) >= begin + count, PATIENCE_S), 'too few messages'
            return self.messages[begin:begin + count]

    def rate_hz(self, wanted, begin):
        """Return the rate of two seconds of messages, after the first ``begin``."""
        found = self.wait(int(2 * wanted) + 1, begin)
        rate = (len(found) - 1) / (found[-1][0] - found[0][0])
        print('MEASURED camera: {:.1f} Hz of {:g}'.format(rate, wanted), flush=True)
        return rate

    def close(self):
        self._subscriber.unregister()


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
        rospy.init_node('sim_camera_test')
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

    def test_camera_info(self):
        counted = self.start('info')
        for topic in (RGB, DEPTH):
            topic = '/info/' + topic.rpartition('/')[0] + '/camera_info'
            message = self.hear(topic, CameraInfo).wait(1)[0][1]
            self.check_header(message, 'info')
            self.assertEqual((message.width, message.height, message.distortion_model),
                             (640, 480, 'plumb_bob'))
            self.assertAlmostEqual(message.K[0], 554.256, 3)
            self.assertEqual(message.K[2:6:3], (319.5, 239.5))
            self.assertEqual(list(message.D), [0.0] * 5)
            self.assertEqual(message.P[0], message.K[0])
        self.assertEqual(counted.frames, 0, 'nobody wanted a picture')

    def test_depth_is_of_the_moment_of_a_colour_picture(self):
        self.start('both')
        depth = self.hear('/both/' + DEPTH, Image)
        rgb = self.hear('/both/' + RGB, Image)
        rgb.wait(1)
        depth.wait(3)
        stamp = depth.wait(1)[0][1].header.stamp
        rgb.wait(2)
        self.assertIn(stamp, [message.header.stamp for _, message in rgb.messages])

    def test_rates(self):
        self.start('rate')
        heard = [(self.hear('/rate/' + RGB + '/compressed', CompressedImage), 30.0),
                 (self.hear('/rate/' + DEPTH + '/compressedDepth', CompressedImage), 15.0)]
        for stream, _ in heard:
            stream.wait(1)
        wrong = heard

        def right():
            """Measure what was not right so far, over the same time; tell whether all is."""
            begun = [(stream, wanted, len(stream.messages)) for stream, wanted in wrong]
            wrong[:] = [(stream, wanted) for stream, wanted, begin in begun
                        if abs(stream.rate_hz(wanted, begin) / wanted - 1.0) >= 0.15]
            return not wrong
        wait_for(right, LOADED_S, lambda: 'cameras at {} Hz'.format(
            [wanted for _, wanted in wrong]))

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
        wait_for(rests, PATIENCE_S, 'the camera to rest')

    def test_only_what_the_template_has(self):
        self.start('colour', depth=())
        self.start('nothing', rgb=(), depth=())
        self.hear('/colour/' + RGB, Image).wait(1)
        topics = [topic for topic, _ in rospy.get_published_topics('/colour')]
        self.assertEqual(sorted(topics), ['/colour/camera/rgb/camera_info', '/colour/' + RGB,
                                          '/colour/' + RGB + '/compressed'])
        self.assertEqual(rospy.get_published_topics('/nothing'), [])

    def test_topics_that_close_at_the_end_are_no_fault(self):
        """Rospy closes them before it says that it is shut down, whatever is being drawn."""
        slips, ended = [], threading.Event()
        self.addCleanup(setattr, threading, 'excepthook', threading.excepthook)
        threading.excepthook = slips.append
        template = RobotType('test', 'test', 'turtlebot', Limits(1.0, 1.0), rgb=(RGB,))

        def pose():
            camera.stop()
            ended.set()
            raise rospy.ROSException('publish() to a closed topic')
        camera = SimCamera('ending', template, PLAN, pose, lambda: NOBODY)
        camera.start()
        self.hear('/ending/' + RGB, Image)
        self.assertTrue(ended.wait(PATIENCE_S))
        wait_for(lambda: 'camera' not in [thread.name for thread in threading.enumerate()],
                 PATIENCE_S, 'the end of the thread')
        self.assertEqual(slips, [])

    def test_stop_waits_for_the_frame_under_way(self):
        drawing, finished = threading.Event(), []
        template = RobotType('test', 'test', 'turtlebot', Limits(1.0, 1.0), rgb=(RGB,))

        def pose():
            drawing.set()
            rospy.rostime.wallsleep(0.1)
            finished.append(True)
            return POSE
        camera = SimCamera('stopping', template, PLAN, pose, lambda: NOBODY)
        camera.start()
        self.hear('/stopping/' + RGB, Image)
        self.assertTrue(drawing.wait(PATIENCE_S))
        camera.stop()
        before = len(finished)
        self.assertGreater(before, 0)
        rospy.rostime.wallsleep(0.3)
        self.assertEqual(len(finished), before)

    def test_other_depth_format_is_refused(self):
        with self.assertRaisesRegex(ValueError, 'png, rvl'):
            self.start('odd', 'zip')


if __name__ == '__main__':
    rostest.rosrun('mhri', 'sim_camera', SimCameraTest)
