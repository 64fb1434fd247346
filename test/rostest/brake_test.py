#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake for the stick: a simulated robot driven at a wall, and scans played here."""
import math
import os
import signal
import sys
import threading
import time

from nav_msgs.msg import Odometry
import rospy
import rostest
from sensor_msgs.msg import LaserScan

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from drive_tools import Hall, Hand, PATIENCE_S  # noqa: E402
from gates_case import GatesCase, start_gates, ZERO  # noqa: E402
from mhri.msg import RobotGate  # noqa: E402
from mhri.sensors.brake import CRAWL_MPS  # noqa: E402
from rostest_tools import measured, Process  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.screen_end import Screen  # noqa: E402
from support.two_lasers import TwoLasers  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

SPEED_MPS = 0.6
HERE = os.path.dirname(os.path.realpath(__file__))
PLAIN = os.path.join(HERE, '..', 'support', 'plain_robot.py')
# What a laser says that has gone blind.
BLIND = (math.nan, 0.0, -math.inf, -1.0, 0.01)
# How fast the robots go whose laser goes blind [m/s].
BLIND_MPS = 0.2
# How often a robot is driven backwards at a wall.
TIMES = int(os.environ.get('MHRI_TIMES', '1'))


class Brake(GatesCase):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.hall = Hall('bot1', 0.177)

    def tearDown(self):
        self.ask(False)

    def ask(self, brake):
        """Switch the brake on or off."""
        self.operator.set(1.0, brake=brake)
        self.state.wait(lambda state: state.brake == brake, 'the brake to be {}'.format(brake))

    def hold(self, linear, angular=0.0):
        """Hold the stick until the test lets it go."""
        hand = Hand(self.mux, linear, angular)
        self.addCleanup(hand.let_go)
        return hand

    def bot1(self, name='bot1', topic='teleop/input'):
        """Check the simulated robot, or another one, and centre the stick."""
        end = VelocityEnd('/{}/{}'.format(name, topic))
        self.operator.check(name)
        self.state.wait_robot(name, lambda gate: gate.topic and gate.obeys == 'operator',
                              'the gate of ' + name, PATIENCE_S)
        self.centre(name, end)

    def drive_to(self, x, hall=None, mps=0.4):
        """Drive bot1, or that of a hall, back to a place, whatever the brake."""
        hand = self.hold(-mps)
        (hall or self.hall).places.wait(lambda now: now < x, time.monotonic(), PATIENCE_S)
        hand.let_go()
        self.mux.say(0.0)
        (hall or self.hall).rests()

    def plain(self, kind, *wall):
        """Start a plain robot of a type before a wall; return its name."""
        GatesCase.number += 1
        name = 'plain{}'.format(GatesCase.number)
        rospy.set_param('/{}/robot_type'.format(name), kind)
        topic = {'turtlebot2': 'teleop/input', 'turtlebot3': 'cmd_vel'}[kind]
        process = Process([sys.executable, PLAIN, topic, 'odom', '--wall', *wall],
                          env={'ROS_NAMESPACE': name})
        self.addCleanup(process.end)
        return name

    def test_a_wall_is_met_without_the_brake_and_not_with_it(self):
        self.bot1()
        self.ask(False)
        hand = self.hold(SPEED_MPS)
        self.hall.places.wait(lambda x: x > 11.0, patience_s=PATIENCE_S)
        without = self.hall.rests()
        hand.let_go()
        self.mux.say(0.0)
        self.drive_to(9.5)
        self.ask(True)
        begun = time.monotonic()
        self.state.wait_robot('bot1', lambda gate: gate.brake == RobotGate.BRAKE_ON, 'its laser')
        hand = self.hold(SPEED_MPS)
        slows = self.state.wait_robot('bot1', lambda gate: gate.brake == RobotGate.BRAKE_SLOWS,
                                      'the brake to act', PATIENCE_S)
        self.assertGreater(slows.free_way_m, 0.0)
        within = self.hall.rests()
        nearest = self.hall.least_gap(begun)
        hand.let_go()
        print('MEASURED gap to the wall at {} m/s: {:.3f} m without the brake, {:.3f} m with it, '
              'never less than {:.3f} m'.format(SPEED_MPS, without, within, nearest))
        self.assertLess(without, 0.03, 'it should have met the wall')
        self.assertGreater(nearest, 0.03)
        self.assertLess(within, 0.3)
        self.mux.say(0.0)
        # Backing away is always possible.
        self.drive_to(11.0)

    def test_who_stands_before_a_wall_can_turn(self):
        (name, end), _ = self.scanned(0.25)
        self.ask(True)
        self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_ON, 'its laser')
        self.centre(name, end)
        self.hold(0.2, 0.4)
        wait_for(lambda: end.values()[-1] == (0.0, 0.4), PATIENCE_S, 'it to turn on the spot')

    def test_who_stands_before_a_wall_that_is_too_near_to_be_seen_touches_it_by_no_way(self):
        """Its laser measures nothing nearer than 0.45 m."""
        self.touches_by_no_way('bot1', self.hall)
        self.ask(False)
        self.drive_to(11.0)

    def test_nor_does_a_plain_robot_touch_it(self):
        name = self.plain('turtlebot2', 'scan', '2.0', '0.45', '10.0', 'nan', '-0.087')
        self.touches_by_no_way(name, Hall(name, 0.18, 2.0))

    def touches_by_no_way(self, name, hall):
        """Drive a TurtleBot2 at a wall again and again, with what was seen of it lost or not."""
        def at_the_wall():
            self.bot1(name)
            self.ask(True)
            self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_ON, 'its laser')
            begun = time.monotonic()

            def acts():
                """Push the stick; a robot that was not heard for a moment asks to centre it."""
                gate = self.state.robot(name)
                self.mux.say(0.0 if gate.stands else SPEED_MPS)
                return gate.brake in (RobotGate.BRAKE_SLOWS, RobotGate.BRAKE_UNSEEN)
            wait_for(acts, PATIENCE_S, 'the brake to act', poll_s=0.05)
            return begun, self.hold(SPEED_MPS)
        _, hand = at_the_wall()
        hall.rests()
        hand.let_go()
        self.mux.say(0.0)
        for way in (self.uncheck, self.off_and_on, self.taken, self.new_gates):
            way(name)
            begun, hand = at_the_wall()
            hall.rests()
            hand.let_go()
            self.mux.say(0.0)
            print('MEASURED {}: gap to the wall after {}: never less than {:.3f} m'.format(
                name, way.__name__, hall.least_gap(begun)), flush=True)
            self.assertGreater(hall.least_gap(begun), 0.03, way.__name__)

    def uncheck(self, name):
        """Let nobody be checked for a moment."""
        self.operator.check()
        self.state.wait_robot(name, lambda gate: not gate.obeys, 'it to obey nobody')

    def off_and_on(self, _):
        """Switch the brake off; it is switched on after this."""
        self.ask(False)

    def taken(self, _):
        """Let another operator take control, and take it back."""
        other = Screen('other_screen')
        self.addCleanup(other.end)
        other.wait('the connection', lambda view: view['ros'] == 'connected')
        other.do('take')
        self.state.wait(lambda state: state.operator == other.name, 'another one in control')
        other.end()
        self.operator.take()
        self.state.wait(lambda state: state.operator == rospy.get_name(), 'control')

    def test_a_simulated_laser_that_goes_blind_leads_into_no_wall(self):
        self.goes_blind('bot3', Hall('bot3', 0.22), 9.3)

    def test_nor_does_that_of_a_plain_robot(self):
        name = self.plain('turtlebot3', 'seen', '2.9', '0.12', '3.5', 'inf', '-0.064')
        self.goes_blind(name, Hall(name, 0.22, 2.9), 0.2)

    def goes_blind(self, name, hall, begin_m):
        """Let the laser of a TurtleBot3 go blind on its way to a wall, and at rest before it."""
        glasses = Glasses(name)
        self.addCleanup(glasses.let_go)
        for value in BLIND:
            glasses.value = None
            self.bot1(name, 'cmd_vel')
            self.ask(True)
            self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_ON, 'its laser')
            hand = self.hold(BLIND_MPS)
            hall.places.wait(lambda x: x > begin_m + 0.4, time.monotonic(), PATIENCE_S)
            glasses.value, went_m = value, hall.places.last()
            self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_NO_SCAN,
                                  'the word')
            rests_m = hall.rests()
            print('MEASURED {}: {} at {} m/s: stands after {:.3f} m, {:.3f} m before the wall'
                  .format(name, value, BLIND_MPS, hall.places.last() - went_m, rests_m), flush=True)
            self.assertLess(hall.places.last() - went_m, 0.15)
            hand.let_go()
            self.mux.say(0.0)
            self.ask(False)
            glasses.value = None
            self.drive_to(begin_m, hall, BLIND_MPS)

    def new_gates(self, _):
        """Kill the gates, and start others that have seen nothing."""
        GatesCase.gates.send(signal.SIGKILL)
        GatesCase.gates.wait()
        GatesCase.gates = start_gates()
        self.wait_for_mux()

    def test_a_laser_that_measures_nothing_is_no_way(self):
        for value in (math.nan, 0.0, -math.inf, -1.0, 0.01):
            (name, end), scans = self.scanned(value, value)
            self.ask(True)
            self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_NO_SCAN,
                                  'the word')
            self.centre(name, end)
            begun = time.monotonic()
            hand = self.hold(-0.2)
            wait_for(lambda: (-CRAWL_MPS, 0.0) in [entry[1:] for entry in end.after(begun)],
                     PATIENCE_S, 'the crawl back')
            hand.let_go()
            self.stays_at_rest(end, self.mux.say(0.0), 0.2)
            self.ask(False)
            self.centre(name, end)
            self.assertEqual(self.drive(end, 0.2), (0.2, 0.0), 'without the brake it drives')
            self.centre(name, end)
            scans.let_go()
            self.operator.check()

    def test_a_laser_that_measures_nothing_any_more_stops_the_robot(self):
        for value in (math.nan, 0.0, -math.inf):
            (name, end), scans = self.scanned(3.0, 3.0)
            self.ask(True)
            self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_ON, 'its laser')
            self.centre(name, end)
            hand = self.hold(0.2)
            wait_for(lambda: end.values()[-1] == (0.2, 0.0), PATIENCE_S, 'it to drive')
            when = time.monotonic()
            scans.way_m = scans.rest_m = value
            wait_for(lambda: end.values()[-1] == ZERO, PATIENCE_S, 'the zero')
            measured('a laser gone blind ({}): zero'.format(value), next(
                at for at, *said in end.after(when) if tuple(said) == ZERO) - when)
            self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_NO_SCAN,
                                  'the word')
            hand.let_go()
            self.mux.say(0.0)
            scans.let_go()
            self.operator.check()

    def scanned(self, way_m, rest_m=math.inf):
        """Return ((name, receiving end) of a robot, whoever plays its scans)."""
        (name, end), = self.robots(1, 'turtlebot3')
        scans = Scans('/{}/scan'.format(name), way_m, rest_m)
        self.addCleanup(scans.let_go)
        return (name, end), scans

    def test_without_scans_there_is_no_way_forward_and_it_says_so(self):
        (name, end), scans = self.scanned(3.0)
        self.ask(True)
        self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_ON, 'its laser')
        self.centre(name, end)
        hand = self.hold(0.2)
        wait_for(lambda: end.values()[-1] == (0.2, 0.0), PATIENCE_S, 'it to drive')
        scans.let_go()
        wait_for(lambda: end.values()[-1] == ZERO, PATIENCE_S, 'the zero')
        self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_NO_SCAN, 'the word')
        self.assertFalse(self.state.robot(name).stands)
        hand.let_go()
        self.hold(-0.2)
        wait_for(lambda: end.values()[-1] == (-CRAWL_MPS, 0.0), PATIENCE_S, 'the crawl back')

    def test_a_scan_brakes_a_stick_that_says_nothing_new(self):
        (name, end), scans = self.scanned(3.0)
        self.ask(True)
        self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_ON, 'its laser')
        self.centre(name, end)
        self.drive(end, 0.2)
        scans.way_m = 0.1
        when = time.monotonic()
        # One command has been said: a lower one comes by itself, before the zero of staleness.
        wait_for(lambda: end.after(when), PATIENCE_S, 'the brake')
        self.assertLess(end.after(when)[0][1], 0.2)

    def test_a_type_without_a_laser_drives_and_says_so(self):
        (name, end), = self.robots(1, 'turtlesim', 'turtle1/cmd_vel')
        self.ask(True)
        self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_CANNOT, 'the word')
        self.assertEqual(self.drive(end, 0.2), (0.2, 0.0))

    def two_lasers(self, ahead_m, behind_m, tf=True, **kind):
        """Return the (name, receiving end) of a robot with a laser ahead and one behind."""
        name = 'gate{}'.format(GatesCase.number + 1)
        rospy.set_param('/{}/mhri'.format(name), dict(TwoLasers.TYPE, **kind))
        scan, rests = LaserScan(range_min=0.05, range_max=20.0), Odometry()
        scan.ranges = [ahead_m] + [float('inf')] * 179 + [behind_m] + [float('inf')] * 179
        rests.pose.pose.orientation.w = 1.0
        self.addCleanup(TwoLasers(name, lambda: (scan, rests), tf).let_go)
        (name, end), = self.robots(1, 'turtlebot3')
        self.ask(True)
        return name, end

    def obeys(self, name, end, linear, expected):
        """Hold the stick, and see what the robot gets; no more than that comes before."""
        self.centre(name, end)
        when = time.monotonic()
        hand = self.hold(linear, 0.1)
        wait_for(lambda: len(end.after(when)) > 5 and end.values()[-1] == (expected, 0.1),
                 PATIENCE_S, lambda: '{}, got {}'.format(expected, end.values()[-1]))
        hand.let_go()
        self.assertLessEqual(max(abs(entry[1]) for entry in end.after(when)), abs(expected))
        self.mux.say(0.0)

    def test_a_rear_laser_that_tf_alone_places_looks_back(self):
        """All on /tf, and odometry that does not name the robot's frame, as of stage_ros."""
        for behind, back, ahead, forward in ((0.25, 0.0, 9.0, 0.2), (9.0, -0.2, 0.25, 0.0)):
            name, end = self.two_lasers(ahead, behind)
            self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_ON, 'tf')
            self.obeys(name, end, -0.2, back)
            self.obeys(name, end, 0.2, forward)

    def test_lasers_that_nobody_places_let_it_turn_alone_and_it_is_said(self):
        name, end = self.two_lasers(9.0, 0.25, tf=False)
        self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_NO_PLACE, 'the word')
        self.obeys(name, end, -0.2, 0.0)
        self.obeys(name, end, 0.2, 0.0)

    def test_its_type_places_lasers_that_tf_does_not(self):
        name, end = self.two_lasers(9.0, 0.25, tf=False, lasers=[[0, 0, 0], [0, 0, 180]])
        self.state.wait_robot(name, lambda gate: gate.brake == RobotGate.BRAKE_ON, 'its lasers')
        self.obeys(name, end, -0.2, 0.0)
        self.obeys(name, end, 0.2, 0.2)

    def test_no_wall_behind_is_met_that_its_rear_laser_sees(self):
        """A simulated robot with its back to the wall, driven at it and away again."""
        seen = {}
        rospy.Subscriber('/bot2/scan', LaserScan, lambda scan: seen.update(scan=scan))
        rospy.Subscriber('/bot2/odom', Odometry, lambda odometry: seen.update(odometry=odometry))
        wait_for(lambda: len(seen) == 2, PATIENCE_S, 'bot2')
        rospy.set_param('/bot2/mhri', TwoLasers.TYPE)
        self.addCleanup(TwoLasers('bot2', lambda: (seen['scan'], seen['odometry'])).let_go)
        hall, end = Hall('bot2', 0.177), VelocityEnd('/bot2/teleop/input')
        self.operator.check('bot2')
        self.ask(True)
        self.state.wait_robot('bot2', lambda gate: gate.obeys == 'operator'
                              and gate.brake == RobotGate.BRAKE_ON, 'bot2', PATIENCE_S)
        for _ in range(TIMES):
            self.centre('bot2', end)
            begun = time.monotonic()
            hand = self.hold(-SPEED_MPS)
            hall.places.wait(lambda x: x > 11.3, begun, PATIENCE_S)
            within = hall.rests()
            hand.let_go()
            nearest = hall.least_gap(begun)
            print('MEASURED gap to the wall behind: {:.3f} m, never less than {:.3f} m'.format(
                within, nearest))
            self.assertGreater(nearest, 0.03)
            self.mux.say(0.0)
            self.centre('bot2', end)
            hand = self.hold(0.4)
            hall.places.wait(lambda x: x < 10.8, time.monotonic(), PATIENCE_S)
            hand.let_go()
            self.mux.say(0.0)


class Scans:
    """Plays the scans of one robot, 20 times a second: what is ahead, and what is elsewhere."""

    def __init__(self, topic, way_m, rest_m):
        self.way_m, self.rest_m = way_m, rest_m
        self._done = threading.Event()
        self._publisher = rospy.Publisher(topic, LaserScan, queue_size=1)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        message = LaserScan(angle_increment=2.0 * math.pi / 360.0, angle_max=2.0 * math.pi,
                            range_min=0.12, range_max=3.5)
        while not self._done.wait(0.05):
            message.ranges = [self.way_m] + [self.rest_m] * 359
            self._publisher.publish(message)

    def let_go(self):
        """Say nothing any more."""
        self._done.set()
        self._thread.join()
        self._publisher.unregister()


class Glasses:
    """Passes on the scans of a robot, ``seen``, as its ``scan``: every range one value, if any."""

    def __init__(self, name):
        self.value = None
        self._publisher = rospy.Publisher('/{}/scan'.format(name), LaserScan, queue_size=1)
        self._subscriber = rospy.Subscriber('/{}/seen'.format(name), LaserScan, self._on_scan,
                                            queue_size=1)

    def _on_scan(self, scan):
        if self.value is not None:
            scan.ranges = [self.value] * len(scan.ranges)
        self._publisher.publish(scan)

    def let_go(self):
        """Pass on nothing any more."""
        self._subscriber.unregister()
        self._publisher.unregister()


if __name__ == '__main__':
    rospy.init_node('brake_test')
    rostest.rosrun('mhri', 'brake', Brake)
