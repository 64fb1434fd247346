#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robots on a task: the real nodes, two simulated robots seen by motion capture, what ends a task.

What is timed here is timed as the robot hears it.
"""
import math
import os
import re
import signal
import sys
import time
import unittest

import actionlib
from actionlib_msgs.msg import GoalID, GoalStatusArray
from geometry_msgs.msg import PoseStamped, Twist
import roslib.packages
import rospkg
import rospy
import rostest
from rostest_tools import (
    measured, moves, NEUTRAL, Process, Recorder, rests, Stick, velocity, wait_until)
from rosgraph_msgs.msg import Log
from std_srvs.srv import SetBool

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.graph.ros.resources import read_text  # noqa: E402
from mhri.msg import ControlMode, RunTaskAction, RunTaskGoal, TaskList, TaskState  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402
from support.ros_system import processes_with  # noqa: E402

PATIENCE_S = 120.0
# Where bot2 begins.
BOT2 = (2.0, 1.0)
COMMANDS = {'bot1': '/bot1/teleop/input', 'bot2': '/bot2/cmd_vel'}


def place(message):
    """Return (x, y) [m] of a pose."""
    return (message.pose.position.x, message.pose.position.y)


def task_tool(*words):
    """Start the terminal's mhri_task."""
    return Process([roslib.packages.find_node('mhri', 'mhri_task')[0]] + list(words))


class Tasks(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.operator, cls.state = FakeOperator(), StateEar()
        cls.stick = Stick('/mux_in/joy')
        cls.set_stop = rospy.ServiceProxy('/mux/set_stop_all', SetBool)
        cls.mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=1, latch=True)
        cls.mode.publish('joy')
        cls.commands = {name: Recorder(topic, Twist, velocity) for name, topic in COMMANDS.items()}
        cls.places = {name: Recorder('/vrpn_client_node/{}/pose'.format(name), PoseStamped, place)
                      for name in COMMANDS}
        cls.lists = Recorder('/mhri_tasks/list', TaskList, lambda message: message)
        cls.client = actionlib.ActionClient('/mhri_tasks/run', RunTaskAction)

    def setUp(self):
        """Nothing is stopped, nobody is checked, no robot is on a task."""
        self.set_stop.wait_for_service(60.0)
        self.stick.wait_listener()
        self.stick.hold(NEUTRAL)
        self.operator.check()
        wait_until(lambda: self.set_stop(False).success, 'not released', 30.0)
        self.assertTrue(self.client.wait_for_server(rospy.Duration(60.0)))
        for recorder in self.places.values():
            recorder.wait(lambda where: True, patience_s=60.0)
        for name in COMMANDS:
            self.state.wait_robot(name, lambda gate: gate.topic and not gate.obeys and
                                  not gate.stands, 'the gate of ' + name, 60.0)

    def start(self, robots, task, parameters):
        """Start a task; return its handle. At the end of the test it is cancelled."""
        goal = self.client.send_goal(RunTaskGoal(task, robots.split(), parameters))
        # By its id: a cancel of everything could come after the next test's goal.
        self.addCleanup(goal.cancel)
        return goal

    def ends(self, goal):
        """Wait for the end; return [(state, sentence)] of its robots."""
        wait_until(lambda: goal.get_comm_state() == actionlib.CommState.DONE, 'the task goes on',
                   PATIENCE_S)
        return [(robot.state, robot.text) for robot in goal.get_result().robots]

    def done(self, robot, task, parameters):
        """Do a task to its end, which has to be a good one.

        Again where something came too late: on a busy machine that says nothing of the task.
        """
        for _ in range(12):
            ended = self.ends(self.start(robot, task, parameters))
            if ended[0][0] != TaskState.LOST:
                break
            print('again: {}'.format(ended))
        self.assertEqual(ended[0][0], TaskState.DONE, ended)

    def on_its_way(self, robot='bot1', parameters='{x: 9.0, y: 2.0}'):
        """Start a robot on a long way and wait until it moves; return (goal, since when).

        Again where it did not come to move: on a busy machine that says nothing of the task.
        """
        for _ in range(12):
            begun = time.monotonic()
            x = self.places[robot].last()[0]
            goal = self.start(robot, 'goto', parameters.replace('9.0', '9.0' if x < 6.0 else '2.0'))
            wait_until(lambda: goal.get_comm_state() == actionlib.CommState.DONE or any(
                moves(item.value) for item in self.commands[robot].since(begun)),
                'it neither moves nor ends', 60.0)
            if goal.get_comm_state() != actionlib.CommState.DONE:
                return goal, begun
            ended = self.ends(goal)
            print('ended before it moved: {}'.format(ended))
            self.assertEqual(ended[0][0], TaskState.LOST, ended)
        raise AssertionError('again and again it ends before it moves')

    def rests_for_good(self, robot, since):
        """Wait for silence after the first zero; nothing but zeros may have come since that."""
        zero = self.commands[robot].wait(rests, since, 30.0)
        self.commands[robot].wait_silence(0.6, 60.0)
        self.assertEqual([item for item in self.commands[robot].since(zero.at)
                          if moves(item.value)], [])
        return zero.at - since

    def test_a_goal_is_reached_within_02_m(self):
        x, y = self.places['bot1'].last()
        goal = (x + (1.5 if x < 3.5 else -1.0), 2.2 if y < 1.8 else 1.2)
        self.done('bot1', 'goto', '{{x: {}, y: {}, heading: 1.0, speed: 0.4}}'.format(*goal))
        self.assertLess(math.dist(self.places['bot1'].last(), goal), 0.2)

    def test_the_terminal_drives_a_square_and_says_its_corners(self):
        for _ in range(6):
            # Away from everything.
            self.done('bot1', 'goto', '{x: 5.0, y: 2.0, speed: 0.4}')
            tool = task_tool('bot1', 'square', '0.4', 'speed=0.4')
            self.addCleanup(tool.end)
            status = tool.wait(PATIENCE_S)
            if 'bot1: lost: ' not in tool.said():
                break
        self.assertEqual(status, 0, tool.said())
        for number in (1, 2, 3, 4):
            self.assertIn('bot1: corner {}: x '.format(number), tool.said())
        errors = re.search(r'by odometry ([\d.]+) m .* by motion capture ([\d.]+) m', tool.said())
        self.assertLess(float(errors.group(1)), 0.1, tool.said())
        self.assertLess(float(errors.group(2)), 0.2, tool.said())

    def test_ctrl_c_stops_the_robot(self):
        begun = time.monotonic()
        x = self.places['bot1'].last()[0]
        tool = task_tool('bot1', 'goto', '9.0' if x < 6.0 else '2.0', 'y=2.0')
        self.addCleanup(tool.end)
        self.commands['bot1'].wait(moves, begun, 60.0)
        ended = tool.send(signal.SIGINT)
        self.assertEqual(tool.wait(30.0), 1)
        self.assertIn('bot1: stopped: it was cancelled', tool.said())
        self.rests_for_good('bot1', ended)

    def test_words_that_cannot_be_are_refused_by_name(self):
        for words, said in ((('bot1', 'goto', '1.0'), 'y: is missing'),
                            (('bot1', 'dance'), 'no task dance'),
                            (('bot9', 'goto', '1', '2'), 'add it to the list of robots')):
            tool = task_tool(*words)
            self.addCleanup(tool.end)
            self.assertNotEqual(tool.wait(60.0), 0)
            self.assertIn(said, tool.said())
        begun = time.monotonic()
        ended = self.ends(self.start('bot1 bot9', 'goto', '{x: 9.0, y: 2.0}'))
        self.assertEqual([state for state, _ in ended], [TaskState.FAILED, TaskState.LOST])
        self.assertTrue(all('bot9' in text for _, text in ended), ended)
        self.commands['bot1'].wait_silence(0.6, 60.0)
        self.assertFalse([item for item in self.commands['bot1'].since(begun)
                          if moves(item.value)], 'a good robot of a bad goal moved')
        goal = self.start('bot1', 'goto', '{x: 1, z: 1, y: 1}')
        wait_until(lambda: goal.get_comm_state() == actionlib.CommState.DONE, 'not refused', 30.0)
        self.assertIn('z: unknown key', goal.get_goal_status_text())

    def test_a_storm_of_cancels_is_neither_kept_nor_logged(self):
        cancels = rospy.Publisher('/mhri_tasks/run/cancel', GoalID, queue_size=1000)
        statuses = Recorder('/mhri_tasks/run/status', GoalStatusArray,
                            lambda message: [row.goal_id.id for row in message.status_list])
        logged = Recorder('/rosout', Log, lambda message: message.name)
        for recorder in (statuses, logged):
            self.addCleanup(recorder.close)
            recorder.wait_publisher()
        wait_until(cancels.get_num_connections, 'mhri_tasks does not listen', 60.0)
        begun = time.monotonic()
        cancels.publish(GoalID(stamp=rospy.Time(4e9)))
        for number in range(300):
            cancels.publish(GoalID(id='none {}'.format(number)))
            cancels.publish(GoalID())
        cancels.publish(GoalID(id='last'))
        statuses.wait(lambda ids: 'last' in ids, begun)
        # Still heard, and one of the future refuses no goal.
        ended = self.ends(self.start('bot1', 'goto', '{x: 9.0, y: 2.0, timeout: 0.1}'))
        self.assertIn(ended[0][0], (TaskState.TIMEOUT, TaskState.LOST))
        self.assertLess(max(len(item.value) for item in statuses.since(begun)), 200)
        lines = [item for item in logged.since(begun) if item.value == '/mhri_tasks']
        self.assertLess(len(lines), 20)

    def test_a_follower_keeps_its_distance_and_returns(self):
        following = self.start('bot2', 'follow', '{leader: bot1, distance: 1.0}')
        x = self.places['bot1'].last()[0]
        self.done('bot1', 'goto', '{{x: {}, y: 1.6, speed: 0.2}}'.format(
            4.0 if x < 3.2 else 2.5))
        wait_until(lambda: math.dist(self.places['bot1'].last(), self.places['bot2'].last()) < 1.25,
                   'bot2 is left behind', PATIENCE_S)
        self.assertGreater(math.dist(self.places['bot1'].last(), self.places['bot2'].last()), 0.6)
        wait_until(lambda: 'bot2' in [robot.robot for run in self.lists.last().runs
                                      for robot in run.robots], 'bot2 is not listed', 30.0)
        following.cancel()
        self.assertEqual(self.ends(following), [(TaskState.STOPPED, 'it was cancelled')])
        self.done('bot2', 'return', '{speed: 0.4}')
        self.assertLess(math.dist(self.places['bot2'].last(), BOT2), 0.4)

    def test_stop_all_ends_every_task_and_nothing_resumes(self):
        goal, _ = self.on_its_way()
        stopped = time.monotonic()
        self.assertTrue(self.set_stop(True).success)
        measured('stop-all, first zero', self.rests_for_good('bot1', stopped))
        self.assertEqual(self.ends(goal)[0][0], TaskState.STOPPED)
        wait_until(lambda: self.set_stop(False).success, 'not released', 30.0)
        self.commands['bot1'].wait_silence(0.6, 30.0)
        self.assertEqual([item for item in self.commands['bot1'].since(stopped + 0.5)
                          if moves(item.value)], [])
        wait_until(lambda: not self.lists.last().runs, 'the list has it still', 30.0)

    def test_checking_a_robot_takes_it_over(self):
        goal, _ = self.on_its_way()
        checked = self.operator.check('bot1')
        self.assertEqual(self.ends(goal)[0][0], TaskState.TAKEN_OVER)
        self.rests_for_good('bot1', checked)
        self.assertEqual(self.ends(self.start('bot1', 'hold', ''))[0][0], TaskState.TAKEN_OVER)

    def test_an_operator_who_falls_silent_or_goes_leaves_no_robot_moving(self):
        """The lease holds for tasks, too: nobody at the screen could stop them."""
        for way, limit_s in (('silent', 2.0), ('gone', 1.0)):
            goal, _ = self.on_its_way()
            lost = self.operator.fall_silent()
            if way == 'gone':
                self.operator.leave()
            took = measured('operator {} during a task, first zero'.format(way),
                            self.rests_for_good('bot1', lost))
            self.assertLess(took, limit_s)
            self.assertEqual(self.ends(goal)[0][0], TaskState.LOST)
            type(self).operator = FakeOperator() if way == 'gone' else self.operator
            self.operator.check()

    def test_another_task_takes_the_place_of_the_last_one(self):
        goal, _ = self.on_its_way()
        other = self.start('bot1', 'hold', '{seconds: 1.0}')
        self.assertEqual(self.ends(goal), [(TaskState.TAKEN_OVER, 'it got another task: hold')])
        self.assertEqual(self.ends(other)[0][0], TaskState.DONE)

    def test_killed_it_leaves_zeros_and_comes_back_with_nothing_to_do(self):
        self.on_its_way()
        processes = processes_with('__name:=mhri_tasks')
        killed = time.monotonic()
        for one in processes:
            one.kill()
        took = measured('mhri_tasks killed, first zero', self.rests_for_good('bot1', killed))
        self.assertLess(took, 2.0)
        wait_until(lambda: self.lists.since(killed) and not self.lists.last().runs,
                   'mhri_tasks does not come back', 60.0)
        self.rests_for_good('bot1', killed)

    def test_the_example_of_the_guide(self):
        path = os.path.join(rospkg.RosPack().get_path('mhri'), 'doc', 'operators_guide.md')
        pattern = re.compile(r'```python\n(import actionlib\n.*?)```', re.S)
        example = pattern.search(read_text(path)).group(1)
        self.assertLessEqual(len(example.splitlines()), 12)
        tool = Process([sys.executable, '-c', example])
        self.addCleanup(tool.end)
        self.assertEqual(tool.wait(PATIENCE_S), 0, tool.said())
        self.assertIn('bot1 done', tool.said())


if __name__ == '__main__':
    rospy.init_node('tasks_test')
    rostest.rosrun('mhri', 'tasks', Tasks)
