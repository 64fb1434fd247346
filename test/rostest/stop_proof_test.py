#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The proof of a stop against odometry that lies, on the topics of a robot."""
import collections
import logging
import os
import sys
import threading
import time
import unittest

from nav_msgs.msg import Odometry
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED  # noqa: E402
from mhri.driving.ros.gates_client import GatesClient  # noqa: E402
from mhri.graph.ros.resources import robot_types  # noqa: E402
from mhri.graph.ros.worker import Worker  # noqa: E402
from mhri.msg import RobotGate  # noqa: E402
from mhri.robots.ros.bot_feeds import BotFeeds  # noqa: E402
from mhri.robots.ros.robot_link import RobotLink  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

PERIOD_S = 0.02
LATE_S = 0.6
NAN = float('nan')


class Teller:
    """A robot's odometry at 50 Hz: as it is told to lie, on time or late."""

    def __init__(self, name):
        self.sideways_mps = self.creeps_mps = self.late_s = self.ahead_mps = 0.0
        self.x = 0.0
        self._queue = collections.deque()
        self._done = threading.Event()
        self._publisher = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=10)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._done.wait(PERIOD_S):
            self.x += self.creeps_mps * PERIOD_S
            message = Odometry()
            message.header.stamp = rospy.Time.from_sec(time.time())
            message.pose.pose.position.x = self.x
            message.pose.pose.orientation.w = 1.0
            message.twist.twist.linear.x = self.ahead_mps
            message.twist.twist.linear.y = self.sideways_mps
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
        self.teller = Teller(self.name)
        self.addCleanup(self.teller.close)
        self.link = RobotLink(
            self.name, robot_types()[0]['generic'], GatesClient(lambda *_: None),
            BotFeeds(self.name, robot_types()[0]['generic'], Worker('feeds').start()))
        self.addCleanup(self.link.close)
        wait_for(lambda: self.link.view().link == 'live', what='the odometry')
        # What is usual on this link has to be known first.
        heard = time.monotonic()
        wait_for(lambda: time.monotonic() - heard > 1.5, what='the link to be known', poll_s=0.1)

    def stop(self):
        self.stopped_at = time.monotonic()
        self.link.on_stop(True, self.stopped_at)

    def proof(self):
        return self.link.view().proof

    def test_a_robot_at_rest(self):
        self.stop()
        wait_for(lambda: self.proof().state == PROOF_STOPPED, what='the proof')
        print('MEASURED proof of a robot at rest: {:.0f} ms, "{}"'.format(
            1e3 * (time.monotonic() - self.stopped_at), self.proof().text))

    def refuted(self, words):
        """Look on until it is said that the stop is not confirmed; it was never said to be."""
        seen = set()

        def not_confirmed():
            proof = self.proof()
            seen.add(proof.state)
            return proof.state == PROOF_NOT_CONFIRMED and proof.text
        self.assertIn(words, wait_for(not_confirmed, what='the doubt', poll_s=0.01))
        self.assertNotIn(PROOF_STOPPED, seen)

    def test_one_that_slides(self):
        self.teller.sideways_mps = 0.5
        self.stop()
        self.refuted('moves at 0.50 m/s')

    def test_one_that_says_rest_and_moves(self):
        self.teller.creeps_mps = 0.5
        self.stop()
        self.refuted('its pose moves at ')

    def test_one_that_says_nothing_that_can_be(self):
        self.teller.sideways_mps = NAN
        self.stop()
        self.refuted('its odometry is not possible')

    def test_one_that_says_what_cannot_be(self):
        """It is no speed of anything, counted, and said once a second at most."""
        logged = []
        handler = logging.Handler()
        handler.emit = lambda record: logged.append(record.getMessage())
        logging.getLogger('rosout').addHandler(handler)
        self.addCleanup(logging.getLogger('rosout').removeHandler, handler)
        begun, self.teller.ahead_mps = time.monotonic(), 1e30
        self.stop()
        self.refuted('its odometry is not possible')
        view = self.link.view()
        self.assertEqual((view.linear_mps, view.x_m), (None, 0.0))
        self.assertTrue(view.moving, 'nobody knows that it stands')
        refused = self.link.feeds.refused()['odometry']
        self.assertGreater(refused, 1)
        lines = [line for line in logged if 'speed of 1e+30 m/s is impossible' in line]
        self.assertTrue(0 < len(lines) <= time.monotonic() - begun + 1.0, logged)
        self.teller.ahead_mps = 0.0
        wait_for(lambda: self.proof().state == PROOF_STOPPED, what='the proof')
        self.assertEqual(self.link.view().linear_mps, 0.0)

    def test_bytes_that_are_no_message_bring_no_motion_back(self):
        self.link.view()
        feed, = self.link._feeds
        torn = rospy.AnyMsg()
        torn._buff = 20 * b'\xff'
        self.teller.close()
        self.link._on_message(feed, torn, time.monotonic())
        view = self.link.view()
        self.assertEqual((view.link, view.linear_mps, view.x_m), ('live', None, None))

    def test_one_that_did_not_follow_before(self):
        """It says standstill at once, and the gates say that it did so when it was driven, too."""
        self.link.on_gate(RobotGate(name=self.name, odometry_follows=False))
        self.stop()
        self.refuted('NOT CONFIRMED')
        self.link.on_gate(RobotGate(name=self.name, odometry_follows=True))
        wait_for(lambda: self.proof().state == PROOF_STOPPED, what='the proof')

    def test_one_in_a_national_grid(self):
        self.teller.x = 5_900_000.0
        wait_for(lambda: self.link.view().x_m == 5_900_000.0, what='the place')
        self.stop()
        wait_for(lambda: self.proof().state == PROOF_STOPPED, what='the proof')

    def test_one_that_is_heard_late(self):
        """What is heard first was measured before the stop."""
        self.teller.late_s = LATE_S
        wait_for(lambda: self.link.view().age_s > LATE_S / 2, what='the delay', poll_s=0.01)
        wait_for(lambda: self.link.view().age_s < 0.1, what='the first late word', poll_s=0.001)
        self.stop()
        wait_for(lambda: self.proof().state == PROOF_STOPPED, what='the proof', poll_s=0.001)
        took_s = time.monotonic() - self.stopped_at
        print('MEASURED proof by odometry that is {:g} s late: {:.0f} ms, "{}"'.format(
            LATE_S, 1e3 * took_s, self.proof().text))
        self.assertGreater(took_s, LATE_S)


if __name__ == '__main__':
    rospy.init_node('stop_proof_test')
    rostest.rosrun('mhri', 'stop_proof', StopProofTest)
