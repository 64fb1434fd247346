# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake for the stick: a simulated robot driven at a wall, and scans played here."""
import math
import threading
import time

import rospy
from sensor_msgs.msg import LaserScan

from mhri.msg import RobotDrive
from mhri.sensors.brake import CRAWL_MPS
from support.drive_case import ZERO
from support.drive_tools import BrakeCase
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('brake', 'brake.launch')


class Brake(BrakeCase):

    def test_a_wall_is_met_without_the_brake_and_not_with_it(self):
        self.bot1()
        self.ask(True)
        begun = time.monotonic()
        self.wait_robot('bot1', lambda robot: robot.brake == RobotDrive.BRAKE_ON, 'its laser')
        # With a scan that is late it may not see its way for a moment, and has no gap to say.
        slows = self.until_it_brakes(RobotDrive.BRAKE_SLOWS)
        self.assertGreater(slows.free_way_m, 0.0)
        within = self.push_to_rest(self.speed_mps)
        nearest = self.hall.least_gap(begun)
        self.operator.centre()
        self.ask(False)
        without = self.push_to_rest(self.speed_mps)
        print('MEASURED gap to the wall at {} m/s: {:.3f} m without the brake, {:.3f} m with it, '
              'never less than {:.3f} m'.format(self.speed_mps, without, within, nearest))
        self.assertLess(without, 0.03, 'it should have met the wall')
        self.assertGreater(nearest, 0.03)
        self.assertLess(within, 0.3)
        # Backing away is always possible.
        self.ask(True)
        self.drive_past(11.6, -0.4)

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
