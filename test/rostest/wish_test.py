#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One wish, one owner: speed, brake, seat and mode are those of the operator in control alone.

Mux and gates are the real ones, each under the process that stands by, on a master that can be
restarted. Robots are plain ones, or with MHRI_ROBOT=simulated those of the simulator.
"""
import json
import os
import signal
import subprocess
import sys
import time
import unittest

import rosgraph
import roslib.packages
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.graph.ros.master_watch import MasterWatch  # noqa: E402
from mhri.msg import ControlMode, DriveSettings  # noqa: E402
from rostest_tools import FORWARD, NEUTRAL, Process, Recorder, Stick, StickProcess  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402
from support.graph import MODE, MODE_SELECT, PEDAL, SELECT, STICK  # noqa: E402
from support.random_world import RESTARTER  # noqa: E402
from support.robots import Witness  # noqa: E402
from support.ros_system import children, free_port, wait_for  # noqa: E402
from support.screen_end import Screen  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

SLOW_MPS = 0.12
# As a message carries it, and what rounding adds.
MOST_MPS = SLOW_MPS + 1e-6
FAST = {'linear_mps': 1.2, 'angular_rad_s': 3.0}
SIMULATED = os.environ.get('MHRI_ROBOT') == 'simulated'
# The limit of its type.
TYPE_MPS = 0.26 if SIMULATED else 0.5
PLAIN = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', 'support',
                     'plain_robot.py')
PORT = free_port()
MASTER = {'ROS_MASTER_URI': 'http://127.0.0.1:{}'.format(PORT), 'ROS_IP': '127.0.0.1'}


def start_master():
    """Start the master of this test."""
    master = Process(['rosmaster', '--core', '-p', str(PORT)], MASTER)
    wait_for(rosgraph.Master('/wish_test').is_online, 60.0, 'the master')
    return master


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
        cls.master = start_master()
        rospy.init_node('wish_test', disable_signals=True)
        MasterWatch().start()
        cls.nodes = {'mux': start('mux', '__name:=mux'), 'gates': start('gates')}
        cls.stick, cls.operator, cls.state = Stick(STICK), FakeOperator(), StateEar()
        cls.modes = rospy.Publisher(MODE_SELECT, ControlMode, queue_size=1)
        cls.mode = Recorder(MODE, ControlMode, lambda message: message.source)
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
        cls.master.end()

    def start_robot(self, name, y):
        """Start one of the robots; return its witness."""
        if SIMULATED:
            rospy.set_param('/{}/robot_type'.format(name), 'turtlebot3')
            rospy.set_param('/{}/robot_model'.format(name), 'waffle')
            words = roslib.packages.find_node('mhri', 'sim_robot')[:1] + [
                # One that has just gone may still be in the way.
                '_x:={}'.format(1.2 + 2.0 * (self.number % 4)), '_y:={}'.format(y), '_yaw:=0.0']
        else:
            words = [sys.executable, PLAIN, 'cmd_vel', 'odom']
        process = Process(words, {'ROS_NAMESPACE': name})
        self.addCleanup(process.end)
        if SIMULATED:  # it leaves the building
            self.addCleanup(process.wait)
            self.addCleanup(process.send, signal.SIGTERM)
        return Witness(name)

    def setUp(self):
        """Put this node in control, slow, with two robots in the list of which one is checked."""
        self.stick.hold(NEUTRAL)
        WishTest.number += 1
        self.ours, self.other = ('{}{}'.format(name, self.number) for name in ('bot', 'other'))
        rospy.set_param('/mhri/robots', [self.ours, self.other])
        self.ends = {name: VelocityEnd('/{}/cmd_vel'.format(name))
                     for name in (self.ours, self.other)}
        self.seen = {name: self.start_robot(name, y)
                     for name, y in ((self.ours, 1.0), (self.other, 3.2))}
        self.operator.set(SLOW_MPS, 1.0)
        self.operator.check(self.ours)
        self.state.wait(lambda state: state.operator == rospy.get_name()
                        and abs(state.settings.linear_mps - SLOW_MPS) < 1e-6, 'the seat')

    def ready(self, stick):
        """Centre the stick until the robot may be driven."""
        stick.hold(NEUTRAL)
        self.state.wait_robot(self.ours, lambda gate: gate.topic and gate.obeys == 'operator'
                              and not gate.stands, 'the robot', 60.0)
        rospy.rostime.wallsleep(0.1)

    def drive(self, stick=None):
        """Push the stick until the robot moves, and go on for a moment."""
        stick = stick or self.stick
        self.ready(stick)
        self.stick_at = stick.hold(FORWARD)

        def moves():
            said = [entry[1] for entry in self.ends[self.ours].after(self.stick_at)]
            if len([mps for mps in said if mps > 0.0]) > 10 and said[-1] > 0.0:
                return True
            # A restart on the way, or the first word of its odometry, asks for neutral once more.
            if time.monotonic() - self.stick_at > 2.0:
                stick.hold(NEUTRAL)
                rospy.rostime.wallsleep(0.3)
                self.stick_at = stick.hold(FORWARD)
            return False
        wait_for(moves, 60.0, 'it to move', poll_s=0.05)

    def tell(self, what):
        """Say how fast our robot went by its odometry; the other one has gone nowhere."""
        mps, way_m = self.seen[self.ours].fastest(), self.seen[self.other].path_m
        print('MEASURED {}: {:.3f} m/s; the other one {:.3f} m'.format(what, mps, way_m),
              flush=True)
        self.assertTrue(0.1 < mps < 0.15 and way_m < 0.02)

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
        self.tell('a script, and nodes killed')

    def test_no_second_panel_makes_the_driver_faster_nor_a_restart(self):
        """One as operators have it, and one whose controls are moved; neither is in control."""
        panel = Process(roslib.packages.find_node('mhri', 'panel')[:1] + [
            '--robots', self.ours + ' ' + self.other, '--settings', '/nowhere/panel.json',
            '__name:=second_panel'], dict(MASTER, QT_QPA_PLATFORM='offscreen'))
        self.addCleanup(panel.end)
        screen = Screen('other_screen')
        self.addCleanup(screen.end)
        screen.wait('who drives', lambda view: view['ros'] == 'connected' and not view['ours'])
        for words in (['add', self.ours], ['select', self.ours], ['limits', '1.2', '3.0'],
                      ['brake', 'on']):
            screen.do(*words)
        wait_for(lambda: '/second_panel' in dict(rosgraph.Master('/wish_test').getSystemState()[1])[
            '/gates/state'], 60.0, 'the panel')
        self.drive()
        for way in ('mux', 'gates', 'master'):
            with self.subTest(restarted=way):
                if way == 'master':
                    self.restart_master()
                else:
                    self.kill(way)
                self.drive()
                said = self.state.message
                self.assertEqual((said.operator, said.settings.brake), (rospy.get_name(), False))
                self.assertAlmostEqual(said.settings.linear_mps, SLOW_MPS, 6)
        self.assertTrue(panel.running())
        self.assertLessEqual(self.fastest(self.ours), MOST_MPS)
        self.assertEqual(self.fastest(self.other), 0.0)
        self.tell('two panels, and restarts')

    def restart_master(self):
        """Kill the master, and wait until its successor knows gates and mux."""
        self.master.send(signal.SIGKILL)
        self.master.wait()
        WishTest.master = start_master()
        master = rosgraph.Master('/wish_test')
        wait_for(lambda: {'/gates/state', '/mux/mode', SELECT} <= {
            topic for topic, _ in master.getSystemState()[0]}, 60.0, 'all to register')

    def choose(self, source):
        """Choose a source, and wait until it is the one that drives."""
        def chosen():
            self.modes.publish(source)
            return self.mode.last() == source
        wait_for(chosen, 60.0, source, poll_s=0.1)

    def test_a_second_pedal_drives_nothing(self):
        """While the first one is silent, or lost."""
        first = Stick(PEDAL)
        first.wait_listener().hold(NEUTRAL)
        self.addCleanup(self.choose, 'joy')
        self.choose('pedal')
        self.drive(first)
        second = StickProcess(PEDAL, 'second_pedal')
        self.addCleanup(second.process.end)
        second.hold(FORWARD)
        begun = first.silence()
        wait_for(lambda: (0.0, 0.0) in [entry[1:] for entry in self.ends[self.ours].after(begun)],
                 20.0, 'the zero')
        wait_for(self.seen[self.ours].at_rest, 20.0, 'it to stand')
        when, before_m = time.monotonic(), self.seen[self.ours].path_m
        for axes in (NEUTRAL, FORWARD) * 3:
            second.hold(axes)
            rospy.rostime.wallsleep(0.5)
        self.assertFalse([entry for entry in self.ends[self.ours].after(when) if entry[1]])
        print('MEASURED a second pedal, 3 s: {:.3f} m'.format(
            self.seen[self.ours].path_m - before_m), flush=True)

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
        self.tell('a script that waits')

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
        for number, settings in enumerate(bad + [[good, good]], 1):
            # One after the other: of two that come together the gates read the newer one alone.
            self.operator.select.publish(robots=[self.ours, self.other], settings=settings)
            self.refused('{}: settings, {} times'.format(rospy.get_name(), number))
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
        self.assertEqual(self.pushed(), TYPE_MPS)
        limits = '/{}/mhri'.format(self.ours)
        rospy.set_param(limits, {'limits': {'linear_mps': 0.1}})
        # One that falls counts as soon as it is seen.
        wait_for(lambda: self.pushed() == 0.1, 60.0, 'the lower limit')
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
        self.assertEqual(self.pushed(), TYPE_MPS)
        self.assertFalse(self.state.robot(self.ours).limit_raised)

    def test_who_publishes_no_selection_is_not_put_in_control(self):
        answer = subprocess.check_output(['rosservice', 'call', '/gates/take_control'], text=True)
        self.assertIn('False', answer)
        self.assertEqual(self.state.message.operator, rospy.get_name())


if __name__ == '__main__':
    os.environ.update(MASTER)
    rostest.rosrun('mhri', 'wish', WishTest, sys.argv)
