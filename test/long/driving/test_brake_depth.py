# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake of a robot without a laser: its depth camera sees a wall, and not the rear."""
import time

from mhri.msg import RobotDrive
from mhri.sensors.brake import CRAWL_MPS
from support.drive_tools import BrakeCase
from support.own_node import own_node
from support.velocity import VelocityEnd

system = own_node('brake_depth', 'brake_depth.launch')


class BrakeByDepth(BrakeCase):

    speed_mps = 0.5

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.end = VelocityEnd('/bot1/teleop/input')

    def setUp(self):
        super().setUp()
        self.bot1()
        self.ask(True)
        self.says(RobotDrive.BRAKE_ON)

    def says(self, word):
        """Wait until the drive says so of its brake."""
        return self.wait_robot('bot1', lambda robot: robot.brake == word, word)

    def test_it_stops_before_the_wall_and_crawls_back_from_it(self):
        begun = time.monotonic()
        self.until_it_brakes(RobotDrive.BRAKE_SLOWS)
        within = self.push_to_rest(self.speed_mps)
        print('MEASURED gap to the wall at {} m/s by a depth camera: {:.3f} m, never less than '
              '{:.3f} m'.format(self.speed_mps, within, self.hall.least_gap(begun)))
        self.assertGreater(self.hall.least_gap(begun), 0.0)
        self.assertLess(within, 0.6)
        self.operator.centre()
        self.ready('bot1')
        when = time.monotonic()
        # So near to the wall it may see nothing at all: it crawls as well.
        self.drive_past(11.0, -self.speed_mps)
        self.says(RobotDrive.BRAKE_UNSEEN)
        self.assertGreaterEqual(min(entry[1] for entry in self.end.after(when)), -CRAWL_MPS)
