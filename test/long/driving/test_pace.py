# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A slow link slows all robots of the selection down, where the parameter asks for it."""
import time
import unittest

import rospy

from mhri.robots.link_quality import link_share
from mhri.screen.ros.backend import ScreenBackend
from support.own_node import own_node
from support.relay import Delay, move_away
from support.ros_system import wait_for
from support.velocity import VelocityEnd

system = own_node('pace', 'pace.launch')

START_S = 60.0
SPEED_MPS = 0.1
# Of the link with which everything slows down, there and back [s].
FAR_S = 0.5


class PaceTest(unittest.TestCase):

    def setUp(self):
        self.delay = Delay()
        move_away(self.delay, '/bot1/odom', 'nav_msgs/Odometry', rospy.get_name())
        self.operator = ScreenBackend(['panel'])
        self.operator.start()
        self.addCleanup(self.operator.close)
        self.operator.add('bot1')
        self.operator.request_limits(SPEED_MPS, 1.0)
        self.end = VelocityEnd('/bot1/cmd_vel')
        wait_for(lambda: self.operator.view().ros == 'connected', START_S, 'the panel')

    def told(self):
        """Hold the stick, centred first; return the speed that the robot is told last."""
        self.operator.select(['bot1'])
        self.operator.repeat_selection()
        self.view = self.operator.view()
        ready = self.view.robots[0].driven or self.view.status.endswith('ready')
        self.operator.send_stick(1.0 if ready else 0.0, 0.0)
        time.sleep(0.05)
        return round(self.end.last()[0], 6)

    def test_the_pace_follows_the_parameter_and_the_link(self):
        wait_for(lambda: self.told() == SPEED_MPS, START_S, 'it to be driven')
        self.delay.one_way_s = FAR_S / 2.0
        wait_for(lambda: self.told() > 0.0 and 'slow link' in self.view.robots[0].note, START_S,
                 'the row to warn')
        wait_for(lambda: self.told() == SPEED_MPS, START_S, 'as fast: nobody asked for less')
        self.assertFalse(self.view.slowed)
        rospy.set_param('/mhri/panel', {'slow_with_link': True})
        slow = [round(SPEED_MPS * link_share(FAR_S + extra_s), 6) for extra_s in (0.0, 0.03, 0.1)]
        wait_for(lambda: self.told() in slow and self.view.slowed, START_S, 'it to be slowed down')
        self.assertIn('bot1', self.view.pace)
        print('MEASURED link of {:.0f} ms there and back: {:.0f} % of the speed, {!r}'.format(
            1e3 * FAR_S, 100 * self.told() / SPEED_MPS, self.view.pace))
        self.delay.one_way_s = 0.0
        wait_for(lambda: self.told() == SPEED_MPS, START_S, 'the full speed')
        rospy.delete_param('/mhri/panel')
