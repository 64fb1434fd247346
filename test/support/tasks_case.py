# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of tasks share: a simulated robot, one with move_base, a turtle.

The first is seen by motion capture; the navigation of ``bot3`` is played here.
"""
import sys
import threading
import time
import unittest

import actionlib
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal, MoveBaseResult
from nav_msgs.msg import Odometry
import roslib.packages
import rospy
from std_srvs.srv import SetBool

from support import graph
from support.paths import MESSAGES
from support.node_tools import moves, NEUTRAL, Process, Recorder, rests, Stick, velocity
from support.ros_system import insist, NotYet, wait_for

sys.path.insert(0, MESSAGES)

from mhri.msg import ControlMode, RunTaskAction, RunTaskGoal, TaskList, TaskState  # noqa: E402
from mhri.srv import SetFence, SetMark  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402
from support.graph import navigation  # noqa: E402
from turtlesim.msg import Pose as TurtlePose  # noqa: E402

TIMEOUT_S = 120.0
ROBOTS = ('bot1', 'bot3', 'pond')
COMMANDS = {'bot1': '/bot1/teleop/input', 'bot3': '/bot3/cmd_vel'}


class FakeMoveBase:
    """A navigation that drives straight on while it has a goal, and never arrives by itself."""

    def __init__(self, name):
        self.goals, self.taken = [], 0
        self._lock = threading.Lock()
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
        with self._lock:
            self.goals.append(handle)
            self.taken += 1

    def _on_cancel(self, handle):
        with self._lock:
            if handle in self.goals:
                self.goals.remove(handle)
        handle.set_canceled()

    def _on_time(self, _):
        # Under the lock: nothing is sent after a goal has ended.
        with self._lock:
            if self.goals:
                message = Twist()
                message.linear.x = 0.1
                self._drive.publish(message)

    def end(self, how):
        """End every goal: ``succeeded`` or ``aborted``."""
        with self._lock:
            ended, self.goals = self.goals, []
        for handle in ended:
            getattr(handle, 'set_' + how)(MoveBaseResult(), 'the test says so')


class TasksCase(unittest.TestCase):
    """Tasks of the robots of ``tasks.launch``."""

    @classmethod
    def setUpClass(cls):
        cls.operator, cls.state = FakeOperator(), StateEar()
        cls.stick = Stick(graph.STICK)
        cls.set_stop = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)
        cls.set_fence = rospy.ServiceProxy('/mhri_tasks/set_fence', SetFence)
        cls.set_mark = rospy.ServiceProxy('/mhri_tasks/set_mark', SetMark)
        cls.mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        cls.mode.publish('joy')
        cls.navigation = FakeMoveBase('bot3')
        cls.commands = {name: Recorder(topic, Twist, velocity) for name, topic in COMMANDS.items()}
        cls.place = Recorder('/vrpn_client_node/bot1/pose', PoseStamped, lambda message: (
            message.pose.position.x, message.pose.position.y))
        cls.odometry = Recorder('/bot1/odom', Odometry, lambda message: message)
        cls.turtle = Recorder('/pond/turtle1/pose', TurtlePose,
                              lambda message: (message.x, message.y, message.theta))
        cls.lists = Recorder(graph.TASK_LIST, TaskList, lambda message: message)
        cls.client = actionlib.ActionClient(graph.RUN_TASK, RunTaskAction)

    def setUp(self):
        """Nothing is stopped, nobody is checked, no robot is on a task; there is no fence."""
        self.set_stop.wait_for_service(60.0)
        self.stick.wait_listener()
        self.stick.hold(NEUTRAL)
        self.operator.check()
        wait_for(lambda: self.set_stop(False).success, what='not released', timeout_s=30.0)
        self.assertTrue(self.client.wait_for_server(rospy.Duration(60.0)))
        self.set_fence.wait_for_service(60.0)
        self.assertTrue(self.set_fence([]).success)
        self.place.wait(lambda where: True)
        for name in ROBOTS:
            self.state.wait_robot(name, lambda gate: gate.topic and not gate.obeys and
                                  not gate.stands, 'the gate of ' + name, 60.0)
        wait_for(lambda: self.lists.last() and not self.lists.last().runs, what='a task goes on')

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
        wait_for(lambda: goal.get_comm_state() == actionlib.CommState.DONE, what='the task goes on',
                 timeout_s=TIMEOUT_S)
        self.assertIsNotNone(goal.get_result(), goal.get_goal_status_text())
        return [(robot.state, robot.text) for robot in goal.get_result().robots]

    def ended(self, robots, task, parameters='', good=lambda state: state != TaskState.LOST):
        """Do a task to an end that is good; return as :meth:`ends` does.

        :param good: whether the state of a robot is; at least nothing came too late
        """
        def in_time():
            ended = self.ends(self.start(robots, task, parameters))
            if not all(good(state) for state, _ in ended):
                raise NotYet(str(ended))
            return ended
        return insist(in_time, '{} to end well'.format(task))

    def done(self, robots, task, parameters=''):
        """Do a task to its end, which has to be a good one; return the first sentence."""
        return self.ended(robots, task, parameters, lambda state: state == TaskState.DONE)[0][1]

    def moves_since(self, begun):
        """Return whether bot1 was told to move since a time."""
        return any(moves(item.value) for item in self.commands['bot1'].since(begun))


def task_tool(*words):
    """Start the terminal's mhri_task."""
    return Process([roslib.packages.find_node('mhri', 'mhri_task')[0]] + list(words))


class NavigationCase(TasksCase):
    """Tasks of ``bot3``, which has a navigation."""

    def sent(self):
        """Send the robot that has move_base somewhere; return the goal, once it is on its way."""
        def on_its_way():
            begun = time.monotonic()
            goal = self.start('bot3', 'goto', '{x: 50.0, y: 1.0, frame: odom}')
            wait_for(lambda: self.navigation.goals or goal.get_comm_state() ==
                     actionlib.CommState.DONE, what='its navigation gets no goal', timeout_s=60.0)
            if self.navigation.goals:
                self.commands['bot3'].wait(moves, begun, 60.0)
                return goal
            ended = self.ends(goal)
            self.assertEqual(ended[0][0], TaskState.LOST, ended)
            raise NotYet(str(ended))
        return insist(on_its_way, 'its navigation to get a goal')

    def wait_still(self):
        """Wait until nothing but zeros has come for 0.6 s: a stopped robot may get many of them."""
        wait_for(lambda: not [item for item in self.commands['bot3'].since(time.monotonic() - 0.6)
                              if moves(item.value)], what='it goes on', timeout_s=60.0)

    def rests_for_good(self, since):
        """Wait until it rests after the first zero of the mux; return that."""
        wait_for(lambda: not self.navigation.goals, what='its navigation goes on')
        first = self.commands['bot3'].wait(rests, since)
        self.wait_still()
        return first
