#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where robots are placed: the real node, robots placed by tf, by motion capture and by hand.

bot1 to bot3 are simulated; bot4 and bot5 are played here: both call their odometry ``odom``.
"""
import contextlib
import math
import os
import sys
import time
import unittest

import actionlib
from geometry_msgs.msg import Point32, Pose2D, TransformStamped
from nav_msgs.msg import Odometry
import psutil
import rospy
import rostest
from std_srvs.srv import SetBool
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..'))


from support import graph  # noqa: E402
from support.node_tools import NEUTRAL, Recorder, Stick  # noqa: E402
from mhri.msg import ControlMode, Place, Places, RunTaskAction, RunTaskGoal, TaskState  # noqa: E402
from mhri.srv import FitPlace, SetFence, SetMark, SetPlace  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402
from support.ros_system import insist, NotYet, processes_with, wait_for  # noqa: E402

TIMEOUT_S = 60.0
BOT1, BOT2, BOT3 = (3.0, 1.0, 0.0), (2.0, 2.0, 1.0), (1.5, 3.2, 0.4)
CORNERS = [(0.5, 0.5), (11.0, 0.5), (11.0, 4.0), (0.5, 4.0)]


class PlayedRobot:
    """Publishes the odometry of a robot that all call ``odom``."""

    def __init__(self, name):
        self._publisher = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        self._message = Odometry()
        self._message.header.frame_id = 'odom'
        self._message.pose.pose.orientation.w = 1.0
        self._timer = rospy.Timer(rospy.Duration(0.05), self._publish)

    def _publish(self, _):
        self._publisher.publish(self._message)

    def be_at(self, x):
        """Say so from now on."""
        self._message.pose.pose.position.x = x


def origin_is(place, by, want, within_m=0.1):
    """Return whether a place says where odometry begins, within some centimetres and degrees."""
    origin = place.odometry
    return (place.by == by and math.hypot(origin.x - want[0], origin.y - want[1]) < within_m
            and abs(math.remainder(origin.theta - want[2], 2.0 * math.pi)) < 0.05)


class WherePlaced(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.operator, cls.state = FakeOperator(), StateEar()
        cls.stick = Stick(graph.STICK)
        cls.mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        cls.mode.publish('joy')
        cls.played = {name: PlayedRobot(name) for name in ('bot4', 'bot5')}
        cls.places = Recorder('/mhri_tasks/places', Places, lambda message: message)
        cls.client = actionlib.ActionClient(graph.RUN_TASK, RunTaskAction)
        for name, kind in (('set_place', SetPlace), ('fit_place', FitPlace),
                           ('set_fence', SetFence), ('set_mark', SetMark)):
            rospy.wait_for_service('/mhri_tasks/' + name, TIMEOUT_S)
            setattr(cls, name, rospy.ServiceProxy('/mhri_tasks/' + name, kind))

    def setUp(self):
        set_stop = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)
        set_stop.wait_for_service(TIMEOUT_S)
        self.stick.wait_listener()
        self.stick.hold(NEUTRAL)
        self.operator.check()
        wait_for(lambda: set_stop(False).success, what='not released', timeout_s=30.0)
        self.assertTrue(self.client.wait_for_server(rospy.Duration(TIMEOUT_S)))

    def place(self, name):
        """Return the newest ``mhri/Place`` of a robot, None before the first."""
        message = self.places.last()
        return next((place for place in (message.robots if message else ())
                     if place.robot == name), None)

    def wait_place(self, name, good, words):
        """Wait for a place of which something is true."""
        wait_for(lambda: self.place(name) is not None and good(self.place(name)),
                 what=lambda: '{}: {}: {}'.format(name, words, self.place(name)))

    def wait_words(self, name, words):
        """Wait until a robot is not placed, and why that is."""
        self.wait_place(name, lambda place: not place.by and words in place.text
                        and math.isnan(place.odometry.x), words)

    def ends(self, robot, task, parameters):
        """Run a task to its end; return (state, sentence)."""
        def in_time():
            for name in ('bot1', 'bot2', 'bot3'):
                self.state.wait_robot(name, lambda gate: gate.topic and not gate.obeys
                                      and not gate.stands, 'the gate of ' + name, TIMEOUT_S)
            goal = self.client.send_goal(RunTaskGoal(task, [robot], parameters))
            wait_for(lambda: goal.get_comm_state() == actionlib.CommState.DONE,
                     what='the task goes on', timeout_s=120.0)
            ended = goal.get_result().robots[0]
            if ended.state == TaskState.LOST:
                raise NotYet(ended.text)
            return ended.state, ended.text
        return insist(in_time, '{} to end'.format(task))

    def put(self, name, x, y, theta=0.0):
        """Place a robot by hand once its odometry is heard."""
        wait_for(lambda: self.set_place(name, True, Pose2D(x, y, theta)).success,
                 what='{} cannot be placed'.format(name), timeout_s=TIMEOUT_S)

    def served_at(self):
        """Return when the node was seen to serve [s, monotonic]; 0 where it does not."""
        try:
            self.set_mark('none', False, Pose2D())
        except rospy.ServiceException:
            return 0.0
        # What it published before it served has come as well.
        noted = self.places.since(0.0)
        return noted[-1].at if noted else 0.0

    def refused(self, answer, words):
        """Check that a service refuses, and what it says."""
        self.assertFalse(answer.success)
        self.assertIn(words, answer.message)

    def test_tf_and_motion_capture_place_a_robot(self):
        self.wait_place('bot1', lambda place: origin_is(place, Place.TF, BOT1)
                        and place.age_s < 1.0, 'by tf')
        self.wait_place('bot2', lambda place: origin_is(place, Place.MOTION_CAPTURE, BOT2),
                        'by motion capture')
        wait_for(lambda: self.places.last().header.frame_id == 'map',
                 what='no map', timeout_s=TIMEOUT_S)

    def test_a_robot_that_is_not_placed_goes_nowhere_on_the_map(self):
        self.set_place('bot3', False, Pose2D())
        self.wait_words('bot3', 'bot3/odom')
        self.assertEqual(self.ends('bot3', 'goto', '{x: 1.5, y: 2.5}')[0], TaskState.FAILED)
        self.assertEqual(self.ends('bot3', 'hold', '{seconds: 0.2}')[0], TaskState.DONE)
        self.assertEqual(self.ends('bot3', 'goto', '{x: 0, y: 0, frame: odom}')[0],
                         TaskState.DONE)

    def test_a_robot_placed_by_tf_goes_to_a_place_on_the_map(self):
        state, text = self.ends('bot1', 'goto', '{x: 4.0, y: 1.2}')
        self.assertEqual(state, TaskState.DONE, text)
        # Its odometry still begins where it was started.
        self.wait_place('bot1', lambda place: origin_is(place, Place.TF, BOT1, 0.3), 'by tf')

    def test_placed_by_hand_roughly_and_fitted(self):
        self.put('bot3', BOT3[0] + 0.3, BOT3[1] - 0.2, BOT3[2] + 0.2)
        self.wait_place('bot3', lambda place: place.by == Place.HAND, 'by hand')
        wait_for(lambda: self.fit_place('bot3', '').success, what='it is not fitted')
        self.wait_place('bot3', lambda place: origin_is(place, Place.HAND, BOT3, 0.06), 'fitted')
        self.put('bot3', BOT3[0] + 0.2, BOT3[1] - 0.2, BOT3[2] - 0.1)
        answer = self.fit_place('bot3', 'bot1')
        self.assertTrue(answer.success or 'bot3' in answer.message, answer.message)
        self.refused(self.fit_place('bot1', ''), 'bot1')
        self.refused(self.fit_place('bot3', 'bot3'), '')
        self.refused(self.fit_place('bot3', 'bot4'), 'bot4')

    def test_robots_that_share_a_frame_stay_apart(self):
        everybody = TransformStamped(child_frame_id='odom')
        everybody.header.frame_id = 'map'
        everybody.transform.rotation.w = 1.0
        tf = rospy.Publisher('/tf_static', TFMessage, queue_size=1, latch=True)
        tf.publish([everybody])
        for name in ('bot4', 'bot5'):
            self.set_place(name, False, Pose2D())
            self.wait_words(name, 'odom')
        self.put('bot4', 5.0, 3.0)
        self.put('bot5', 6.0, 3.0)
        for name, x in (('bot4', 5.0), ('bot5', 6.0)):
            self.wait_place(name, lambda place: origin_is(place, Place.HAND, (x, 3.0, 0.0)),
                            'by hand')
        self.played['bot4'].be_at(100.0)
        self.wait_words('bot4', 'odometry')
        self.assertEqual(self.place('bot5').by, Place.HAND)
        self.played['bot4'].be_at(0.0)
        tf.unregister()

    def test_what_the_hand_has_done_survives_the_node(self):
        self.put('bot5', 6.0, 3.0)
        self.addCleanup(self.set_mark, 'dock', False, Pose2D())
        self.addCleanup(self.set_fence, [])
        self.assertTrue(self.set_mark('dock', True, Pose2D(1.0, 2.0, 0.5)).success)
        self.assertTrue(self.set_fence([Point32(x, y, 0.0) for x, y in CORNERS]).success)
        # Written by another thread.
        wait_for(lambda: rospy.get_param('/mhri_tasks/kept', {}).get('fence')
                 and 'bot5' in rospy.get_param('/mhri_tasks/kept')['hand'],
                 what='not kept', timeout_s=30.0)
        killed = processes_with('__name:=mhri_tasks')
        for process in killed:
            with contextlib.suppress(psutil.NoSuchProcess):
                process.kill()
        psutil.wait_procs(killed, 30.0)
        gone = time.monotonic()
        wait_for(lambda: self.served_at() > gone, what='does not come back', timeout_s=TIMEOUT_S)
        self.wait_place('bot5', lambda place: origin_is(place, Place.HAND, (6.0, 3.0, 0.0)),
                        'by hand, as before')
        message = self.places.last()
        self.assertEqual([(mark.name, mark.pose.x) for mark in message.marks], [('dock', 1.0)])
        self.assertEqual([(corner.x, corner.y) for corner in message.fence], CORNERS)

    def test_services_refuse_what_cannot_be(self):
        nan, here = Pose2D(math.nan, 0.0, 0.0), Pose2D(1.0, 1.0, 0.0)
        self.wait_place('bot2', lambda place: place.by, 'placed')
        for answer, words in (
                (self.set_place('bot9', True, here), 'bot9'),
                (self.set_place('bot4', True, nan), ''),
                (self.set_place('bot2', True, here), 'motion capture'),
                (self.set_mark('a b', True, here), 'space'), (self.set_mark('dock', True, nan), ''),
                (self.set_fence([Point32()] * 5000), '5000'), (self.fit_place('bot9', ''), 'bot9'),
                (self.fit_place('bot3', 'x' * 5000), '')):
            self.refused(answer, words)
        wait_for(lambda: (self.places.last().marks, self.places.last().fence) == ([], []),
                 what='something is left', timeout_s=TIMEOUT_S)

    def test_a_robot_on_a_task_is_not_placed(self):
        self.put('bot3', *BOT3)
        self.state.wait_robot('bot3', lambda gate: gate.topic and not gate.obeys
                              and not gate.stands, 'the gate of bot3', TIMEOUT_S)
        goal = self.client.send_goal(RunTaskGoal('hold', ['bot3'], ''))
        wait_for(lambda: 'bot3 is on a task' in self.set_place(
            'bot3', True, Pose2D(1.0, 1.0, 0.0)).message, what='it is placed', timeout_s=30.0)
        self.refused(self.fit_place('bot3', ''), 'bot3')
        goal.cancel()
        wait_for(lambda: goal.get_comm_state() == actionlib.CommState.DONE,
                 what='it goes on', timeout_s=30.0)


if __name__ == '__main__':
    rospy.init_node('places_test')
    rostest.rosrun('mhri', 'places', WherePlaced)
