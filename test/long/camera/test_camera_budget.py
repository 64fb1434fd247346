# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The camera budget against real publishers: what it takes of them is counted where it is sent."""
import time

import rosgraph
import rospy

from mhri.camera.budget import (
    AS_IT_COMES, DRIVEN, Grant, SAMPLED_HZ, UNSEEN)
from mhri.camera.ros.camera_budget import CameraBudget, PictureRequest
from mhri.camera.ros.camera_feed import CameraFeed
from mhri.screen.settings import PanelSettings
from support.cameras import Camera, CameraCase, jpeg, raw, RATE_HZ, RGB
from support.own_node import own_node
from support.ros_system import wait_for
from support.node_tools import measured

system = own_node('camera_budget')

TOPIC = '/{}/camera/image_raw/compressed'
# No thinned picture comes so often.
FASTER_HZ = SAMPLED_HZ[0] + 1.0


class CountedCamera(Camera):
    """A camera that counts the pictures which left for somebody."""

    def __init__(self, robot):
        self.sent = 0
        super().__init__(TOPIC.format(robot), jpeg())

    def connections(self):
        return self.publisher.get_num_connections()

    def _run(self):
        while not self._done.wait(1.0 / RATE_HZ):
            self.sent += self.connections() > 0
            self.publisher.publish(self.message)


class CameraBudgetTest(CameraCase):

    def feed(self, robot, grant=AS_IT_COMES, **more):
        feed = self.begin(CameraFeed(robot, ['camera/image_raw'], 'rgb', **more))
        feed.grant(grant)
        feed.open()
        return feed

    def pictures(self, feed, count):
        """Take so many pictures; return how many came in a second [Hz]."""
        wait_for(feed.take, 20.0, 'a picture')
        begun = time.monotonic()
        for _ in range(count):
            wait_for(feed.take, 20.0, 'the next picture')
        return count / (time.monotonic() - begun)

    def test_what_nobody_can_see_is_not_sent(self):
        camera = self.begin(CountedCamera('unseen'))
        feed = self.feed('unseen')
        budget = CameraBudget(PanelSettings)
        seen = PictureRequest('unseen', DRIVEN, feed)
        self.assertEqual(budget.settle([seen]), {'unseen': AS_IT_COMES})
        wait_for(feed.take, 10.0, 'a picture')
        begun = time.monotonic()
        self.assertEqual(budget.settle([seen._replace(visible=False)]), {'unseen': UNSEEN})
        wait_for(lambda: camera.connections() == 0, 10.0, 'no listener')
        took_s = measured('unseen until the camera has no listener', time.monotonic() - begun)
        self.assertLess(took_s, 5.0)
        wait_for(lambda: feed.status().bits_per_s == 0.0, 10.0, 'no bits')
        sent = camera.sent
        self.assertIsNone(wait_for(lambda: feed.status().age_s > 3.0, 10.0) and feed.take())
        self.assertEqual(camera.sent, sent)
        budget.settle([seen])
        begun = time.monotonic()
        wait_for(feed.take, 10.0, 'a picture again')
        measured('seen again until its picture', time.monotonic() - begun)

    def test_one_picture_at_a_time(self):
        camera = self.begin(CountedCamera('thin'))
        feed = self.feed('thin', Grant(0.0, words='paused'))
        self.assertEqual(feed.status().problem, 'paused')
        feed.grant(Grant(4.0, True, words='thinned'))
        wait_for(feed.take, 10.0, 'a picture')
        wait_for(lambda: 0.5 < (feed.figures().native_hz or 0.0) / RATE_HZ < 2.0, 10.0, 'its rate')
        wait_for(lambda: 0.8 < (feed.figures().bits or 0.0) / (8 * len(jpeg().data)) < 1.2, 10.0,
                 'the size of its pictures')
        sent = camera.sent
        rate_hz = self.pictures(feed, 20)
        each = (camera.sent - sent) / 20
        print('MEASURED asked for 4 Hz of 30: {:.2f} Hz, {:.1f} sent for each'.format(
            rate_hz, each))
        self.assertLess(rate_hz, 5.0)
        self.assertLess(each, RATE_HZ / 4.0)
        status = wait_for(lambda: not feed.status().stale and feed.status(), 10.0, 'a fresh one')
        self.assertEqual((status.thinned, status.problem), ('thinned', ''))
        self.assertLess(status.rate_hz, 6.0)
        heard = dict(rosgraph.Master('/test').getSystemState()[1])
        self.assertNotIn(rospy.get_name(), heard.get(TOPIC.format('thin'), ()))
        # A slow rate is no silence; and it is fetched at once when another is granted.
        feed.grant(Grant(0.2, True))
        wait_for(feed.take, 10.0, 'the first of the slow ones')
        wait_for(lambda: feed.status().age_s > 2.5, 10.0)
        self.assertFalse(feed.status().stale)
        begun = time.monotonic()
        feed.grant(AS_IT_COMES)
        wait_for(feed.take, 10.0, 'a picture as it comes')
        measured('from one in 5 s to all: the first', time.monotonic() - begun)
        wait_for(lambda: feed.status().rate_hz > FASTER_HZ, 10.0, 'all pictures')

    def test_compressed_instead_of_what_was_chosen(self):
        self.begin(Camera('/heavy/camera/image_raw', raw('rgb8', RGB)))
        self.begin(CountedCamera('heavy'))
        feed = self.feed('heavy', transport='raw')
        wait_for(lambda: feed.take() and feed.status().transport == 'raw', 10.0, 'raw as chosen')
        self.assertTrue(feed.figures().heavy)
        feed.grant(Grant(None, False, True))
        wait_for(lambda: feed.take() and feed.status().transport == 'jpeg', 10.0, 'compressed')
        self.assertFalse(feed.figures().heavy)
        feed.grant(AS_IT_COMES)
        wait_for(lambda: feed.take() and feed.status().transport == 'raw', 10.0, 'raw again')
