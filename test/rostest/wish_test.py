#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One wish, one owner: speed, brake, seat and mode are those of the operator in control alone.

Mux and gates are the real ones, each under the process that stands by; robots are plain ones.
"""
import json
import os
import signal
import subprocess
import sys
import time
import unittest

import roslib.packages
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.msg import DriveSettings  # noqa: E402
from rostest_tools import FORWARD, NEUTRAL, Process, Stick  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402
from support.graph import SELECT, STICK  # noqa: E402
from support.random_world import RESTARTER  # noqa: E402
from support.ros_system import children, wait_for  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

SLOW_MPS = 0.12
# As a message carries it, and what rounding adds.
MOST_MPS = SLOW_MPS + 1e-6
FAST = {'linear_mps': 1.2, 'angular_rad_s': 3.0}


def start(node, *arguments):
    """Start a node as mhri.launch does."""
    path = roslib.packages.find_node('mhri', node)[0]
    return Process(['bash', '-c', RESTARTER, 'restarter', path, '--stand-by', *arguments])


def worker(process):
    """Return the process that works, under the one that stands by."""
    return next((number for standing_by in children(process.number)
                 for number in children(standing_by)), None)


class WishTest(unittest.TestCase):

    number = 0

    @classmethod
    def setUpClass(cls):
        cls.nodes = {'mux': start('mux', '__name:=mux'), 'gates': start('gates')}
        cls.stick, cls.operator, cls.state = Stick(STICK), FakeOperator(), StateEar()
        cls.stick.wait_listener()
        cls.stick.hold(NEUTRAL)

    @classmethod
    def tearDownClass(cls):
        for process in cls.nodes.values():
            for number in children(process.number):
                os.kill(number, signal.SIGTERM)
            process.send(signal.SIGTERM)
            process.wait()
            process.end()

    def setUp(self):
        """Put this node in control, slow, with two robots in the list of which one is checked."""
        self.stick.hold(NEUTRAL)
        WishTest.number += 1
        self.ours, self.other = ('{}{}'.format(name, self.number) for name in ('bot', 'other'))
        rospy.set_param('/mhri/robots', [self.ours, self.other])
        self.ends = {name: VelocityEnd('/{}/cmd_vel'.format(name))
                     for name in (self.ours, self.other)}
        self.operator.set(SLOW_MPS, 1.0)
        self.operator.check(self.ours)
        self.state.wait(lambda state: state.operator == rospy.get_name()
                        and abs(state.settings.linear_mps - SLOW_MPS) < 1e-6, 'the seat')

    def ready(self):
        """Centre the stick until the robot may be driven."""
        self.stick.hold(NEUTRAL)
        self.state.wait_robot(self.ours, lambda gate: gate.topic and gate.obeys == 'operator'
                              and not gate.stands, 'the robot', 60.0)
        rospy.rostime.wallsleep(0.1)

    def drive(self):
        """Push the stick until the robot moves, and go on for a moment."""
        self.ready()
        when = self.stick.hold(FORWARD)

        def moves():
            if any(entry[1] > 0.0 for entry in self.ends[self.ours].after(when)):
                return True
            # A restart on the way asks for neutral once more.
            if time.monotonic() - self.stick_at > 2.0:
                self.stick.hold(NEUTRAL)
                rospy.rostime.wallsleep(0.3)
                self.stick_at = self.stick.hold(FORWARD)
            return False
        self.stick_at = when
        wait_for(moves, 60.0, 'it to move', poll_s=0.05)
        count = len(self.ends[self.ours].received)
        wait_for(lambda: len(self.ends[self.ours].received) > count + 10, 60.0, 'it to go on')

    def fastest(self, name):
        """Return the highest speed that a robot was ever sent [m/s]."""
        return max((abs(entry[1]) for entry in self.ends[name].received), default=0.0)

    def kill(self, *nodes):
        """Kill what works of these nodes, and wait for who takes over."""
        before = {node: wait_for(lambda: worker(self.nodes[node]), 20.0, node) for node in nodes}
        # Who is killed right after its start has to be loaded anew, and remembers nothing.
        seen = time.monotonic()
        wait_for(lambda: time.monotonic() - seen > 2.5, 20.0)
        for number in before.values():
            os.kill(number, signal.SIGKILL)
        when = time.monotonic()
        for node, number in before.items():
            wait_for(lambda: worker(self.nodes[node]) not in (None, number), 20.0, 'the next one')
        self.state.wait(lambda state: self.state.at > when + 0.5 and state.mux_heard, 'the gates')

    def script(self, *options, robots=(), settings=(), mode='', name='lab_script'):
        """Start a program that publishes a selection."""
        wish = json.dumps({'robots': list(robots), 'settings': list(settings), 'mode': mode})
        process = Process(['rostopic', 'pub', *options, SELECT, 'mhri/RobotSelect', wish,
                           '__name:=' + name])
        self.addCleanup(process.end)
        return process

    def refused(self, what):
        """Wait until somebody's messages are refused, and named."""
        self.state.wait(lambda state: any(what in line for line in state.refused), what)

    def empty_seat(self):
        """Leave the seat."""
        self.operator.leave()
        self.addCleanup(self.come_back)
        self.state.wait(lambda state: not state.operator, 'an empty seat')

    def come_back(self):
        WishTest.operator = FakeOperator()
        self.operator.check()
        self.operator.take()

    def test_nobody_else_makes_the_driver_faster(self):
        self.script('-r', '10', robots=[self.ours], settings=[FAST], mode='pedal')
        self.refused('/lab_script: robot_select')
        self.drive()
        for nodes in (('mux',), ('gates',), ('mux', 'gates')):
            with self.subTest(killed=nodes):
                self.kill(*nodes)
                self.drive()
                self.assertAlmostEqual(self.state.message.settings.linear_mps, SLOW_MPS, 6)
        self.assertLessEqual(self.fastest(self.ours), MOST_MPS)
        self.assertGreater(self.fastest(self.ours), 0.1)

    def test_a_script_that_waits_never_becomes_the_operator(self):
        self.script('-r', '10', robots=[self.other], settings=[FAST])
        self.refused('/lab_script: robot_select')
        self.kill('gates')
        self.state.wait(lambda state: state.leased, 'the lease of who had the seat')
        self.assertEqual(self.state.message.operator, rospy.get_name())
        self.drive()
        self.empty_seat()
        self.kill('gates')
        self.refused('/lab_script: robot_select')
        self.assertEqual(self.state.message.operator, '')
        self.assertEqual(self.fastest(self.other), 0.0)

    def test_brake_and_staying_together_outlive_the_gates(self):
        self.operator.set(SLOW_MPS, 1.0, together=True, brake=True)
        self.state.wait(lambda state: state.brake and state.together, 'both')
        # From here on nobody says it again.
        self.operator.set(None)
        self.kill('gates')
        self.state.wait(lambda state: state.leased, 'the lease')
        said = self.state.message
        self.assertEqual((said.brake, said.together, said.settings.brake, said.settings.together),
                         (True, True, True, True))
        self.assertAlmostEqual(said.settings.linear_mps, SLOW_MPS, 6)

    def test_nothing_is_selected_after_a_restart_until_the_operator_repeats_it(self):
        self.drive()
        self.operator.fall_silent()
        self.kill('gates')
        self.assertEqual((self.state.message.operator, self.state.message.leased),
                         (rospy.get_name(), False))
        self.assertFalse([gate.name for gate in self.state.message.robots if gate.obeys])
        when = self.operator.check(self.ours)
        self.state.wait_robot(self.ours, lambda gate: gate.obeys == 'operator', 'the selection')
        # The stick is still pushed.
        rospy.rostime.wallsleep(0.5)
        self.assertFalse([entry for entry in self.ends[self.ours].after(when) if entry[1]])
        self.drive()

    def test_a_latched_message_of_the_past_is_no_wish(self):
        self.empty_seat()
        self.script('--latch', robots=[self.other], settings=[FAST], name='past')
        rospy.rostime.wallsleep(2.0)
        self.assertEqual(self.state.message.operator, '')
        self.assertAlmostEqual(self.state.message.settings.linear_mps, SLOW_MPS, 6)
        self.script('-r', '2', robots=[self.other], name='present')
        self.state.wait(lambda state: state.operator == '/present', 'the seat')

    def test_settings_that_cannot_be_used_leave_all_as_it_is(self):
        nan, inf = float('nan'), float('inf')
        bad = [[DriveSettings(linear, angular, False, False, False)] for linear, angular in (
            (nan, 1.0), (inf, 1.0), (0.3, nan), (0.0, 1.0), (0.3, -1.0), (99.0, 1.0))]
        good = DriveSettings(0.3, 1.0, False, False, False)
        self.state.wait(lambda state: self.state.robot(self.other), 'both robots')
        self.operator.fall_silent()
        for settings in bad + [[good, good]]:
            self.operator.select.publish(robots=[self.ours, self.other], settings=settings)
            rospy.rostime.wallsleep(0.05)
        self.refused('{}: settings, 7 times'.format(rospy.get_name()))
        self.assertAlmostEqual(self.state.message.settings.linear_mps, SLOW_MPS, 6)
        self.assertFalse(self.state.robot(self.other).obeys)
        self.operator.select.publish(robots=[self.ours], settings=[good])
        self.state.wait(lambda state: abs(state.settings.linear_mps - 0.3) < 1e-6, 'the good one')

    def test_an_operator_whose_program_is_started_again_has_its_seat_and_its_limits(self):
        self.empty_seat()
        first = self.script('-r', '4', robots=[self.ours], name='panel',
                            settings=[{'linear_mps': 0.25, 'angular_rad_s': 1.0}])
        self.state.wait(lambda state: state.operator == '/panel'
                        and state.settings.linear_mps == 0.25, 'its seat')
        other = self.script('-r', '10', robots=[self.other], settings=[FAST])
        self.refused('/lab_script: robot_select')
        first.send(signal.SIGKILL)
        self.state.wait(lambda state: not state.leased, 'its lease to end')
        self.script('-r', '4', name='panel')
        self.state.wait(lambda state: state.leased, 'its seat again')
        said = self.state.message
        self.assertEqual((said.operator, said.settings.linear_mps), ('/panel', 0.25))
        self.assertFalse([gate.name for gate in said.robots if gate.obeys])
        other.end()

    def pushed(self):
        """Return the speed at which the robot goes with the stick pushed fully [m/s]."""
        self.drive()
        return round(self.ends[self.ours].received[-1][1], 3)

    def test_a_limit_that_rises_counts_once_the_robot_is_selected_anew(self):
        self.operator.set(1.0, 1.0)
        self.assertEqual(self.pushed(), 0.5)
        limits = '/{}/mhri'.format(self.ours)
        rospy.set_param(limits, {'limits': {'linear_mps': 0.1}})
        # One that falls counts as soon as it is seen, which lets the robot wait for neutral.
        self.state.wait_robot(self.ours, lambda gate: gate.stands == 'joining', 'the lower limit')
        self.assertEqual(self.pushed(), 0.1)
        when = time.monotonic()
        rospy.delete_param(limits)
        self.state.wait_robot(self.ours, lambda gate: gate.limit_raised, 'the sign')
        self.assertEqual(self.pushed(), 0.1)
        self.kill('gates')
        self.operator.check(self.ours)
        self.assertEqual(self.pushed(), 0.1)
        self.state.wait_robot(self.ours, lambda gate: gate.limit_raised, 'the sign')
        self.assertLessEqual(max(entry[1] for entry in self.ends[self.ours].after(when)), 0.1)
        self.operator.check()
        self.state.wait_robot(self.ours, lambda gate: not gate.obeys, 'it to be let go')
        self.operator.check(self.ours)
        self.assertEqual(self.pushed(), 0.5)
        self.assertFalse(self.state.robot(self.ours).limit_raised)

    def test_who_publishes_no_selection_is_not_put_in_control(self):
        answer = subprocess.check_output(['rosservice', 'call', '/gates/take_control'], text=True)
        self.assertIn('False', answer)
        self.assertEqual(self.state.message.operator, rospy.get_name())


if __name__ == '__main__':
    rospy.init_node('wish_test')
    rostest.rosrun('mhri', 'wish', WishTest, sys.argv)
