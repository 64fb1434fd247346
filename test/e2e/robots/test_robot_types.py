# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robots without a namespace, without a type, with topics of their own: found, added and driven.

Each robot is a process of its own on a real master, beside a real mux; looking and links are the
panel's.
"""
import signal
import sys
import time
import unittest

import rosgraph
import rospy

from support import graph
from support.own_node import own_node  # noqa: E402
from support.paths import GUARD, MESSAGES, PLAIN_ROBOT, TURTLES
try:
    import turtlesim.msg  # noqa: F401
except ImportError:
    sys.path.insert(0, MESSAGES)

from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_WAITING  # noqa: E402
from mhri.driving.ros.drive_client import DriveClient  # noqa: E402
from mhri.graph.ros.resources import robot_types  # noqa: E402
from mhri.graph.ros.worker import Worker  # noqa: E402
from mhri.msg import RobotDrive  # noqa: E402
from mhri.robots.ros.graph_scan import look_for_robots, shipped_ignore_list  # noqa: E402
from mhri.robots.ros.robot_monitors import RobotMonitors  # noqa: E402
from support.fake_mux import FakeOperator  # noqa: E402
from support.ros_system import insist, wait_for  # noqa: E402
from support.node_tools import FORWARD, NEUTRAL, Process, start_mux, Stick  # noqa: E402
from support.surgery import forget  # noqa: E402

system = own_node('robot_types')

TIMEOUT_S = 30.0
# How long the stick is held until it is centred and held once more [s].
HELD_S = 5.0
TB3_SIGN = ('--sign', 'sensor_state', 'turtlebot3_msgs/SensorState')
PARAMETERS = ('/robot_type', '/robot_model', '/robot_name')


class RobotTypesTest(unittest.TestCase):

    # The monitors of the test that runs.
    shown = None

    @classmethod
    def setUpClass(cls):
        cls.types, errors = robot_types()
        assert not errors, errors
        cls.mux = start_mux('__name:=mux')
        cls.stick, cls.operator = Stick(graph.STICK), FakeOperator()
        cls.operator.set(5.0, 5.0)
        cls.drive = DriveClient(
            lambda state, now: cls.shown and cls.shown.on_drive(state.robots),
            speaks=False).start()
        cls.worker = Worker('feeds').start()
        cls.stick.wait_listener()
        wait_for(cls.drive.answers, TIMEOUT_S)

    @classmethod
    def tearDownClass(cls):
        cls.stick.silence()
        cls.mux.send(signal.SIGTERM)
        cls.mux.wait(TIMEOUT_S)
        cls.mux.end()

    def setUp(self):
        self.ignore = shipped_ignore_list()
        type(self).shown = self.monitors = RobotMonitors(self.types, self.drive, self.worker)
        self.names = []
        self.addCleanup(self.end)

    def end(self):
        self.stick.hold(NEUTRAL)
        self.operator.check()
        rospy.set_param('/mhri/robots', [])
        # It looks at the list once a second, and one that never left it would keep its type.
        wait_for(lambda: not any(map(self.drive.robot, self.names)), TIMEOUT_S,
                 'the drive to forget its robots')
        for name in self.names:
            link = self.monitors.drop(name)
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
            wait_for(lambda: [topic, node] in self.listeners(), TIMEOUT_S, node + ' to be up')
        return process

    def gone(self, process, node):
        """End a process, and wait until the master has forgotten its node."""
        process.send(15)
        process.wait(TIMEOUT_S)
        process.end()
        wait_for(lambda: node not in self.nodes(), TIMEOUT_S, 'the end of ' + node)

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
        return wait_for(exactly, TIMEOUT_S, 'just {} to be found'.format(names), 0.1).facts

    def add(self, name, facts=None):
        """Take a robot into the list, as the panel does; return its type."""
        self.names.append(name)
        rospy.set_param('/mhri/robots', self.names)
        self.monitors.add(name)
        self.monitors.connect(name, facts)
        return self.monitors.robot_type(name)

    def view(self, name):
        return self.monitors.view(name, selected=True)

    def take_stick(self, name):
        """Check a robot, and hold the stick ahead once it has been centred."""
        self.stick.hold(NEUTRAL)
        self.operator.check(name)
        wait_for(lambda: self.view(name).obeys and not self.view(name).stands
                 and self.drive.robot(name).topic, TIMEOUT_S, lambda: '{} to be ready: {}'.format(
                     name, self.drive.robot(name)))
        self.stick.hold(FORWARD)

    def drives(self, name, most):
        """Drive a robot with all there is: as fast as it may; it stops when deselected."""
        wait_for(lambda: self.view(name).link == 'live', TIMEOUT_S, name + ' to be heard')

        def fast():
            view = self.view(name)
            return view.driven and abs(view.linear_mps - most) < 0.01

        def driven():
            self.take_stick(name)
            return wait_for(fast, HELD_S, '{} to move at {} m/s'.format(name, most))
        insist(driven, 'the stick to drive ' + name)
        self.operator.check()
        wait_for(lambda: self.view(name).linear_mps == 0.0, TIMEOUT_S, name + ' to stop')

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
        wait_for(lambda: '/robot/mhri_guard' in self.nodes(), TIMEOUT_S, 'the guard')
        self.add('robot', self.found('robot')['robot'])
        wait_for(lambda: self.view('robot').guarded, TIMEOUT_S, 'the guard to be heard')
        self.drives('robot', 0.22)

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
        self.start('cmd_vel', '/elsewhere', namespace='/mute')
        self.add('mute', self.found('mute')['mute'])
        wait_for(lambda: self.view('mute').link == 'live', TIMEOUT_S, 'mute to be reached')
        self.assertIn('no odometry', self.view('mute').note)

    def test_odometry_of_another_name_counts_once_it_has_followed(self):
        self.start('cmd_vel', 'odometry/filtered', namespace='/other')
        kind = self.add('other', self.found('other')['other'])
        self.assertEqual((kind.odometry, kind.found), (('odom', 'odometry/filtered'),
                                                       ('odometry',)))
        wait_for(lambda: self.view('other').link == 'live' and not self.view(
            'other').odometry_follows, TIMEOUT_S, 'its odometry, which is not proven')
        self.assertIn('odometry/filtered', self.view('other').note)

        def follows():
            self.take_stick('other')
            return wait_for(lambda: self.view('other').odometry_follows, HELD_S, 'it to follow')
        insist(follows, 'the odometry to follow the stick')
        self.operator.check()
        wait_for(lambda: self.view('other').note == '', TIMEOUT_S, 'nothing to be wrong with it')

    def test_no_stop_is_confirmed_by_it_where_the_drive_has_not_found_it(self):
        self.start('cmd_vel', 'odometry/filtered', namespace='/unknown')
        said = RobotDrive(name='unknown', topic='/unknown/cmd_vel', odometry_follows=True)

        class Unaware:
            robot, answers = staticmethod(lambda name: said), staticmethod(lambda: True)
        monitors = RobotMonitors(self.types, Unaware, self.worker)
        monitors.add('unknown')
        monitors.connect('unknown', self.found('unknown')['unknown'])
        self.addCleanup(monitors.close)
        wait_for(lambda: monitors.view('unknown').link == 'live', TIMEOUT_S, 'its odometry')
        monitors.on_drive([said])
        monitors.on_stop(True, time.monotonic())
        proof = wait_for(lambda: [one for one in [monitors.view('unknown').proof]
                                  if one.state != PROOF_WAITING], TIMEOUT_S, 'the end of it')[0]
        self.assertEqual(proof.state, PROOF_NOT_CONFIRMED)

    def test_odometry_of_another_name_at_the_root(self):
        """That of a robot with a namespace is not its own."""
        self.start('cmd_vel', 'odometry/filtered')
        self.start('cmd_vel', 'odom', namespace='/beside')
        facts = self.found('beside', 'robot')
        kind = self.add('robot', facts['robot'])
        self.assertEqual(kind.odometry, ('/odom', '/odometry/filtered'))
        wait_for(lambda: self.drive.robot('robot') and self.view('robot').link == 'live'
                 and not self.view('robot').odometry_follows, TIMEOUT_S, 'the drive to find it')

    def test_odometry_of_another_name_that_comes_later(self):
        """The only one is used, and the one that its type names, once that comes."""
        self.start('cmd_vel', '/elsewhere', namespace='/late')
        kind = self.add('late', self.found('late')['late'])
        self.assertEqual(kind.odometry, ('odom',))
        ekf = self.start('/unused', 'odometry/filtered', node='ekf', namespace='/late')

        def has(*odometry):
            self.monitors.supervise()
            return self.monitors.robot_type('late').odometry == odometry
        wait_for(lambda: has('odom', 'odometry/filtered'), TIMEOUT_S, 'the other odometry', 0.1)
        self.start('/unused', 'odom', node='wheels', namespace='/late')
        wait_for(lambda: has('odom'), TIMEOUT_S, 'its own odometry', 0.1)
        self.gone(ekf, '/late/ekf')
        self.assertTrue(has('odom'))

    def test_two_odometries_of_other_names_are_named(self):
        self.start('cmd_vel', 'odometry/filtered', namespace='/two')
        self.start('/unused', 'visual/odom', node='visual', namespace='/two')
        kind = self.add('two', self.found('two')['two'])
        self.assertEqual((kind.odometry, kind.found), (('odom',), ()))
        line = 'rosparam set /two/mhri/odometry "[odometry/filtered]"'
        wait_for(lambda: line in self.view('two').note, TIMEOUT_S, 'the line that uses one')
        rospy.set_param('/two/mhri/odometry', ['odometry/filtered'])
        self.addCleanup(rospy.delete_param, '/two/mhri')

        def used():
            self.monitors.supervise()
            return self.monitors.robot_type('two').odometry == ('odometry/filtered',)
        wait_for(used, TIMEOUT_S, 'that line to be followed', 0.1)
        self.drives('two', 0.5)

    def test_a_robot_behind_a_bridge(self):
        """One node outside of all namespaces is several robots."""
        self.start('/behind/cmd_vel', '/behind/odom', node='rosbridge_websocket')
        self.add('behind', self.found('behind')['behind'])
        self.drives('behind', 0.5)

    def test_an_unknown_robot_is_driven_by_the_topic_it_has(self):
        self.start('drive/velocity', 'odom', namespace='/crawler')
        self.start('/tank_cmd_vel', 'odom', namespace='/tank')
        facts = self.found('crawler', 'tank')
        for name, topic in (('crawler', 'drive/velocity'), ('tank', '/tank_cmd_vel')):
            kind = self.add(name, facts[name])
            self.assertEqual((kind.name, kind.command), ('generic', (topic, 'cmd_vel')))
            self.drives(name, 0.5)
            for _ in range(3):
                self.monitors.supervise()
            self.assertEqual(self.monitors.robot_type(name), kind, 'it stays what it is')

    def test_a_robot_that_is_found_while_it_comes_up(self):
        """Its odometry is known, the topic that it listens to is not yet."""
        process = self.start('drive/velocity', 'odom', '--halfway', namespace='/half')
        self.assertEqual(self.add('half', self.found('half')['half']).command, ('cmd_vel',))
        process.send(signal.SIGUSR1)
        # What the drive learns first is no reason for the screen not to look.
        wait_for(lambda: getattr(self.drive.robot('half'), 'topic', ''), TIMEOUT_S,
                 'the drive to know it')

        def known():
            self.monitors.supervise()
            return self.monitors.robot_type('half').command[0] == 'drive/velocity'
        wait_for(known, TIMEOUT_S, 'its topic', 0.1)
        self.drives('half', 0.5)

    def test_a_robot_keeps_its_topic_while_it_is_away(self):
        process = self.start('drive/velocity', 'odom', namespace='/away')
        kind = self.add('away', self.found('away')['away'])
        wait_for(lambda: self.view('away').link == 'live', TIMEOUT_S, 'away to be heard')
        self.gone(process, '/away/base')
        wait_for(lambda: self.view('away').link == 'gone', TIMEOUT_S, 'away to be gone')
        self.monitors.supervise()
        self.assertEqual(self.monitors.robot_type('away'), kind)
        self.start('drive/velocity', 'odom', namespace='/away')
        self.drives('away', 0.5)
