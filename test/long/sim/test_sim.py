# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated robots as processes: nothing above them can tell that they are none."""
import math
import os
import sys
import time
import unittest
import xmlrpc.client

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rosgraph
import rospy
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Bool
from tf2_msgs.msg import TFMessage

from support.paths import MESSAGES
# Behind what is installed: the message that takes the power from a TurtleBot2's motors.
sys.path.append(MESSAGES)

from kobuki_msgs.msg import MotorPower  # noqa: E402
from support.heard import Heard, TIMEOUT_S  # noqa: E402
from support.robots import Witness  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402
from support.node_tools import measured  # noqa: E402


# What takes the power from its motors: topic, without, with.
POWER = {'turtlebot2': ('mobile_base/commands/motor_power', MotorPower(0), MotorPower(1)),
         'turtlebot3': ('motor_power', Bool(False), Bool(True))}
# What sim.launch starts: robot -> robot_type, robot_model, watchdog [s], IMU, commands, more.
ROBOTS = {
    'bot1': ('turtlebot2', None, 0.6, 'mobile_base/sensors/imu_data',
             ('teleop/input', 'cmd_vel_mux/input/teleop'), ()),
    'bot2': ('turtlebot3', 'burger', 0.5, 'imu', ('cmd_vel',), ('battery_state',)),
    'bot3': ('turtlebot3', 'waffle', 0.5, 'imu', ('cmd_vel',), ('battery_state',)),
}
# The accessories of a TurtleBot2: what it publishes, and what it subscribes.
TOOLS = ({'lamp_state': 'std_msgs/Bool', 'head_state': 'geometry_msgs/Vector3',
          'gripper_state': 'std_msgs/Int32', 'gripper/status': 'actionlib_msgs/GoalStatusArray',
          'gripper/feedback': 'actionlib/TestActionFeedback',
          'gripper/result': 'actionlib/TestActionResult', 'gas': 'std_msgs/Float32'},
         {'lamp': 'std_msgs/Bool', 'head': 'geometry_msgs/Vector3',
          'gripper/goal': 'actionlib/TestActionGoal', 'gripper/cancel': 'actionlib_msgs/GoalID'})
RATES_HZ = {'odom': 50.0, 'imu': 100.0, 'scan': 10.0, 'tf': 50.0}
# An empty room of the plan, and two places in it a metre apart.
HERE, THERE = (1.5, 7.0, 0.0), (2.5, 7.0, 0.0)
BURGER_RADIUS_M = 0.105
# A machine under load may be late for so long.
LOADED_S, OLD_S = 120.0, 10.0


def graph():
    """Return (publishers, subscribers, types) as dicts of the master."""
    master = rosgraph.Master('/sim_test')
    publishers, subscribers, _ = master.getSystemState()
    return dict(publishers), dict(subscribers), dict(master.getTopicTypes())


def of_node(node, named):
    """Return the topics of a node out of {topic: nodes}, without those that every node has."""
    return {topic for topic, nodes in named.items() if node in nodes} - {'/rosout', '/clock'}


def process_id(node):
    """Return the process of a node."""
    uri = rosgraph.Master('/sim_test').lookupNode(node)
    return xmlrpc.client.ServerProxy(uri).getPid('/sim_test')[2]


def cameras(prefix, with_depth):
    """Return {topic: type} of a robot's cameras."""
    found = {}
    for base, transport in (('camera/rgb/', 'compressed'),) + (
            (('camera/depth_registered/', 'compressedDepth'),) if with_depth else ()):
        image = prefix + base + 'image_raw'
        found.update({image: 'sensor_msgs/Image', prefix + base + 'camera_info':
                      'sensor_msgs/CameraInfo', image + '/' + transport:
                      'sensor_msgs/CompressedImage'})
    if with_depth:
        found[prefix + 'camera/depth_registered/points'] = 'sensor_msgs/PointCloud2'
    return found


class SimTest(unittest.TestCase):

    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.system = System()
        cls.system.start_master()
        cls.system.env['PYTHONPATH'] = os.pathsep.join(
            (os.environ.get('PYTHONPATH', ''), MESSAGES))
        cls.system.launch('sim.launch', 'n:=3')
        rospy.init_node('sim_test', disable_signals=True)
        cls.witnesses = {name: Witness(name) for name in ROBOTS}
        wait_for(lambda: all(witness.live() for witness in cls.witnesses.values()), LOADED_S,
                 'the robots')

    @classmethod
    def tearDownClass(cls):
        rospy.signal_shutdown('done')
        cls.system.close()

    def start(self, name, place, robot_type='turtlebot3', model='burger'):
        """Start a robot of its own for a test; it does not outlive it."""
        rospy.set_param('/{}/robot_type'.format(name), robot_type)
        rospy.set_param('/{}/robot_model'.format(name), model)
        process = self.system.node('sim_robot', '__ns:=' + name, '__name:=base',
                                   *('_{}:={}'.format(*pair) for pair in zip('xy', place)),
                                   '_yaw:={}'.format(place[2]))
        self.addCleanup(lambda: process.poll() is None and self.system.kill(process, 15))
        return process

    def hear(self, *arguments):
        heard = Heard(*arguments)
        self.addCleanup(heard.close)
        return heard

    def test_topics_are_exactly_those_of_the_template(self):
        publishers, subscribers, types = graph()
        for name, (robot_type, _, _, imu, commands, more) in ROBOTS.items():
            prefix, node = '/' + name + '/', '/' + name + '/base'
            wanted = {'/tf': 'tf2_msgs/TFMessage', '/tf_static': 'tf2_msgs/TFMessage',
                      prefix + 'odom': 'nav_msgs/Odometry',
                      prefix + imu: 'sensor_msgs/Imu', prefix + 'scan': 'sensor_msgs/LaserScan',
                      node + '/faults': 'std_msgs/String',
                      **{prefix + topic: 'sensor_msgs/BatteryState' for topic in more}}
            tools = TOOLS if name == 'bot1' else ({}, {})
            wanted.update({prefix + topic: kind for topic, kind in tools[0].items()})
            wanted.update(cameras(prefix, name == 'bot1'),
                          **({'/map': 'nav_msgs/OccupancyGrid'} if name == 'bot1' else {}))
            self.assertEqual({topic: types[topic] for topic in of_node(node, publishers)}, wanted)
            wanted = {prefix + topic: 'geometry_msgs/Twist' for topic in commands}
            wanted[prefix + POWER[robot_type][0]] = POWER[robot_type][1]._type
            wanted.update({prefix + topic: kind for topic, kind in tools[1].items()})
            self.assertEqual({topic: types[topic] for topic in of_node(node, subscribers)}, wanted)

    def test_parameters(self):
        for name, (robot_type, model, *_) in ROBOTS.items():
            self.assertEqual(rospy.get_param('/{}/robot_type'.format(name)), robot_type)
            self.assertEqual(rospy.get_param('/{}/robot_model'.format(name), None), model)

    def test_rates(self):
        heard = {}
        for name, (_, _, _, imu, *_) in ROBOTS.items():
            heard[name, 'odom'] = self.hear('/{}/odom'.format(name), Odometry)
            heard[name, 'imu'] = self.hear('/{}/{}'.format(name, imu), Imu)
            heard[name, 'scan'] = self.hear('/{}/scan'.format(name), LaserScan)
            heard[name, 'tf'] = self.hear('/tf', TFMessage, lambda message, frame=name + '/odom': (
                message.transforms[0].header.frame_id == frame))
        for each in heard.values():
            each.newest()
        rates = {}

        def right():
            """Measure all that was not right so far, over the same time; tell whether all is."""
            begun = {key: len(each.messages) for key, each in heard.items()
                     if abs(rates.get(key, 0.0) / RATES_HZ[key[1]] - 1.0) >= 0.1}
            for key, begin in begun.items():
                rates[key] = heard[key].rate_hz(int(3 * RATES_HZ[key[1]]) + 1, begin)
            return not begun
        wait_for(right, LOADED_S, lambda: '{} of {}'.format(rates, RATES_HZ))
        for kind in RATES_HZ:
            print('MEASURED {}: {}'.format(kind, ', '.join(
                '{} {:.1f} Hz'.format(name, rates[name, kind]) for name in ROBOTS)), flush=True)

    def drive(self, name, topic, seconds, twist):
        """Send a command at 20 Hz for some time; return when the last one was sent."""
        publisher = rospy.Publisher('/{}/{}'.format(name, topic), Twist, queue_size=1,
                                    tcp_nodelay=True)
        wait_for(publisher.get_num_connections, TIMEOUT_S, 'the robot to listen')
        rate, end = rospy.Rate(20), time.monotonic() + seconds
        while time.monotonic() < end:
            sent = time.monotonic()
            publisher.publish(twist)
            rate.sleep()
        publisher.unregister()
        return sent

    def test_watchdog(self):
        twist = Twist()
        twist.linear.x, twist.angular.z = 9.0, 0.5
        for name, (_, _, watchdog_s, _, commands, _) in ROBOTS.items():
            witness = self.witnesses[name]
            for topic in commands:
                since = self.drive(name, topic, 0.6, twist)
                wait_for(lambda: witness.moved_since(since), what='motion')
                stood = wait_for(lambda: witness.stood_still_at(since), what='standstill') - since
                self.assertGreater(stood, watchdog_s - 0.15, 'stood too early')
                measured('{}/{} silent, stands still'.format(name, topic), stood)
                wait_for(lambda: time.monotonic() > since + stood + 0.2, what='the time to pass')
                self.assertFalse(witness.moved_since(since + stood))

    def test_without_power_it_stands_and_power_moves_nothing(self):
        twist = Twist()
        twist.linear.x = 9.0
        for name, (robot_type, _, _, _, commands, _) in ROBOTS.items():
            witness, (topic, without, with_power) = self.witnesses[name], POWER[robot_type]
            publisher = rospy.Publisher('/{}/{}'.format(name, topic), type(without), queue_size=1)
            wait_for(publisher.get_num_connections, TIMEOUT_S, 'its switch')
            since = self.drive(name, commands[0], 0.4, twist)
            wait_for(lambda: witness.moved_since(since), what='motion')
            publisher.publish(without)
            since = time.monotonic()
            stood = wait_for(lambda: witness.stood_still_at(since), what='standstill') - since
            measured('{} without power, stands still'.format(name), stood)
            self.drive(name, commands[0], 0.4, twist)
            publisher.publish(with_power)
            end = time.monotonic() + 0.4
            wait_for(lambda: time.monotonic() > end, what='the time to pass')
            self.assertFalse(witness.moved_since(since + stood), 'power alone moved it')
            since = self.drive(name, commands[0], 0.4, twist)
            wait_for(lambda: witness.moved_since(since), what='motion')
            publisher.unregister()

    def test_what_another_sees_of_it_from_start_to_end(self):
        """It is seen, killed, back elsewhere, replaced by one of its name, and switched off."""
        self.start('here', HERE)
        killed = self.start('there', THERE)
        scans = self.hear('/here/scan', LaserScan)
        odometry = self.hear('/there/odom', Odometry)
        self.they_see_each_other(scans)
        first = self.killed_its_body_stays_until_it_is_back(killed, scans, odometry)
        leaver = self.second_of_one_name_ends_the_first_and_is_seen(first, scans)
        self.system.kill(leaver, 15)
        scans.newest(lambda message: message.ranges[0] > 1.2)
        with open(leaver.log) as stream:
            self.assertNotIn('Traceback', stream.read(), 'its body is carried away')

    def they_see_each_other(self, scans):
        gap = THERE[0] - HERE[0] - BURGER_RADIUS_M
        for heard, ray in ((scans, 0), (self.hear('/there/scan', LaserScan), 180)):
            scan = heard.newest(lambda message, ray=ray: message.ranges[ray] < 1.2)
            self.assertAlmostEqual(scan.ranges[ray], gap, delta=0.05)

    def killed_its_body_stays_until_it_is_back(self, killed, scans, odometry):
        """Return the one that is back, to the left of where it was."""
        odometry.newest()
        self.system.kill(killed)
        wait_for(lambda: odometry.silent_for(0.3), what='its topics to fall silent')
        self.assertLess(max(message.ranges[0] for _, message in scans.wait(10)), 1.2)
        back = self.start('there', (THERE[0], THERE[1] + 1.0, 0.0))
        odometry.newest()
        scans.newest(lambda message: message.ranges[0] > 1.2)
        self.assertAlmostEqual(scans.newest().ranges[45], math.sqrt(2.0) - BURGER_RADIUS_M,
                               delta=0.05)
        return back

    def second_of_one_name_ends_the_first_and_is_seen(self, first, scans):
        """Return the second, where the one that was killed stood."""
        second = self.start('there', THERE)
        first.wait(TIMEOUT_S)
        scans.newest(lambda message: message.ranges[0] < 1.2 and message.ranges[45] > 1.4)
        return second

    def test_restarted_master_knows_it_again(self):
        before = {name: process_id('/{}/base'.format(name)) for name in ROBOTS}
        wanted = {name: [of_node('/{}/base'.format(name), side) for side in graph()[:2]]
                  for name in ROBOTS}
        odometry = self.hear('/bot1/odom', Odometry)
        odometry.newest()
        self.system.kill(self.system.master)
        odometry.wait(10)
        self.system.start_master()

        def known():
            master = rosgraph.Master('/sim_test')
            return all(master.hasParam('/{}/robot_type'.format(name)) for name in ROBOTS) and {
                name: [of_node('/{}/base'.format(name), side) for side in graph()[:2]]
                for name in ROBOTS} == wanted
        begun = time.monotonic()
        wait_for(known, TIMEOUT_S, 'the robots to register again')
        print('MEASURED master restarted: the robots are known again after {:.0f} ms'.format(
            (time.monotonic() - begun) * 1e3), flush=True)
        self.test_parameters()
        self.assertEqual({name: process_id('/{}/base'.format(name)) for name in ROBOTS}, before)

    def test_what_cannot_be_ends_with_1_and_says_why(self):
        good = {'robot_type': 'turtlebot3', 'robot_model': 'burger'}
        # What is said, the parameters of the robot, its name if that is what cannot be, arguments.
        cases = [('named after it', {}, '/'),
                 ('named after it', {}, '/a/b'),
                 ("no simulated body for 'generic'", {}),
                 ("no template 'turtelbot2'", {'robot_type': 'turtelbot2'}),
                 ("no simulated body for 'turtlebot3'", {'robot_type': 'turtlebot3'}),
                 ("no model 'large'", {'robot_type': 'turtlebot3', 'robot_model': 'large'}),
                 ('/{}/base/x: expected a number', good, None, '_x:=left'),
                 ('cannot stand at', good, None, '_x:=nan'),
                 ('cannot stand at', good, None, '_x:=0.05', '_y:=1.0'),
                 ('/no/such/plan.yaml', good, None, '_plan:=/no/such/plan.yaml')]
        started = []
        for number, (said, parameters, *more) in enumerate(cases):
            name, arguments = (more or [None])[0] or 'odd{}'.format(number), more[1:]
            for key, value in parameters.items():
                rospy.set_param('/{}/{}'.format(name, key), value)
            process = self.system.node('sim_robot', '__ns:=' + name, '__name:=base', *arguments)
            self.addCleanup(lambda one=process: one.poll() is None and self.system.kill(one))
            started.append((process, said.format(name)))
        for process, said in started:
            status = process.wait(LOADED_S)
            with open(process.log) as stream:
                text = stream.read()
            self.assertEqual(status, 1, text)
            self.assertIn(said, text)
            self.assertNotIn('Traceback', text)
