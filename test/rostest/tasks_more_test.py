#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""More tasks by the real nodes: formation, replay, marks, fence, a robot with move_base, turtles.

Two simulated robots are seen by motion capture; the navigation of ``bot3`` is played here.
"""
import math
import os
import re
import sys
import tempfile
import time
import unittest

import actionlib
from geometry_msgs.msg import Point32, Pose2D, PoseStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal, MoveBaseResult
from nav_msgs.msg import Odometry
import rosbag
import rospy
import rostest
from rostest_tools import measured, moves, NEUTRAL, Process, Recorder, rests, Stick, wait_until
from std_srvs.srv import SetBool

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path[:0] = [os.path.join(HERE, '..'), os.path.join(HERE, '..', 'support', 'messages')]

from mhri.core.map.grid import grid_of  # noqa: E402
from mhri.core.robots.mocap import Pose  # noqa: E402
from mhri.msg import (  # noqa: E402
    ControlMode, Places, RunTaskAction, RunTaskGoal, TaskList, TaskState)
from mhri.ros.map.map_source import grid_message, publish_map  # noqa: E402
from mhri.srv import SetFence, SetMark  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402
from support.ros_system import processes_with  # noqa: E402
from turtlesim.msg import Pose as TurtlePose  # noqa: E402

PATIENCE_S = 120.0
ROBOTS = ('bot1', 'bot2', 'bot3', 'pond')


def velocity(twist):
    """Return what a command says, as (m/s, rad/s)."""
    return (twist.linear.x, twist.angular.z)


class FakeMoveBase:
    """A navigation that drives straight on while it has a goal, and never arrives by itself."""

    def __init__(self, name):
        self.goals = []
        self._drive = rospy.Publisher('/{}/cmd_vel'.format(name), Twist, queue_size=1)
        self._server = actionlib.ActionServer('/{}/move_base'.format(name), MoveBaseAction,
                                              self._on_goal, self._on_cancel, auto_start=False)
        self._server.start()
        rospy.Timer(rospy.Duration(0.1), self._on_time)

    def _on_goal(self, handle):
        handle.set_accepted()
        self.goals.append(handle)

    def _on_cancel(self, handle):
        if handle in self.goals:
            self.goals.remove(handle)
        handle.set_canceled()

    def _on_time(self, _):
        if self.goals:
            message = Twist()
            message.linear.x = 0.1
            self._drive.publish(message)

    def end(self, how):
        """End every goal: ``succeeded`` or ``aborted``."""
        while self.goals:
            handle = self.goals.pop()
            getattr(handle, 'set_' + how)(MoveBaseResult(), 'the test says so')


class TasksMore(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.operator, cls.state = FakeOperator(), StateEar()
        cls.stick = Stick('/mux_in/joy')
        cls.set_stop = rospy.ServiceProxy('/mux/set_stop_all', SetBool)
        cls.set_fence = rospy.ServiceProxy('/mhri_tasks/set_fence', SetFence)
        cls.set_mark = rospy.ServiceProxy('/mhri_tasks/set_mark', SetMark)
        cls.mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=1, latch=True)
        cls.mode.publish('joy')
        cls.navigation = FakeMoveBase('bot3')
        cls.commands = Recorder('/bot3/cmd_vel', Twist, velocity)
        cls.places = {name: Recorder(
            '/vrpn_client_node/{}/pose'.format(name), PoseStamped,
            lambda message: (message.pose.position.x, message.pose.position.y))
            for name in ('bot1', 'bot2')}
        cls.odometry = Recorder('/bot1/odom', Odometry, lambda message: message)
        cls.turtle = Recorder('/pond/turtle1/pose', TurtlePose,
                              lambda message: (message.x, message.y, message.theta))
        cls.lists = Recorder('/mhri_tasks/list', TaskList, lambda message: message)
        cls.client = actionlib.ActionClient('/mhri_tasks/run', RunTaskAction)

    def setUp(self):
        """Nothing is stopped, nobody is checked, no robot is on a task; there is no fence."""
        self.set_stop.wait_for_service(60.0)
        self.stick.wait_listener()
        self.stick.hold(NEUTRAL)
        self.operator.check()
        wait_until(lambda: self.set_stop(False).success, 'not released', 30.0)
        self.assertTrue(self.client.wait_for_server(rospy.Duration(60.0)))
        self.set_fence.wait_for_service(60.0)
        self.assertTrue(self.set_fence([]).success)
        for name in ROBOTS:
            self.state.wait_robot(name, lambda gate: gate.topic and not gate.obeys and
                                  not gate.stands, 'the gate of ' + name, 60.0)

    def tearDown(self):
        """Whatever a test that failed has left to do is ended."""
        self.client.cancel_all_goals()
        self.navigation.end('aborted')

    def start(self, robots, task, parameters=''):
        """Start a task; return its handle."""
        return self.client.send_goal(RunTaskGoal(task, robots.split(), parameters))

    def ends(self, goal):
        """Wait for the end; return [(state, sentence)] of its robots."""
        wait_until(lambda: goal.get_comm_state() == actionlib.CommState.DONE, 'the task goes on',
                   PATIENCE_S)
        self.assertIsNotNone(goal.get_result(), goal.get_goal_status_text())
        return [(robot.state, robot.text) for robot in goal.get_result().robots]

    def ended(self, robots, task, parameters=''):
        """Do a task to its end; return as :meth:`ends` does.

        Again where something came too late: on a busy machine that says nothing of the task.
        """
        for tries_left in reversed(range(5)):
            ended = self.ends(self.start(robots, task, parameters))
            if not (tries_left and ended[0][0] == TaskState.LOST):
                return ended
            print('again: {}'.format(ended))

    def done(self, robots, task, parameters=''):
        """Do a task to its end, which has to be a good one; return the first sentence."""
        ended = self.ended(robots, task, parameters)
        self.assertEqual([state for state, _ in ended], [TaskState.DONE] * len(ended), ended)
        return ended[0][1]

    def test_a_formation_keeps_its_spacing_in_a_bend(self):
        for tries_left in reversed(range(4)):
            self.done('bot1', 'goto', '{x: 3.0, y: 1.2, heading: 0.0, speed: 0.4}')
            self.done('bot2', 'goto', '{x: 2.2, y: 1.2, heading: 0.0, speed: 0.4}')
            begun = time.monotonic()
            formed = self.start('bot2', 'formation', '{leader: bot1, shape: column, spacing: 0.8}')
            self.done('bot1', 'patrol', '{route: [[4.2, 1.2], [4.6, 1.6], [4.6, 2.2]], rounds: 1, '
                      'speed: 0.12}')
            wait_until(lambda: formed.get_comm_state() == actionlib.CommState.DONE or abs(
                self.gap() - 0.8) < 0.2, 'the spacing does not come back', PATIENCE_S)
            formed.cancel()
            ended = self.ends(formed)
            if not (tries_left and ended[0][0] == TaskState.LOST):
                break
        self.assertEqual(ended, [(TaskState.STOPPED, 'it was cancelled')])
        second = [item.value for item in self.places['bot2'].since(begun)]
        first = self.places['bot1'].since(begun)
        gaps = [math.dist(item.value, place) for item, place in zip(first, second)]
        print('formation: {:.2f} to {:.2f} m between the two'.format(min(gaps), max(gaps)))
        self.assertGreater(min(gaps), 0.45)

    def gap(self):
        """Return the way between the two robots [m]."""
        return math.dist(self.places['bot1'].last(), self.places['bot2'].last())

    def test_a_drive_of_a_bag_is_replayed_within_015_m(self):
        self.done('bot2', 'goto', '{x: 2.0, y: 2.6, speed: 0.4}')
        self.done('bot1', 'goto', '{x: 3.0, y: 1.2, heading: 0.0, speed: 0.4}')
        begun = time.monotonic()
        self.done('bot1', 'patrol', '{route: [[3.8, 1.2], [4.2, 1.7]], rounds: 1}')
        path = os.path.join(tempfile.mkdtemp(), 'drive.bag')
        with rosbag.Bag(path, 'w') as bag:
            for item in self.odometry.since(begun):
                bag.write('/bot1/odom', item.value, item.value.header.stamp)
        said = self.done('bot1', 'replay', '{{bag: {}, begin: there}}'.format(path))
        print('replay:', said)
        off = [float(most) for most in re.findall(r'([\d.]+) m at most', said)]
        self.assertEqual(len(off), 2, said)
        self.assertLess(max(off), 0.15, said)
        for words, why in (('{bag: /nowhere/x.bag}', 'cannot be read: No such file'),
                           ('{{bag: {}, topic: /odom}}'.format(path), 'topic could be: /bot1/odom'),
                           ('{seconds: 1, bag: ""}', '')):
            ended = self.ends(self.start('bot1', 'replay', words))
            self.assertIn(ended[0][0], (TaskState.FAILED, TaskState.DONE))
            self.assertIn(why, ended[0][1])

    def test_marks_and_the_fence(self):
        self.done('bot2', 'goto', '{x: 2.0, y: 2.6, speed: 0.4}')
        self.assertTrue(self.set_mark('dock', True, Pose2D(3.6, 1.8, 0.0)).success)
        self.assertTrue(self.set_fence([Point32(x, y, 0.0) for x, y in (
            (2.4, 0.4), (4.4, 0.4), (4.4, 2.6), (2.4, 2.6))]).success)
        self.done('bot1', 'return', '{mark: dock, speed: 0.4}')
        self.assertLess(math.dist(self.places['bot1'].last(), (3.6, 1.8)), 0.2)
        self.assertIn('there are: dock', self.ends(
            self.start('bot1', 'return', '{mark: door}'))[0][1])
        self.assertEqual(self.ends(self.start('bot1', 'goto', '{x: 5.0, y: 1.8}')), [
            (TaskState.FAILED, 'its goal lies outside of the fence')])
        begun = time.monotonic()
        ended = self.ended('bot1', 'square', '{side: 3.0}')
        self.assertEqual(ended, [(TaskState.BLOCKED, 'for 5 s: it is at the fence')])
        furthest = max(item.value[0] for item in self.places['bot1'].since(begun))
        print('fence at 4.40 m: the middle of the robot came to {:.2f} m'.format(furthest))
        self.assertLess(furthest, 4.4 - 0.15)
        unplaced = self.ends(self.start('pond', 'square', '{side: 1.0}'))
        self.assertEqual(unplaced[0][0], TaskState.FAILED)
        self.assertIn('there is a fence, and ', unplaced[0][1])

    def test_the_end_of_the_floor_on_a_map_holds_a_robot(self):
        """What its laser does not see: cells that are not free, from 4.4 m on."""
        self.done('bot2', 'goto', '{x: 2.0, y: 2.6, speed: 0.4}')
        self.done('bot1', 'goto', '{x: 3.6, y: 1.8, heading: 0.0, speed: 0.4}')
        frames = Recorder('/mhri_tasks/places', Places, lambda message: message.header.frame_id)
        publisher = publish_map(grid_of(0.1, Pose(2.0, 0.0, 0.0), 30, 30, (
            [0] * 24 + [100] * 6) * 30))
        # A map of one free cell ends nowhere.
        self.addCleanup(publisher.publish, grid_message(grid_of(
            0.1, Pose(2.0, 0.0, 0.0), 1, 1, [0])))
        wait_until(lambda: frames.last() == 'map', 'the map is not heard', 60.0)
        begun = time.monotonic()
        ended = self.ended('bot1', 'square', '{side: 3.0}')
        self.assertEqual(ended, [
            (TaskState.BLOCKED, 'for 5 s: it is at the end of the free floor on the map')])
        furthest = max(item.value[0] for item in self.places['bot1'].since(begun))
        print('floor up to 4.40 m: the middle of the robot came to {:.2f} m'.format(furthest))
        self.assertLess(furthest, 4.4 - 0.15)

    def sent(self):
        """Send the robot that has move_base somewhere; return the goal, once it is on its way."""
        begun = time.monotonic()
        goal = self.start('bot3', 'goto', '{x: 50.0, y: 1.0, frame: odom}')
        wait_until(lambda: self.navigation.goals, 'its navigation gets no goal', 60.0)
        self.commands.wait(moves, begun, 60.0)
        return goal

    def rests_for_good(self, since):
        """Wait for silence after the first zero of the gates; no command but zeros came after."""
        wait_until(lambda: not self.navigation.goals, 'its navigation goes on', 60.0)
        self.commands.wait_silence(1.2, 60.0)
        noted = self.commands.since(since)
        self.assertTrue([item for item in noted if rests(item.value)], 'no zero came')
        self.assertTrue(rests(noted[-1].value))

    def test_a_goal_goes_to_the_navigation_of_the_robot(self):
        goal = self.sent()
        target = self.navigation.goals[0].get_goal().target_pose
        self.assertEqual((target.pose.position.x, target.pose.position.y), (50.0, 1.0))
        self.assertEqual([item.value for item in self.commands.since(0.0)
                          if rests(item.value)][3:], [], 'zeros are in the way of its navigation')
        self.navigation.end('succeeded')
        ended = self.ends(goal)
        self.assertEqual(ended[0][0], TaskState.DONE)
        self.assertIn('it is there by its own navigation', ended[0][1])
        goal = self.sent()
        self.navigation.end('aborted')
        self.assertEqual(self.ends(goal), [
            (TaskState.BLOCKED, 'its own navigation found no way (the test says so)')])

    def test_whatever_ends_a_task_cancels_the_goal_there(self):
        for ends, state in (
                (lambda goal: self.set_stop(True), TaskState.STOPPED),
                (lambda goal: self.operator.check('bot3'), TaskState.TAKEN_OVER),
                (lambda goal: goal.cancel(), TaskState.STOPPED),
                (lambda goal: self.operator.fall_silent(), TaskState.LOST),
                (lambda goal: self.start('bot3', 'hold', '{seconds: 0.5}'),
                 TaskState.TAKEN_OVER)):
            self.setUp()
            goal = self.sent()
            since = time.monotonic()
            ends(goal)
            self.assertEqual(self.ends(goal)[0][0], state)
            self.rests_for_good(since)

    def test_stop_all_and_checking_cancel_the_goal_while_mhri_tasks_hangs(self):
        """Its navigation speaks to the robot itself: nobody else would tell it to end."""
        for what, ends in (('stop-all', lambda: self.set_stop(True)),
                           ('checked', lambda: self.operator.check('bot3'))):
            self.setUp()
            self.sent()
            hung = processes_with('__name:=mhri_tasks')
            try:
                for process in hung:
                    process.suspend()
                since = time.monotonic()
                ends()
                self.rests_for_good(since)
                first = next(item for item in self.commands.since(since) if rests(item.value))
                measured('{}, mhri_tasks hangs: first zero'.format(what), first.at - since)
            finally:
                for process in hung:
                    process.resume()

    def test_a_goal_that_somebody_sends_under_stop_all_or_to_a_checked_robot_ends(self):
        anybody = rospy.Publisher('/bot3/move_base/goal', MoveBaseActionGoal, queue_size=1)
        wait_until(anybody.get_num_connections, 'its navigation does not listen', 60.0)
        for what, ends in (('stop-all', lambda: self.set_stop(True)),
                           ('checked', lambda: self.operator.check('bot3'))):
            self.setUp()
            ends()
            self.state.wait_robot('bot3', lambda gate: gate.obeys or gate.stands, what, 60.0)
            self.commands.wait_silence(1.2, 60.0)
            since = time.monotonic()
            anybody.publish(MoveBaseActionGoal())
            self.commands.wait(moves, since, 60.0)
            wait_until(lambda: not self.navigation.goals, what + ': its navigation goes on', 60.0)
            self.commands.wait_silence(1.2, 60.0)
            last = [item for item in self.commands.since(since) if moves(item.value)][-1]
            measured('{}, a goal of somebody: drove for'.format(what), last.at - since)

    def test_when_mhri_tasks_is_killed_the_next_one_cancels_its_goals(self):
        self.sent()
        killed = time.monotonic()
        # The last one runs, the other one stands by.
        processes_with('__name:=mhri_tasks')[-1].kill()
        wait_until(lambda: not self.navigation.goals, 'its navigation goes on', 60.0)
        print('mhri_tasks killed: goal cancelled after {:.1f} s'.format(time.monotonic() - killed))
        self.commands.wait_silence(1.2, 60.0)
        wait_until(lambda: self.lists.since(killed) and not self.lists.last().runs,
                   'mhri_tasks does not come back', 60.0)

    def test_a_result_waits_for_who_is_not_connected_yet(self):
        ended = self.ends(self.start('bot1', 'return', '{mark: nowhere}'))
        late = Process(['rostopic', 'echo', '-n', '1', '/mhri_tasks/run/result/result'])
        self.addCleanup(late.end)
        self.assertEqual(late.wait(PATIENCE_S), 0, late.said())
        self.assertIn(ended[0][1], late.said())

    def test_a_turtle_does_what_its_topics_allow(self):
        x, y, _ = self.turtle.last()
        self.done('pond', 'goto', '{{x: {}, y: {}, frame: odom, speed: 1.0}}'.format(
            x + 1.0, y + 0.5))
        self.assertLess(math.dist(self.turtle.last()[:2], (x + 1.0, y + 0.5)), 0.2)
        self.assertIn('by odometry', self.done('pond', 'square', '{side: 0.5, speed: 1.0}'))
        self.done('pond', 'replay', '{seconds: 600, speed: 1.0}')
        self.done('pond', 'return', '{distance: 1.0, speed: 1.0}')
        ended = self.ends(self.start('pond', 'follow', '{leader: bot1}'))
        self.assertEqual(ended[0][0], TaskState.FAILED)


if __name__ == '__main__':
    rospy.init_node('tasks_more_test')
    rostest.rosrun('mhri', 'tasks_more', TasksMore)
