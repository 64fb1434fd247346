#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robots without a namespace, without a type, with topics of their own: found, added and driven.

Each robot is a process of its own on a real master, beside a real mux and real gates; looking and
links are the panel's.
"""
import os
import signal
import sys
import tempfile
import unittest

from geometry_msgs.msg import Twist
import rosgraph
import roslib.packages
import rospy
import rostest
from rostest_tools import FORWARD, NEUTRAL, Process, start_mux, Stick

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, '..'))
try:
    import turtlesim.msg  # noqa: F401
except ImportError:
    sys.path.insert(0, os.path.join(HERE, '..', 'support', 'messages'))

from mhri.driving.ros.gates_client import GatesClient  # noqa: E402
from mhri.graph.ros.resources import robot_types  # noqa: E402
from mhri.graph.ros.worker import Worker  # noqa: E402
from mhri.robots.ros.fleet import Fleet  # noqa: E402
from mhri.robots.ros.look import look_for_robots, shipped_ignore_list  # noqa: E402
from support.fake_mux import FakeOperator  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.surgery import forget  # noqa: E402

PATIENCE_S = 30.0
PLAIN_ROBOT = os.path.join(HERE, '..', 'support', 'plain_robot.py')
TB3_SIGN = ('--sign', 'sensor_state', 'turtlebot3_msgs/SensorState')
TURTLES = os.path.join(HERE, '..', 'support', 'turtles.py')
GUARD = os.path.join(HERE, '..', '..', 'utils', 'remote', 'mhri_guard')
PARAMETERS = ('/robot_type', '/robot_model', '/robot_name')


class RobotTypesTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.types, errors = robot_types()
        assert not errors, errors
        cls.processes = [start_mux('__name:=mux'),
                         Process([roslib.packages.find_node('mhri', 'gates')[0]])]
        cls.stick, cls.operator = Stick('/mux_in/joy'), FakeOperator()
        cls.operator.set(5.0, 5.0)
        cls.gates = GatesClient(lambda state, now: None).start()
        cls.worker = Worker('feeds').start()
        cls.stick.wait_listener()
        wait_for(lambda: cls.gates.state() and cls.gates.state().mux == '/mux', PATIENCE_S)

    @classmethod
    def tearDownClass(cls):
        cls.stick.silence()
        for process in cls.processes:
            process.send(signal.SIGTERM)
            process.wait(PATIENCE_S)
            process.end()

    def setUp(self):
        self.ignore = shipped_ignore_list()
        self.fleet = Fleet(self.types, self.gates, self.worker)
        self.names = []
        self.addCleanup(self.end)

    def end(self):
        self.stick.hold(NEUTRAL)
        self.operator.check()
        rospy.set_param('/mhri/robots', [])
        for name in self.names:
            link = self.fleet.drop(name)
            if link:
                link.close()
        for name in PARAMETERS:
            if rospy.has_param(name):
                rospy.delete_param(name)

    def start(self, command, odometry, *options, node='base', namespace='/'):
        """Start a plain robot and wait until it is up; it goes with the test."""
        process = Process([sys.executable, PLAIN_ROBOT, command, odometry, *options,
                           '__name:=' + node], {'ROS_NAMESPACE': namespace})
        node = '{}/{}'.format(namespace.rstrip('/'), node)
        self.addCleanup(self.cleared, process, node)
        if '--halfway' not in options:
            # It tells the master of its topics one after the other, this one last.
            topic = command if command.startswith('/') else node.rpartition('/')[0] + '/' + command
            wait_for(lambda: [topic, node] in self.listeners(), PATIENCE_S, node + ' to be up')
        return process

    def gone(self, process, node):
        """End a process, and wait until the master has forgotten its node."""
        process.send(15)
        process.wait(PATIENCE_S)
        process.end()
        wait_for(lambda: node not in self.nodes(), PATIENCE_S, 'the end of ' + node)

    def cleared(self, process, node):
        """End a process, and take its node off the master: by itself it needs most of a second."""
        process.end()
        if node in self.nodes():
            forget(rosgraph.Master(rospy.get_name()), node)

    @staticmethod
    def listeners():
        state = rospy.get_master().getSystemState()[2]
        return [[topic, node] for topic, nodes in state[1] for node in nodes]

    @staticmethod
    def nodes():
        state = rospy.get_master().getSystemState()[2]
        return {node for group in state for _, nodes in group for node in nodes}

    def look(self):
        return look_for_robots(rospy.get_name(), self.ignore, self.names, types=self.types)

    def found(self, *names):
        """Wait until just these robots are found alive; return {name: facts}."""
        def exactly():
            found = self.look()
            return found if [item.name for item in found.live] == sorted(names) else None
        return wait_for(exactly, PATIENCE_S, 'just {} to be found'.format(names), 0.1).facts

    def add(self, name, facts=None):
        """Take a robot into the list, as the panel does; return its type."""
        self.names.append(name)
        rospy.set_param('/mhri/robots', self.names)
        self.fleet.want(name)
        self.fleet.connect(name, facts)
        return self.fleet.robot_type(name)

    def view(self, name):
        return self.fleet.view(name, selected=True)

    def take_stick(self, name):
        """Check a robot, and hold the stick ahead once it has been centred."""
        self.stick.hold(NEUTRAL)
        self.operator.check(name)
        wait_for(lambda: self.view(name).obeys and not self.view(name).stands
                 and self.gates.robot(name).topic, PATIENCE_S, name + ' to be ready')
        self.stick.hold(FORWARD)

    def drives(self, name, most):
        """Drive a robot with all there is: as fast as it may; it stops when deselected."""
        wait_for(lambda: self.view(name).link == 'live', PATIENCE_S, name + ' to be heard')

        def fast():
            view = self.view(name)
            return view.driven and abs(view.linear_mps - most) < 0.01
        for patience_s in (5.0, 5.0, PATIENCE_S):
            # On a busy machine this stick can be late for the mux, which then asks for neutral.
            self.take_stick(name)
            try:
                wait_for(fast, patience_s, '{} to move at {} m/s'.format(name, most))
                break
            except AssertionError:
                if patience_s == PATIENCE_S:
                    raise
        self.operator.check()
        wait_for(lambda: self.view(name).linear_mps == 0.0, PATIENCE_S, name + ' to stop')

    def test_a_turtlebot3_at_the_root(self):
        self.start('cmd_vel', 'odom', *TB3_SIGN, node='turtlebot3_core')
        facts = self.found('robot')
        kind = self.add('robot', facts['robot'])
        self.assertEqual((kind.name, kind.command, kind.odometry),
                         ('turtlebot3', ('/cmd_vel',), ('/odom',)))
        self.drives('robot', 0.22)

    def test_its_guard(self):
        """It stands in a namespace of the robot's name, and writes what the robot listens to."""
        self.start('cmd_vel', 'odom', *TB3_SIGN, node='turtlebot3_core')
        guard = Process([sys.executable, GUARD, '_command:=/cmd_vel'],
                        {'ROS_NAMESPACE': '/robot'})
        self.addCleanup(self.cleared, guard, '/robot/mhri_guard')
        wait_for(lambda: '/robot/mhri_guard' in self.nodes(), PATIENCE_S, 'the guard')
        self.add('robot', self.found('robot')['robot'])
        wait_for(lambda: self.view('robot').guarded, PATIENCE_S, 'the guard to be heard')
        self.drives('robot', 0.22)

    def test_its_parameters_and_its_name(self):
        rospy.set_param('/robot_type', 'turtlebot3')
        rospy.set_param('/robot_model', 'waffle')
        rospy.set_param('/robot_name', 'wanda')
        self.start('cmd_vel', 'odom', node='core')
        kind = self.add('wanda', self.found('wanda')['wanda'])
        self.assertEqual((kind.label, kind.limits.linear_mps), ('TurtleBot3 Waffle', 0.26))
        self.drives('wanda', 0.26)

    def test_a_robot_at_the_root_that_comes_up_after_it_was_added(self):
        """By name, or from the list of the last run: nobody has looked for it."""
        self.assertEqual(self.add('robot').command, ('cmd_vel',))
        self.start('cmd_vel', 'odom', *TB3_SIGN, node='turtlebot3_core')

        def at_root():
            self.fleet.supervise()
            return self.fleet.robot_type('robot').command == ('/cmd_vel',)
        wait_for(at_root, PATIENCE_S, 'its type', 0.1)
        self.drives('robot', 0.22)
        self.fleet.supervise()
        self.assertEqual(self.fleet.robot_type('robot').name, 'turtlebot3')

    def test_turtlesim_at_the_root_and_in_a_namespace(self):
        self.start('turtle1/cmd_vel', 'turtle1/pose', '--turtle', node='turtlesim')
        self.start('turtle1/cmd_vel', 'turtle1/pose', '--turtle', node='turtlesim',
                   namespace='/pond')
        facts = self.found('pond', 'robot')
        for name, topic in (('robot', '/turtle1/cmd_vel'), ('pond', 'turtle1/cmd_vel')):
            kind = self.add(name, facts[name])
            self.assertEqual((kind.name, kind.command), ('turtlesim', (topic,)))
            self.drives(name, 2.0)

    def test_two_turtles_of_one_turtlesim(self):
        process = Process([sys.executable, TURTLES, 'turtle1', 'turtle2'])
        self.addCleanup(self.cleared, process, '/turtlesim')
        facts = self.found('robot', 'turtle2')
        for name in ('robot', 'turtle2'):
            self.add(name, facts[name])
        for name, other in (('robot', 'turtle2'), ('turtle2', 'robot')):
            self.drives(name, 2.0)
            self.assertEqual(self.view(other).linear_mps, 0.0)

    def test_a_robot_without_odometry_is_not_said_to_be_waited_for(self):
        """It is driven."""
        self.start('cmd_vel', 'elsewhere', namespace='/mute')
        self.add('mute', self.found('mute')['mute'])
        wait_for(lambda: self.view('mute').link == 'live', PATIENCE_S, 'mute to be reached')
        self.assertIn('no odometry', self.view('mute').note)

    def test_a_robot_started_with_ros_namespace(self):
        rospy.set_param('/bot7/robot_type', 'turtlebot3')
        self.addCleanup(rospy.delete_param, '/bot7')
        rospy.set_param('/bot7/robot_model', 'burger')
        path = roslib.packages.find_node('mhri', 'sim_robot')[0]
        process = Process([path], {'ROS_NAMESPACE': 'bot7'})
        self.addCleanup(self.gone, process, '/bot7/base')
        kind = self.add('bot7', self.found('bot7')['bot7'])
        self.assertEqual(kind.label, 'TurtleBot3 Burger')
        wait_for(lambda: self.view('bot7').link == 'live', PATIENCE_S, 'bot7 to be heard')
        self.take_stick('bot7')
        wait_for(lambda: self.view('bot7').linear_mps > 0.1, PATIENCE_S, 'bot7 to move')

    def test_an_unknown_robot_is_driven_by_the_topic_it_has(self):
        self.start('drive/velocity', 'odom', namespace='/crawler')
        self.start('/tank_cmd_vel', 'odom', namespace='/tank')
        facts = self.found('crawler', 'tank')
        for name, topic in (('crawler', 'drive/velocity'), ('tank', '/tank_cmd_vel')):
            kind = self.add(name, facts[name])
            self.assertEqual((kind.name, kind.command), ('generic', (topic, 'cmd_vel')))
            self.drives(name, 0.5)
            for _ in range(3):
                self.fleet.supervise()
            self.assertEqual(self.fleet.robot_type(name), kind, 'it stays what it is')

    def test_an_unknown_robot_that_comes_up_after_it_was_added(self):
        self.add('late')
        self.start('drive/velocity', 'odom', namespace='/late')

        def known():
            self.fleet.supervise()
            return self.fleet.robot_type('late').command[0] == 'drive/velocity'
        wait_for(known, PATIENCE_S, 'its topic', 0.1)
        self.drives('late', 0.5)

    def test_a_robot_that_is_found_while_it_comes_up(self):
        """Its odometry is known, the topic that it listens to is not yet."""
        process = self.start('drive/velocity', 'odom', '--halfway', namespace='/half')
        self.assertEqual(self.add('half', self.found('half')['half']).command, ('cmd_vel',))
        process.send(signal.SIGUSR1)
        # What the gates learn first is no reason for the screen not to look.
        wait_for(lambda: getattr(self.gates.robot('half'), 'topic', ''), PATIENCE_S,
                 'the gates to know it')

        def known():
            self.fleet.supervise()
            return self.fleet.robot_type('half').command[0] == 'drive/velocity'
        wait_for(known, PATIENCE_S, 'its topic', 0.1)
        self.drives('half', 0.5)

    def test_a_robot_keeps_its_topic_while_it_is_away(self):
        process = self.start('drive/velocity', 'odom', namespace='/away')
        kind = self.add('away', self.found('away')['away'])
        wait_for(lambda: self.view('away').link == 'live', PATIENCE_S, 'away to be heard')
        self.gone(process, '/away/base')
        wait_for(lambda: self.view('away').link == 'gone', PATIENCE_S, 'away to be gone')
        self.fleet.supervise()
        self.assertEqual(self.fleet.robot_type('away'), kind)
        self.start('drive/velocity', 'odom', namespace='/away')
        self.drives('away', 0.5)

    def test_neither_mhri_nor_the_tools_of_ros_are_offered(self):
        self.start('/mhri_odd/cmd_vel', '/mhri_odd/odom', node='mhri_odd')
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        bag = os.path.join(folder.name, 'commands')
        for command, node in ((['rostopic', 'echo', '/cmd_vel'], '/rostopic_'),
                              (['rosbag', 'record', '-O', bag, '/cmd_vel'], '/record_')):
            process = Process(command)
            self.addCleanup(process.end)
            # rosbag record ends its own child when it is told to, not when it is killed.
            self.addCleanup(process.wait)
            self.addCleanup(process.send, signal.SIGINT)
            wait_for(lambda: any(name.startswith(node) for name in self.nodes()), PATIENCE_S,
                     node)
        publisher = rospy.Publisher('/cmd_vel', Twist, queue_size=1)
        self.addCleanup(publisher.unregister)
        wait_for(lambda: '/mux' in self.nodes() and publisher.get_num_connections(), PATIENCE_S)
        found = self.look()
        self.assertEqual((found.live, found.leftovers, found.refused), ((), (), ()))


if __name__ == '__main__':
    rospy.init_node('mhri_robot_types_test')
    rostest.rosrun('mhri', 'robot_types', RobotTypesTest)
