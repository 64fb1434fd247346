#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake of a robot without a laser: its depth camera sees a wall, and not the rear."""
from dataclasses import replace
import os
import sys
import time

import numpy as np
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from drive_tools import Hall, Hand, PATIENCE_S  # noqa: E402
from gates_case import GatesCase  # noqa: E402
from mhri.graph.ros.resources import robot_types  # noqa: E402
from mhri.msg import RobotGate  # noqa: E402
from mhri.robots.ros.tf_feed import TfFeed  # noqa: E402
from mhri.sensors.brake import CRAWL_MPS, SCAN_OLD_S  # noqa: E402
from mhri.tasks.ros.robot_senses import RobotSenses  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

SPEED_MPS = 0.5


class BrakeByDepth(GatesCase):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.hall = Hall('bot1', 0.177)
        cls.end = VelocityEnd('/bot1/teleop/input')

    def setUp(self):
        super().setUp()
        self.operator.check('bot1')
        self.state.wait_robot('bot1', lambda gate: gate.topic and gate.obeys == 'operator',
                              'the gate of bot1', PATIENCE_S)
        self.centre('bot1', self.end)
        self.operator.set(brake=True)
        self.says(RobotGate.BRAKE_ON)

    def tearDown(self):
        self.operator.set()
        self.state.wait(lambda state: not state.brake, 'the brake to be off')

    def says(self, word):
        """Wait until the gate says a word of its brake."""
        return self.state.wait_robot('bot1', lambda gate: gate.brake == word, word, PATIENCE_S)

    def hold(self, linear):
        """Hold the stick until the test lets it go."""
        hand = Hand(self.mux, linear, 0.0)
        self.addCleanup(hand.let_go)
        return hand

    def test_it_stops_before_the_wall_and_crawls_back_from_it(self):
        begun = time.monotonic()
        hand = self.hold(SPEED_MPS)
        self.says(RobotGate.BRAKE_SLOWS)
        within = self.hall.rests()
        print('MEASURED gap to the wall at {} m/s by a depth camera: {:.3f} m, never less than '
              '{:.3f} m'.format(SPEED_MPS, within, self.hall.least_gap(begun)))
        self.assertGreater(self.hall.least_gap(begun), 0.0)
        self.assertLess(within, 0.6)
        hand.let_go()
        self.mux.say(0.0)
        self.centre('bot1', self.end)
        when = time.monotonic()
        # So near to the wall it may see nothing at all: it crawls as well.
        self.hold(-SPEED_MPS)
        wait_for(lambda: any(entry[1] < 0.0 for entry in self.end.after(when)), PATIENCE_S,
                 'the way back')
        self.hall.places.wait(lambda x: x < 11.0, time.monotonic(), PATIENCE_S)
        self.says(RobotGate.BRAKE_UNSEEN)
        self.assertGreaterEqual(min(entry[1] for entry in self.end.after(when)), -CRAWL_MPS)

    def test_a_task_senses_by_it(self):
        frames = TfFeed(time.monotonic)
        frames.open()
        self.addCleanup(frames.close)
        senses = RobotSenses('bot1', replace(robot_types()[0]['turtlebot2'], scan=()),
                             frames=frames)
        self.addCleanup(senses.close)
        senses.open()

        def sees():
            senses.look()
            age_s = senses.ages()['scan_age_s']
            return age_s is not None and age_s < SCAN_OLD_S and len(senses.points()) > 0
        self.assertTrue(senses.has_eye and not senses.has_laser)
        wait_for(sees, PATIENCE_S, 'the depth camera')
        self.assertEqual(list(senses.looks()(np.array([[1.0, 0.0], [-1.0, 0.0]]))), [True, False])


if __name__ == '__main__':
    rospy.init_node('brake_depth_test')
    rostest.rosrun('mhri', 'brake_depth', BrakeByDepth)
