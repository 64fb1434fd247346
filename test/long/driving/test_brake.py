# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake for the stick, where a laser cannot see, or looks back."""
import time

from nav_msgs.msg import Odometry
import rospy
from sensor_msgs.msg import LaserScan

from mhri.msg import RobotDrive
from support.drive_tools import BrakeCase
from support.own_node import own_node
from support.two_lasers import TwoLasers

system = own_node('brake', '../../e2e/driving/brake.launch')


class BrakeUnseen(BrakeCase):

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
        self.push_to_rest(self.speed_mps)
        self.operator.centre()
        return begun

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
