#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated robots as processes: nothing above them can tell that they are none."""
import math
import os
import sys
import threading
import time
import unittest
import xmlrpc.client

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rosgraph
import rospy
import rostest
from sensor_msgs.msg import BatteryState, Imu, LaserScan
from std_msgs.msg import Bool
from tf2_msgs.msg import TFMessage

SUPPORT = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', 'support')
sys.path.insert(0, os.path.dirname(SUPPORT))
# Behind what is installed: the message that takes the power from a TurtleBot2's motors.
sys.path.append(os.path.join(SUPPORT, 'messages'))

from kobuki_msgs.msg import MotorPower  # noqa: E402
from support.robots import report, Witness  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

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
RATES_HZ = {'odom': 50.0, 'imu': 100.0, 'scan': 10.0, 'tf': 50.0}
# An empty room of the plan, and two places in it a metre apart.
HERE, THERE = (1.5, 7.0, 0.0), (2.5, 7.0, 0.0)
BURGER_RADIUS_M = 0.105
PATIENCE_S = 20.0
# A machine under load may be late for so long.
LOADED_S, OLD_S = 120.0, 10.0


class Heard:
    """The messages of a topic, each with the time it came."""

    def __init__(self, topic, message_class, good=lambda message: True):
        self._changed = threading.Condition()
        self._good = good
        self.messages = []
        self.topic = topic
        self._subscriber = rospy.Subscriber(topic, message_class, self._on_message,
                                            queue_size=100, tcp_nodelay=True)

    def _on_message(self, message):
        if self._good(message):
            with self._changed:
                self.messages.append((time.monotonic(), message))
                self._changed.notify_all()

    def wait(self, count, begin=None):
        """Wait until so many have come from now on, or after the first ``begin``; return them."""
        with self._changed:
            begin = len(self.messages) if begin is None else begin
            if not self._changed.wait_for(lambda: len(self.messages) >= begin + count, PATIENCE_S):
                raise AssertionError('only {} messages on {}'.format(
                    len(self.messages) - begin, self.topic))
            return self.messages[begin:begin + count]

    def rate_hz(self, count, begin):
        """Return the rate at which so many messages come after the first ``begin``."""
        found = self.wait(count, begin)
        return (count - 1) / (found[-1][0] - found[0][0])

    def newest(self, good=lambda message: True):
        """Return the first message from now on that is good."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            message = self.wait(1)[0][1]
            if good(message):
                return message
        raise AssertionError('no such message on {}; the last is {}'.format(self.topic, message))

    def silent_for(self, seconds):
        """Tell whether nothing has come for so long."""
        with self._changed:
            return bool(self.messages) and time.monotonic() - self.messages[-1][0] > seconds

    def close(self):
        self._subscriber.unregister()


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
            (os.environ.get('PYTHONPATH', ''), os.path.join(SUPPORT, 'messages')))
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
            wanted.update(cameras(prefix, name == 'bot1'),
                          **({'/map': 'nav_msgs/OccupancyGrid'} if name == 'bot1' else {}))
            self.assertEqual({topic: types[topic] for topic in of_node(node, publishers)}, wanted)
            wanted = {prefix + topic: 'geometry_msgs/Twist' for topic in commands}
            wanted[prefix + POWER[robot_type][0]] = POWER[robot_type][1]._type
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

    def test_frames_and_covariances(self):
        for name, (_, _, _, imu_topic, *_) in ROBOTS.items():
            odom = self.hear('/{}/odom'.format(name), Odometry).newest()
            imu = self.hear('/{}/{}'.format(name, imu_topic), Imu).newest()
            scan = self.hear('/{}/scan'.format(name), LaserScan).newest()
            move = self.hear('/tf', TFMessage, lambda message, frame=name + '/odom': (
                message.transforms[0].header.frame_id == frame)).newest().transforms[0]
            self.assertEqual(
                (odom.header.frame_id, odom.child_frame_id, imu.header.frame_id,
                 scan.header.frame_id, move.header.frame_id, move.child_frame_id),
                tuple(name + '/' + frame for frame in (
                    'odom', 'base_link', 'imu_link', 'laser', 'odom', 'base_link')))
            for message in (odom, imu, scan, move):
                self.assertLess(abs((rospy.Time.now() - message.header.stamp).to_sec()), OLD_S)
            for matrix, size in ((odom.pose.covariance, 6), (odom.twist.covariance, 6),
                                 (imu.orientation_covariance, 3),
                                 (imu.angular_velocity_covariance, 3),
                                 (imu.linear_acceleration_covariance, 3)):
                self.assertEqual(len(matrix), size * size)
                self.assertTrue(all(matrix[index * (size + 1)] > 0.0 for index in range(size)))
            for turn in (odom.pose.pose.orientation, imu.orientation, move.transform.rotation):
                self.assertAlmostEqual(math.hypot(turn.z, turn.w), 1.0, 6)
            self.assertAlmostEqual(imu.linear_acceleration.z, 9.8, delta=0.5)
            self.assertEqual(len(scan.ranges), 360)
            self.assertAlmostEqual(scan.angle_min + 359 * scan.angle_increment, scan.angle_max, 4)

    def test_battery(self):
        for name in ('bot2', 'bot3'):
            battery = self.hear('/{}/battery_state'.format(name), BatteryState).newest()
            self.assertTrue(0.9 < battery.percentage <= 1.0 and battery.voltage > 12.0)

    def drive(self, name, topic, seconds, twist):
        """Send a command at 20 Hz for some time; return when the last one was sent."""
        publisher = rospy.Publisher('/{}/{}'.format(name, topic), Twist, queue_size=1,
                                    tcp_nodelay=True)
        wait_for(publisher.get_num_connections, PATIENCE_S, 'the robot to listen')
        rate, end = rospy.Rate(20), time.monotonic() + seconds
        while time.monotonic() < end:
            publisher.publish(twist)
            sent = time.monotonic()
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
                self.assertTrue(witness.moving())
                stood = wait_for(lambda: witness.stood_still_at(since), 5.0, 'standstill') - since
                report('{}/{} silent (watchdog {:g} s)'.format(name, topic, watchdog_s),
                       {name: stood})
                self.assertGreater(stood, watchdog_s - 0.15, 'stood too early')
                self.assertLess(stood, watchdog_s + 0.25, 'stood too late')
                wait_for(lambda: time.monotonic() > since + stood + 0.2, 1.0, 'the time to pass')
                self.assertFalse(witness.moved_since(since + stood))

    def test_without_power_it_stands_and_power_moves_nothing(self):
        twist = Twist()
        twist.linear.x = 9.0
        for name, (robot_type, _, _, _, commands, _) in ROBOTS.items():
            witness, (topic, without, with_power) = self.witnesses[name], POWER[robot_type]
            publisher = rospy.Publisher('/{}/{}'.format(name, topic), type(without), queue_size=1)
            wait_for(publisher.get_num_connections, PATIENCE_S, 'its switch')
            self.drive(name, commands[0], 0.4, twist)
            self.assertTrue(witness.moving())
            publisher.publish(without)
            since = time.monotonic()
            stood = wait_for(lambda: witness.stood_still_at(since), 5.0, 'standstill') - since
            report('{} without power'.format(name), {name: stood})
            self.drive(name, commands[0], 0.4, twist)
            publisher.publish(with_power)
            end = time.monotonic() + 0.4
            wait_for(lambda: time.monotonic() > end, 1.0, 'the time to pass')
            self.assertFalse(witness.moved_since(since + stood), 'power alone moved it')
            self.drive(name, commands[0], 0.4, twist)
            self.assertTrue(witness.moving())
            publisher.unregister()

    def test_what_is_not_finite_does_not_move_it(self):
        twist = Twist()
        twist.linear.x = math.nan
        since = time.monotonic()
        self.drive('bot2', 'cmd_vel', 0.5, twist)
        self.assertFalse(self.witnesses['bot2'].moved_since(since))
        self.assertTrue(self.witnesses['bot2'].live())

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
        wait_for(lambda: odometry.silent_for(0.3), 2.0, 'its topics to fall silent')
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
        first.wait(PATIENCE_S)
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
        wait_for(known, PATIENCE_S, 'the robots to register again')
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


if __name__ == '__main__':
    rostest.rosrun('mhri', 'sim', SimTest)
