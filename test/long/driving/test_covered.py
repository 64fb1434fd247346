# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A laser that is covered on one side: the stick's brake, the guard's, and a robot on a task."""
import math

import rospy
from sensor_msgs.msg import LaserScan

from mhri.msg import RobotDrive
from support.drive_tools import BrakeCase
from support.own_node import own_node
from support.tasks_case import task_tool

system = own_node('covered', 'covered.launch')

# What the cover leaves of the right half, which it covers [degrees].
LEFT_DEG = 4
# Where a task sends it, ahead.
THERE = '11.1', 'y=2.6'


class Cover:
    """Passes the scans of bot1 on, covered or not; a dead laser measures nothing."""

    def __init__(self):
        self.covers = self.is_dead = False
        self._publisher = rospy.Publisher('/bot1/scan', LaserScan, queue_size=1)
        self._subscriber = rospy.Subscriber('/bot1/bare_scan', LaserScan, self._pass_on,
                                            queue_size=1)

    def _pass_on(self, scan):
        # 0.0 means "nothing there" as well.
        scan.ranges = [0.0] * len(scan.ranges) if self.is_dead else list(scan.ranges)
        for number in range(len(scan.ranges)) if self.covers else ():
            angle = scan.angle_min + number * scan.angle_increment
            if math.sin(angle) < 0.0 and abs(math.remainder(angle, 2.0 * math.pi)) > math.radians(
                    LEFT_DEG):
                scan.ranges[number] = math.nan
        self._publisher.publish(scan)


class Covered(BrakeCase):

    radius_m, speed_mps = 0.22, 0.25

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.cover = Cover()

    def stands_while_covered(self):
        """Push the stick: nothing moves while the laser is covered, and it does when it is not."""
        self.cover.covers = True
        self.addCleanup(setattr, self.cover, 'covers', False)
        self.keep_on(lambda: self.state.robot('bot1').brake == RobotDrive.BRAKE_UNSEEN,
                     'the word for it', self.speed_mps)
        before = self.hall.places.last()
        self.push_to_rest(self.speed_mps)
        self.assertLess(abs(self.hall.places.last() - before), 0.01)
        self.cover.covers = False
        self.drive_past(before + 0.1, self.speed_mps)
        self.cover.covers = True
        self.keep_on(lambda: self.state.robot('bot1').brake == RobotDrive.BRAKE_UNSEEN,
                     'the word for it while it drives', self.speed_mps)
        gap = self.push_to_rest(self.speed_mps)
        print('MEASURED gap to the wall of a robot whose laser was covered {:.2f} m before it: '
              '{:.2f} m'.format(12.0 - self.radius_m - before - 0.1, gap))
        self.assertGreater(gap, 0.3)
        self.cover.covers = False
        self.drive_to(10.9, -0.25)

    def test_the_stick_is_braked(self):
        self.bot1()
        self.ask(True)
        self.wait_robot('bot1', lambda robot: robot.brake == RobotDrive.BRAKE_ON, 'its laser')
        self.stands_while_covered()

    def test_the_guard_brakes(self):
        self.start_guard('_brake:=true')
        self.operator.check('bot1')
        self.wait_robot('bot1', lambda robot: robot.brake_on_robot
                        and robot.brake == RobotDrive.BRAKE_ON, 'the guard')
        self.ready('bot1')
        self.stands_while_covered()

    def test_a_laser_that_dies_while_the_brake_is_off_is_no_empty_hall(self):
        self.bot1()
        self.ask(True)
        self.wait_robot('bot1', lambda robot: robot.brake == RobotDrive.BRAKE_ON, 'its laser')
        self.ask(False)
        self.addCleanup(setattr, self.cover, 'is_dead', False)
        self.cover.is_dead = True
        place = self.hall.places.last()
        self.drive_to(place - 0.6, -0.25)
        before = self.hall.places.last()
        self.ask(True)
        self.wait_robot('bot1', lambda robot: robot.brake == RobotDrive.BRAKE_NO_SCAN, 'the word')
        self.push_to_rest(self.speed_mps)
        self.assertLess(self.hall.places.last() - before, 0.01)
        self.cover.is_dead = False
        self.drive_to(10.9, self.speed_mps)

    def test_a_task_ends_with_the_reason(self):
        before = self.hall.places.last()
        self.cover.covers = True
        self.addCleanup(setattr, self.cover, 'covers', False)
        tool = task_tool('bot1', 'goto', *THERE)
        self.addCleanup(tool.end)
        self.assertNotEqual(tool.wait(60.0), 0)
        self.assertIn('blocked', tool.said())
        self.assertLess(abs(self.hall.places.last() - before), 0.01)
        self.cover.covers = False
        again = task_tool('bot1', 'goto', *THERE)
        self.addCleanup(again.end)
        self.assertEqual(again.wait(60.0), 0, again.said())
        self.bot1()
        self.drive_to(10.9, -0.25)
