# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cloud feeds against real publishers: clouds, depth pictures, none, lies; and the simulator's."""
import threading
import unittest

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, PointCloud2, PointField

from mhri.base.robot_types import Limits, RobotType
from mhri.camera.depth_codec import encode_depth
from mhri.sensors.point_cloud import from_depth, Lens
from mhri.sensors.ros.cloud_feed import CloudFeed
from mhri.sim.camera import Camera
from mhri.sim.plan import Landmark, Plan
from mhri.sim.ros.camera_node import camera_info, SimCamera
from support.clouds import laid_out, XYZ
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('cloud_feed')

TIMEOUT_S = 30.0
POINTS = np.array([(1, 2, 3), (4, 5, 6), (7, 8, 9)], 'f4')
PLAN = Plan('test', np.array([(0, 0, 4, 0), (4, 0, 4, 2), (4, 2, 0, 2), (0, 2, 0, 0)], float), 2.4,
            (220, 220, 210), (150, 140, 126),
            (Landmark('red', (204, 40, 40), 3.0, 1.0, 0.2, 1.2),), ((1.0, 1.0, 0.0),))
NOBODY = np.zeros(0, [('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                      ('colour', 'u1', 3)])
POSE = (1.0, 1.0, 0.0)
DEPTH = 'camera/depth/image_raw'


def cloud_message(**changes):
    fields, width, height, point_step, row_step, data = laid_out(
        dict(zip('xyz', POINTS.T), rgb=[1, 2, 3]), XYZ + (('rgb', 'u4'),))
    message = PointCloud2(
        fields=[PointField(*field) for field in fields], width=width, height=height,
        point_step=point_step, row_step=row_step, data=data)
    message.header.frame_id = 'laser'
    for key, value in changes.items():
        setattr(message, key, value)
    return message


class Speaker:
    """Publishes messages at 10 Hz until it is stopped: {topic: message}."""

    def __init__(self, messages):
        self.messages = messages
        self.publishers = {topic: rospy.Publisher(topic, type(message), queue_size=1)
                           for topic, message in messages.items()}
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._done.wait(0.1):
            for topic, publisher in self.publishers.items():
                publisher.publish(self.messages[topic])

    def connections(self):
        return sum(publisher.get_num_connections() for publisher in self.publishers.values())

    def stop(self):
        self._done.set()
        self._thread.join()
        for publisher in self.publishers.values():
            publisher.unregister()


class CloudFeedTest(unittest.TestCase):

    def speak(self, **messages):
        """Publish; the names have __ for /."""
        speaker = Speaker({'/' + name.replace('__', '/'): message
                           for name, message in messages.items()})
        self.addCleanup(speaker.stop)
        return speaker

    def feed(self, robot, clouds=('points',), depths=(DEPTH,)):
        feed = CloudFeed(robot, clouds, depths)
        self.addCleanup(feed.close, 5.0)
        feed.open()
        return feed

    def test_a_cloud(self):
        self.speak(plain__points=cloud_message())
        feed = self.feed('plain')
        cloud = wait_for(feed.take, TIMEOUT_S, 'a cloud')
        np.testing.assert_array_equal(cloud.points, POINTS)
        self.assertEqual(cloud.colours.tolist(), [0xff000001, 0xff000002, 0xff000003])
        self.assertFalse(cloud.optical)
        wait_for(lambda: feed.status().bits_per_s > 0.0, TIMEOUT_S, 'figures of the stream')
        status = feed.status()
        self.assertEqual((status.transport, status.bad, status.problem), ('cloud', 0, ''))
        self.assertLess(feed.age_s(), TIMEOUT_S)

    def test_depth_pictures_with_their_lens(self):
        camera = Camera(PLAN)
        depth_mm = camera.depth(camera.look(*POSE, NOBODY))
        info, (width, height) = camera_info(), depth_mm.shape[::-1]
        wanted = from_depth(np.where(depth_mm > 0, depth_mm / np.float32(1000), np.nan).astype(
            'f4'), Lens(info.K[0], info.K[4], info.K[2], info.K[5], width, height)).points
        metres = np.where(depth_mm > 0, depth_mm * np.float32(0.001), np.nan).astype('f4')
        fmt, data = encode_depth(depth_mm, 'png')
        for robot, ending, message, transport in (
                ('metres', '', Image(height=height, width=width, encoding='32FC1',
                                     step=4 * width, data=metres.tobytes()), 'raw'),
                ('packed', '__compressedDepth', CompressedImage(format=fmt, data=data),
                 'compressedDepth png')):
            with self.subTest(robot):
                self.speak(**{robot + '__camera__depth__image_raw' + ending: message,
                              robot + '__camera__depth__camera_info': info})
                feed = self.feed(robot)
                cloud = wait_for(feed.take, TIMEOUT_S, 'a cloud of ' + robot)
                np.testing.assert_allclose(cloud.points, wanted, atol=1e-5)
                self.assertTrue(cloud.optical)
                self.assertEqual(feed.status().transport, transport)

    def test_a_lens_that_is_none(self):
        image = Image(height=1, width=1, encoding='16UC1', step=2, data=b'\1\1')
        self.speak(blind__camera__depth__image_raw=image,
                   blind__camera__depth__camera_info=CameraInfo())
        feed = self.feed('blind')
        wait_for(lambda: feed.status().problem and feed.status().bad, TIMEOUT_S, 'the reason')
        self.assertIsNone(feed.take())

    def test_depth_without_a_lens_is_no_offer(self):
        self.speak(lensless__camera__depth__image_raw=Image())
        feed = self.feed('lensless')
        wait_for(lambda: 'nobody publishes' in feed.status().detail, TIMEOUT_S, 'the reason')

    def test_clouds_come_before_depth(self):
        image = Image(height=1, width=1, encoding='16UC1', step=2, data=b'\1\1')
        self.speak(both__camera__depth__image_raw=image,
                   both__camera__depth__camera_info=camera_info())
        feed = self.feed('both')
        wait_for(lambda: feed.take() and feed.status().transport == 'raw', TIMEOUT_S, 'depth')
        self.speak(both__points=cloud_message())
        wait_for(lambda: feed.take() and feed.status().transport == 'cloud', TIMEOUT_S,
                 'the cloud, as soon as it is there')

    def test_lies_are_counted_and_named_and_the_next_is_read(self):
        speaker = self.speak(liar__points=cloud_message())
        feed = self.feed('liar')
        wait_for(feed.take, TIMEOUT_S, 'a cloud')
        for changes in ({'width': 2 ** 31}, {'fields': []}):
            before = feed.status().bad
            speaker.messages['/liar/points'] = cloud_message(**changes)
            wait_for(lambda: feed.status().problem and feed.status().bad > before + 1, TIMEOUT_S,
                     'the refusal')
        wait_for(lambda: feed.status().stale, TIMEOUT_S, 'stale')
        speaker.messages['/liar/points'] = cloud_message()
        wait_for(lambda: not feed.status().stale, TIMEOUT_S, 'a good one')

    def test_closed_it_takes_nothing(self):
        speaker = self.speak(quiet__points=cloud_message())
        feed = self.feed('quiet')
        wait_for(feed.take, TIMEOUT_S, 'a cloud')
        feed.close()
        wait_for(lambda: speaker.connections() == 0, TIMEOUT_S, 'the end of the connection')
        self.assertIsNone(feed.take())

    def test_the_simulators_cloud_is_what_its_pictures_show(self):
        template = RobotType('test', 'test', 'turtlebot', Limits(1.0, 1.0), rgb=('rgb/image_raw',),
                             depth=(DEPTH,), cloud=('camera/depth/points',))
        drawn = []

        def pose():
            drawn.append(True)
            return POSE
        simulated = SimCamera('simulated', template, PLAN, pose, lambda: NOBODY)
        simulated.start()
        self.addCleanup(simulated.stop)
        self.assertIn(['/simulated/camera/depth/points', 'sensor_msgs/PointCloud2'],
                      rospy.get_published_topics('/simulated'))
        self.assertEqual(drawn, [])
        feed = self.feed('simulated', template.cloud, template.depth)
        cloud = wait_for(feed.take, TIMEOUT_S, 'a cloud')
        camera = Camera(PLAN)
        view = camera.look(*POSE, NOBODY)
        depth, rgb = camera.depth(view), camera.rgb(view)
        self.assertEqual((cloud.sent, cloud.optical), (640 * 480, True))
        np.testing.assert_allclose(cloud.points[:, 2], depth[depth > 0] / 1000.0, atol=1e-4)
        red, green, blue = rgb[depth > 0].astype('u4').T
        np.testing.assert_array_equal(cloud.colours, 0xff000000 | red << 16 | green << 8 | blue)
        # The wall ahead is 3 m away, the floor 0.3 m below.
        self.assertAlmostEqual(float(cloud.points[:, 2].max()), 3.0, delta=0.01)
        self.assertAlmostEqual(float(cloud.points[:, 1].max()), 0.3, delta=0.01)
        feed.close(5.0)

        def rests():
            before = len(drawn)
            rospy.rostime.wallsleep(0.5)
            return len(drawn) == before
        wait_for(rests, TIMEOUT_S, 'the camera to rest')
