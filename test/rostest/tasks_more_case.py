# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of more tasks share: two simulated robots, one with move_base, a turtle.

The simulated robots are seen by motion capture; the navigation of ``bot3`` is played here.
"""
import os
import sys
import unittest

import actionlib
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal, MoveBaseResult
from nav_msgs.msg import Odometry
import rospy
from rostest_tools import NEUTRAL, Recorder, Stick, velocity, wait_until
from std_srvs.srv import SetBool

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path[:0] = [os.path.join(HERE, '..'), os.path.join(HERE, '..', 'support', 'messages')]

from mhri.msg import ControlMode, RunTaskAction, RunTaskGoal, TaskList, TaskState  # noqa: E402
from mhri.srv import SetFence, SetMark  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402
from support.graph import navigation  # noqa: E402
from turtlesim.msg import Pose as TurtlePose  # noqa: E402

PATIENCE_S = 120.0
ROBOTS = ('bot1', 'bot2', 'bot3', 'pond')


class FakeMoveBase:
    """A navigation that drives straight on while it has a goal, and never arrives by itself."""

    def __init__(self, name):
        self.goals = []
        # Before the server, which writes into the message.
        self.stamps = Recorder(navigation(name, 'goal'), MoveBaseActionGoal,
                               lambda message: message.goal_id.stamp.to_sec())
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


class TasksMoreCase(unittest.TestCase):
    """Tasks of the robots of ``tasks_more.launch``."""

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
        """End a route that a test which failed has left."""
        self.navigation.end('aborted')

    def start(self, robots, task, parameters=''):
        """Start a task; return its handle. At the end of the test it is cancelled."""
        goal = self.client.send_goal(RunTaskGoal(task, robots.split(), parameters))
        # By its id: a cancel of everything could come after the next test's goal.
        self.addCleanup(goal.cancel)
        return goal

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
        for tries_left in reversed(range(12)):
            ended = self.ends(self.start(robots, task, parameters))
            if not (tries_left and ended[0][0] == TaskState.LOST):
                return ended
            print('again: {}'.format(ended))

    def all_done(self, *tasks):
        """Do (robot, task, parameters) of several robots at once, each to a good end."""
        for one, goal in [(one, self.start(*one)) for one in tasks]:
            if self.ends(goal)[0][0] != TaskState.DONE:
                self.done(*one)

    def done(self, robots, task, parameters=''):
        """Do a task to its end, which has to be a good one; return the first sentence."""
        ended = self.ended(robots, task, parameters)
        self.assertEqual([state for state, _ in ended], [TaskState.DONE] * len(ended), ended)
        return ended[0][1]
