# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One wish, one owner: speed, seat and mode are those of the operator in control alone."""
import json
import time

import rospy
from std_srvs.srv import Trigger

from support.drive_case import DriveCase
from support.graph import SELECT, TAKE_CONTROL
from support.own_node import own_node
from support.node_tools import Process
from support.velocity import VelocityEnd

system = own_node('wish')

SLOW_MPS, TYPE_MPS = 0.12, 0.5
# As a message carries it, and what rounding adds.
MAX_MPS = SLOW_MPS + 1e-6
FAST = {'linear_mps': 1.2, 'angular_rad_s': 3.0}


class WishTest(DriveCase):

    def setUp(self):
        """Put this node in control, slow, with two robots of which one is selected."""
        super().setUp()
        (self.ours, self.end), = self.robots(1)
        self.other = self.new_name()
        self.other_end = VelocityEnd('/{}/cmd_vel'.format(self.other))
        self.begun = time.monotonic()
        self.operator.set(SLOW_MPS, 1.0)
        self.addCleanup(self.operator.set)
        self.state.wait(lambda state: abs(state.settings.linear_mps - SLOW_MPS) < 1e-6, 'the wish')

    def pushed(self, mps):
        """Push the stick fully until the robot is sent this speed [m/s]."""
        self.keep_on(lambda: round(self.end.last()[0], 3) == mps,
                     lambda: '{} m/s, got {}; {}'.format(
                         mps, self.end.last(), self.state.robot(self.ours)),
                     self.operator.limits[0])

    def kill(self):
        """Kill what works of the mux, and wait for what takes over."""
        _, run = self.kill_drive()
        self.state.wait(lambda state: state.run != run, 'the next one')

    def script(self, *options, robots=(), settings=(), mode='', name='lab_script'):
        """Start a program that publishes a selection."""
        wish = json.dumps({'robots': list(robots), 'settings': list(settings), 'mode': mode})
        process = Process(['rostopic', 'pub', *options, SELECT, 'mhri/RobotSelect', wish,
                           '__name:=' + name])
        self.addCleanup(process.end)

    def refused(self):
        """Wait until the script's messages are refused, and it is named."""
        self.state.wait(lambda state: any('/lab_script: robot_select' in line
                                          for line in state.refused), 'the refusal')

    def empty_seat(self):
        """Leave the seat until the test is over."""
        self.operator.leave()
        self.addCleanup(self.operator.take)
        self.addCleanup(self.operator.come_back)
        self.state.wait(lambda state: not state.operator, 'an empty seat')

    def test_nobody_else_makes_the_driver_faster_nor_becomes_the_operator_by_waiting(self):
        self.script('-r', '10', robots=[self.ours, self.other], settings=[FAST], mode='pedal')
        self.refused()
        self.pushed(SLOW_MPS)
        for replace in (self.kill, self.kill_both, self.start_second):
            replace()
            self.pushed(SLOW_MPS)
            said = self.state.message
            self.assertEqual((said.operator, said.mode), (rospy.get_name(), 'joy'))
            self.assertAlmostEqual(said.settings.linear_mps, SLOW_MPS, 6)
        self.empty_seat()
        for replace in (self.kill, self.kill_both, self.start_second):
            replace()
            self.refused()
            self.assertEqual(self.state.message.operator, '')
            self.assertAlmostEqual(self.state.message.settings.linear_mps, SLOW_MPS, 6)
        self.assertLessEqual(max(mps for _, mps, _ in self.end.after(self.begun)), MAX_MPS)
        self.assertFalse([entry for entry in self.other_end.received if any(entry[1:])])

    def test_a_latched_message_of_the_past_is_no_wish(self):
        self.empty_seat()
        self.script('--latch', robots=[self.other], settings=[FAST], name='past')
        rospy.rostime.wallsleep(2.0)
        self.assertEqual(self.state.message.operator, '')
        self.assertAlmostEqual(self.state.message.settings.linear_mps, SLOW_MPS, 6)
        self.script('-r', '2', robots=[self.other], name='present')
        self.state.wait(lambda state: state.operator == '/present', 'the seat')

    def test_who_gets_control_back_is_not_made_faster_by_another(self):
        self.script('-r', '10', robots=[self.other], settings=[FAST])
        self.refused()
        self.operator.set(None)
        # In the name of the script.
        take = rospy.ServiceProxy(TAKE_CONTROL, Trigger, headers={'callerid': '/lab_script'})
        self.assertTrue(take().success)
        self.state.wait(lambda state: state.operator == '/lab_script'
                        and state.settings.linear_mps > 1.0, 'its settings')
        self.operator.take()
        self.select_anew(self.ours)
        self.pushed(SLOW_MPS)
        self.assertAlmostEqual(self.state.message.settings.linear_mps, SLOW_MPS, 6)

    def test_a_limit_that_rises_before_the_robot_has_moved_does_not_count_either(self):
        name, topic = self.new_name(), '/{}/cmd_vel'
        rospy.set_param('/{}/mhri'.format(name), {'limits': {'linear_mps': 0.1}})
        self.end = VelocityEnd(topic.format(name))
        self.operator.set(1.0, 1.0)
        self.select_anew(name)
        self.ready(name)
        rospy.delete_param('/{}/mhri'.format(name))
        self.wait_robot(name, lambda robot: robot.stands == 'limit_raised', 'the sign')
        self.ours = name
        self.pushed(0.1)
        self.assertLessEqual(max(entry[1] for entry in self.end.received), 0.1)

    def test_a_limit_that_rises_counts_once_the_robot_is_selected_anew(self):
        self.operator.set(1.0, 1.0)
        self.pushed(TYPE_MPS)
        links = list(self.end.subscriber.impl.connections)
        limits = '/{}/mhri'.format(self.ours)
        rospy.set_param(limits, {'limits': {'linear_mps': 0.1}})
        # One that falls counts as soon as it is seen.
        self.pushed(0.1)
        self.assertEqual(self.end.subscriber.impl.connections, links, 'the connections stay')
        when = time.monotonic()
        rospy.delete_param(limits)
        for _ in range(2):
            # One that waits for a centred stick says that first.
            self.operator.centre()
            self.wait_robot(self.ours, lambda robot: robot.stands == 'limit_raised', 'the sign')
            self.pushed(0.1)
            self.kill()
        self.assertLessEqual(max(entry[1] for entry in self.end.after(when)), 0.1)
        self.select_anew(self.ours)
        self.pushed(TYPE_MPS)
        self.wait_robot(self.ours, lambda robot: robot.stands == '', 'no reason to stand')
