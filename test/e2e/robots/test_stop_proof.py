# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The proof of a stop against odometry that lies, on the topics of a robot."""
import collections
import logging
import threading
import time
import unittest

from nav_msgs.msg import Odometry
import rospy

from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED
from mhri.driving.ros.drive_client import DriveClient
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.worker import Worker
from mhri.robots.ros.bot_feeds import BotFeeds
from mhri.robots.ros.robot_monitor import RobotMonitor
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('stop_proof')

PERIOD_S = 0.02
LATE_S = 0.6
NAN = float('nan')


class Torn(Odometry):
    """Bytes that are no message."""

    def serialize(self, buff):
        buff.write(20 * b'\xff')


class FakeOdometry:
    """Publishes odometry at 50 Hz, with the errors and the delay that a test sets."""

    def __init__(self, name):
        self.late_s = self.ahead_mps = 0.0
        self.kind = Odometry
        self._queue = collections.deque()
        self._done = threading.Event()
        self._publisher = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=10)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._done.wait(PERIOD_S):
            message = self.kind()
            message.header.stamp = rospy.Time.from_sec(time.time())
            message.pose.pose.orientation.w = 1.0
            message.twist.twist.linear.x = self.ahead_mps
            self._queue.append((time.monotonic(), message))
            while self._queue and time.monotonic() - self._queue[0][0] >= self.late_s:
                self._publisher.publish(self._queue.popleft()[1])

    def close(self):
        self._done.set()
        self._thread.join()
        self._publisher.unregister()


class StopProofTest(unittest.TestCase):

    number = 0

    def setUp(self):
        StopProofTest.number += 1
        self.name = 'bot{}'.format(self.number)
        self.odometry = FakeOdometry(self.name)
        self.addCleanup(self.odometry.close)
        self.listen()
        # The usual delay of this link has to be known first.
        heard = time.monotonic()
        wait_for(lambda: time.monotonic() - heard > 1.5, what='the link to be known', poll_s=0.1)

    def listen(self):
        self.link = RobotMonitor(
            self.name, robot_types()[0]['generic'], DriveClient(lambda *_: None),
            BotFeeds(self.name, robot_types()[0]['generic'], Worker('feeds').start()))
        self.addCleanup(self.link.close)
        wait_for(lambda: self.link.view().link == 'live', what='the odometry')

    def stop(self):
        self.stopped_at = time.monotonic()
        self.link.on_stop(True, self.stopped_at)

    def proof(self):
        return self.link.view().proof

    def test_one_that_says_what_cannot_be(self):
        """It is no speed of anything, counted, and said once a second at most."""
        logged = []
        handler = logging.Handler()
        handler.emit = lambda record: logged.append(record.getMessage())
        logging.getLogger('rosout').addHandler(handler)
        self.addCleanup(logging.getLogger('rosout').removeHandler, handler)
        begun, self.odometry.ahead_mps = time.monotonic(), 1e30
        self.stop()
        seen = set()

        def not_confirmed():
            seen.add(self.proof().state)
            return PROOF_NOT_CONFIRMED in seen
        wait_for(not_confirmed, what='the doubt', poll_s=0.01)
        self.assertNotIn(PROOF_STOPPED, seen)
        view = self.link.view()
        self.assertEqual((view.linear_mps, view.x_m), (None, 0.0))
        self.assertTrue(view.moving, 'nobody knows that it stands')
        refused = self.link.feeds.refused()['odometry']
        self.assertGreater(refused, 1)
        lines = [line for line in logged if 'speed of 1e+30 m/s is impossible' in line]
        self.assertTrue(0 < len(lines) <= time.monotonic() - begun + 1.0, logged)
        self.odometry.ahead_mps = 0.0
        wait_for(lambda: self.proof().state == PROOF_STOPPED, what='the proof')
        self.assertEqual(self.link.view().linear_mps, 0.0)

    def test_bytes_that_are_no_message_bring_no_motion_back(self):
        """Another subscriber asked for bytes first, so that rospy does not look at them."""
        self.link.close()
        first = rospy.Subscriber('/{}/odom'.format(self.name), rospy.AnyMsg, lambda message: None)
        self.addCleanup(first.unregister)
        self.listen()
        self.assertEqual(self.link.view().x_m, 0.0)
        self.odometry.kind = Torn
        wait_for(lambda: self.link.view().x_m is None, what='bytes that are no message')
        view = self.link.view()
        self.assertEqual((view.link, view.linear_mps, view.x_m), ('live', None, None))

    def test_one_that_is_heard_late(self):
        """What is heard first was measured before the stop."""
        self.odometry.late_s = LATE_S
        wait_for(lambda: self.link.view().age_s > LATE_S / 2, what='the delay', poll_s=0.01)
        wait_for(lambda: self.link.view().age_s < 0.1, what='the first late word', poll_s=0.001)
        self.stop()
        wait_for(lambda: self.proof().state == PROOF_STOPPED, what='the proof', poll_s=0.001)
        took_s = time.monotonic() - self.stopped_at
        print('MEASURED proof by odometry that is {:g} s late: {:.0f} ms, "{}"'.format(
            LATE_S, 1e3 * took_s, self.proof().text))
        self.assertGreater(took_s, LATE_S)
