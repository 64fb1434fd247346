# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake for the stick: a simulated robot driven at a wall, and scans played here."""
import math
import threading
import time

from nav_msgs.msg import Odometry
import rospy
from sensor_msgs.msg import LaserScan

from mhri.msg import RobotDrive
from mhri.sensors.brake import CRAWL_MPS
from support.drive_case import ZERO
from support.drive_tools import HallCase
from support.own_node import own_node
from support.ros_system import wait_for
from support.two_lasers import TwoLasers

system = own_node('brake', '../../e2e/driving/brake.launch')

SPEED_MPS = 0.6


class Brake(HallCase):

    def tearDown(self):
        self.ask(False)

    def ask(self, brake):
        """Switch the brake on or off."""
        self.operator.set(1.0, brake=brake)
        self.state.wait(lambda state: state.settings.brake == brake, 'the brake')

    def bot1(self):
        """Select the simulated robot, and centre the stick."""
        self.operator.check('bot1')
        self.ready('bot1')

    def test_a_wall_is_met_without_the_brake_and_not_with_it(self):
        self.bot1()
        self.ask(False)
        self.drive_past(11.0, SPEED_MPS)
        without = self.push_to_rest(SPEED_MPS)
        self.operator.centre()
        self.drive_to(9.5)
        self.ask(True)
        begun = time.monotonic()
        self.wait_robot('bot1', lambda robot: robot.brake == RobotDrive.BRAKE_ON, 'its laser')
        # With a scan that is late it may not see its way for a moment, and has no gap to say.
        slows = self.until_it_brakes(RobotDrive.BRAKE_SLOWS)
        self.assertGreater(slows.free_way_m, 0.0)
        within = self.push_to_rest(SPEED_MPS)
        nearest = self.hall.least_gap(begun)
        self.operator.centre()
        print('MEASURED gap to the wall at {} m/s: {:.3f} m without the brake, {:.3f} m with it, '
              'never less than {:.3f} m'.format(SPEED_MPS, without, within, nearest))
        self.assertLess(without, 0.03, 'it should have met the wall')
        self.assertGreater(nearest, 0.03)
        self.assertLess(within, 0.3)
        # Backing away is always possible.
        self.drive_to(11.0)

    def test_who_stands_before_a_wall_that_is_too_near_to_be_seen_touches_it_by_no_way(self):
        """Its laser measures nothing nearer than 0.45 m; what was seen of the wall may be lost."""
        self.at_the_wall()
        # The next drive has seen nothing.
        self.wait_for_drive(self.kill_drive()[1])
        begun = self.at_the_wall()
        print('MEASURED gap to the wall: never less than {:.3f} m'.format(
            self.hall.least_gap(begun)), flush=True)
        self.assertGreater(self.hall.least_gap(begun), 0.03)
        self.ask(False)
        self.drive_to(11.0)

    def at_the_wall(self):
        """Drive bot1 at the wall until it stands; return when that began."""
        self.bot1()
        self.ask(True)
        self.wait_robot('bot1', lambda robot: robot.brake == RobotDrive.BRAKE_ON, 'its laser')
        begun = time.monotonic()
        self.until_it_brakes(RobotDrive.BRAKE_SLOWS, RobotDrive.BRAKE_UNSEEN)
        self.push_to_rest(SPEED_MPS)
        self.operator.centre()
        return begun

    def until_it_brakes(self, *states):
        """Drive bot1 ahead until its brake is in one of these states; return what is said then."""
        def acts():
            robot = self.state.robot('bot1')
            return robot.brake in states and robot
        return self.keep_on(acts, 'the brake to act', SPEED_MPS)

    def scanned(self, way_m, rest_m=math.inf):
        """Return ((name, receiving end) of a robot, whoever plays its scans)."""
        (name, end), = self.robots(1, 'turtlebot3')
        scans = Scans('/{}/scan'.format(name), way_m, rest_m)
        self.addCleanup(scans.let_go)
        return (name, end), scans

    def test_without_scans_there_is_no_way_forward_and_it_says_so(self):
        """Of one that goes blind, and one that falls silent."""
        for goes in (Scans.go_blind, Scans.let_go):
            (name, end), scans = self.scanned(3.0, 3.0)
            self.ask(True)
            self.wait_robot(name, lambda robot: robot.brake == RobotDrive.BRAKE_ON, 'its laser')
            self.ready(name)
            self.keep_on(lambda: end.last() == (0.1875, 0.0), 'it to drive', 0.1875)
            goes(scans)
            wait_for(lambda: end.last() == ZERO, what='the zero')
            self.wait_robot(name, lambda robot: robot.brake == RobotDrive.BRAKE_NO_SCAN, 'the word')
            self.assertFalse(self.state.robot(name).stands)
            self.keep_on(lambda: end.last() == (-CRAWL_MPS, 0.0), 'the crawl back', -0.1875)
            self.operator.centre()
            scans.let_go()

    def test_a_rear_laser_that_tf_alone_places_looks_back(self):
        """All on /tf, and odometry that does not name the robot's frame, as of stage_ros."""
        name = self.next_name()
        rospy.set_param('/{}/mhri'.format(name), TwoLasers.TYPE)
        scan, rests = LaserScan(range_min=0.05, range_max=20.0), Odometry()
        scan.ranges = [9.0] + [float('inf')] * 179 + [0.25] + [float('inf')] * 179
        rests.pose.pose.orientation.w = 1.0
        self.addCleanup(TwoLasers(name, lambda: (scan, rests)).let_go)
        (name, end), = self.robots(1, 'turtlebot3')
        self.ask(True)
        self.wait_robot(name, lambda robot: robot.brake == RobotDrive.BRAKE_ON, 'tf')
        for linear, expected in ((-0.1875, 0.0), (0.1875, 0.1875)):
            self.ready(name)
            when = time.monotonic()
            self.keep_on(lambda: len(end.after(when)) > 5 and end.last() == (expected, 0.1875),
                         lambda: '{}, got {}'.format(expected, end.last()), linear, 0.1875)
            self.operator.centre()
            self.assertLessEqual(max(abs(entry[1]) for entry in end.after(when)), abs(expected))


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

    def go_blind(self):
        """Measure nothing any more."""
        self.way_m = self.rest_m = math.nan

    def let_go(self):
        """Say nothing any more."""
        self._done.set()
        self._thread.join()
        self._publisher.unregister()
