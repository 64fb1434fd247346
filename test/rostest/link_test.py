#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A slow network between host and robot: what the link says of it, and what the guard does."""
import os
import subprocess
import sys
import time
import unittest

from geometry_msgs.msg import Twist, TwistStamped
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.core.driving.limits import Velocity  # noqa: E402
from mhri.core.robots.robot_types import Limits  # noqa: E402
from mhri.ros.robots.bot_feeds import BotFeeds  # noqa: E402
from mhri.ros.robots.fleet import Fleet  # noqa: E402
from mhri.ros.driving.gate import Gate  # noqa: E402
from mhri.ros.driving.gates import GateBank  # noqa: E402
from mhri.ros.resources import robot_types  # noqa: E402
from mhri.ros.robots.robot_link import RobotLink  # noqa: E402
from mhri.ros.worker import Worker  # noqa: E402
from support.relay import Delay, move_away, put_in_front, SlowNode  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

GUARD = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'utils', 'remote',
                     'mhri_guard')
START_S = 60.0
ZERO = (0.0, 0.0)


class LinkTest(unittest.TestCase):
    """Figures and guard through a relay."""

    delay = Delay()
    far = False

    def setUp(self):
        self.delay.one_way_s = 0.0
        self.delay.go_on()

    @classmethod
    def move_away(cls):
        """Put bot1 behind the network, for all tests that follow."""
        if cls.far:
            return
        cls.far = True
        move_away(cls.delay, '/bot1/odom', 'nav_msgs/Odometry', rospy.get_name())

    def far_robot(self):
        """Return the link of bot1, through the network."""
        self.move_away()
        kind = robot_types()[0]['turtlebot3']
        link = RobotLink('bot1', kind, Gate.of_type('bot1', kind),
                         BotFeeds('bot1', kind, Worker('feeds').start()))
        self.addCleanup(link.close)
        wait_for(lambda: link.view().link == 'live', START_S, 'the odometry')
        return link

    def test_figures_of_a_slow_link(self):
        link = self.far_robot()
        for one_way_s in (0.0, 0.025, 0.1, 0.25):
            self.delay.one_way_s = one_way_s
            expected_s = 2.0 * one_way_s

            def near():
                found = link.view().figures.round_trip_s
                return found is not None and abs(found - expected_s) <= (0.1 * expected_s or 0.015)
            wait_for(near, 30.0, 'a round trip of {:g} s'.format(expected_s), 0.1)
            wait_for(lambda: abs(link.view().figures.offset_s) < 0.05, 30.0,
                     'a clock that is right', 0.1)
            view = link.view()
            figures = view.figures
            print('MEASURED link, {:.0f} ms there and back: says {:.0f} ms, clock {:+.0f} ms, '
                  '{:.1f} % lost: {!r}'.format(
                      1e3 * expected_s, 1e3 * figures.round_trip_s, 1e3 * figures.offset_s,
                      100.0 * figures.loss, view.note))
            self.assertEqual(view.slow, one_way_s >= 0.1 or bool(view.note))
            self.assertLess(figures.loss, 0.05)
        self.assertIn('slow link', link.view().note)

    def test_a_robot_out_of_reach_gets_a_zero_and_no_backlog(self):
        self.move_away()
        bank = GateBank()
        bank.start(hear_selection=False)
        self.addCleanup(bank.close)
        fleet = Fleet(robot_types()[0], bank, Worker('feeds').start(), lambda *_: None)
        self.addCleanup(fleet.close)
        end = VelocityEnd('/bot1/cmd_vel')
        fleet.want('bot1')
        fleet.connect('bot1')
        bank.select(['bot1'])
        twist = rospy.Publisher('/robot_controller/twist', Twist, queue_size=1)

        def command(speed):
            message = Twist()
            message.linear.x = speed
            twist.publish(message)
            fleet.hold_silent()
            time.sleep(0.05)

        def drive_until(speed, condition, what):
            begun = time.monotonic()
            while not condition():
                command(speed)
                self.assertLess(time.monotonic() - begun, START_S, what)
        drive_until(0.1, lambda: (0.1, 0.0) in end.values()
                    and fleet.view('bot1', True).link == 'live', 'it to be driven')
        self.delay.stall()
        stalled = time.monotonic()
        drive_until(0.1, lambda: end.values()[-1] == ZERO, 'the zero')
        print('MEASURED not heard any more: one zero after {:.2f} s, by its gate'.format(
            end.received[-1][0] - stalled))
        self.assertLess(end.received[-1][0] - stalled, 3.0, 'promised: 1 s')
        sent = len(end.received)
        for _ in range(20):
            command(0.1)
        self.delay.go_on()
        drive_until(0.1, lambda: fleet.view('bot1', True).link == 'live'
                    and 'centre the stick' in fleet.view('bot1', True).note, 'it to be heard')
        for _ in range(10):
            command(0.1)
        self.assertEqual(len(end.received), sent, 'it was driven on without a centred stick')
        command(0.0)
        drive_until(0.1, lambda: end.values()[-1] == (0.1, 0.0), 'it to be driven again')

    def test_a_robot_whose_connection_was_dropped_is_held_until_it_is_heard(self):
        """By the panel's own gate, too: where the link is cut again before there is a keeper."""
        self.move_away()
        bank = GateBank()
        self.addCleanup(bank.close)
        fleet = Fleet(robot_types()[0], bank, Worker('feeds').start(), lambda *_: None)
        self.addCleanup(fleet.close)
        fleet.want('bot1')
        fleet.connect('bot1')
        wait_for(lambda: fleet.view('bot1', True).link == 'live', START_S, 'the odometry')
        gate, = bank.gates()
        self.delay.stall()
        wait_for(lambda: fleet.view('bot1', True).age_s > 0.2, 10.0, 'silence')
        gate.drop_cut = lambda: True
        fleet.hold_silent()
        self.assertTrue(gate.rule.held)
        gate.drop_cut = lambda: False
        # What came before counts for nothing, however new it is.
        fleet.hold_silent()
        self.assertTrue(gate.rule.held)
        self.delay.go_on()
        wait_for(lambda: fleet.hold_silent() or not gate.rule.held, START_S, 'its release', 0.05)

    def guarded(self, name, *options):
        """Start a guard on a robot; return its process."""
        process = subprocess.Popen([sys.executable, GUARD, '_command:=cmd_vel', *options],
                                   env=dict(os.environ, ROS_NAMESPACE=name))
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        return process

    def test_no_backlog_moves_a_guarded_robot(self):
        slow = SlowNode(rospy.get_node_uri(), self.delay)
        self.addCleanup(slow.close)
        gates = {name: Gate(name, ['/{}/cmd_vel'.format(name)], Limits(0.5, 1.0))
                 for name in ('far1', 'far2')}
        for topic, kind in (('/far1/mhri_guard/command', 'geometry_msgs/TwistStamped'),
                            ('/far2/cmd_vel', 'geometry_msgs/Twist')):
            put_in_front(slow, rospy.get_name(), rospy.get_node_uri(), topic, kind)
        # The stall outlasts its memory: what comes behind is late all the same.
        self.guarded('far1', '_memory_s:=1.0')
        ends = {name: VelocityEnd('/{}/cmd_vel'.format(name)) for name in gates}
        wait_for(gates['far1'].guarded, START_S, 'the guard')
        wait_for(gates['far2'].reachable, START_S, 'the robot without a guard')
        self.delay.one_way_s = 0.02

        def drive(speed):
            for gate in gates.values():
                gate.send(Velocity(speed, 0.0), time.monotonic())
            time.sleep(0.05)
        begun = time.monotonic()
        while not all((0.3, 0.0) in end.values() for end in ends.values()):
            drive(0.3)
            self.assertLess(time.monotonic() - begun, START_S, 'both to be driven')
        for _ in range(20):
            drive(0.3)
        self.delay.stall()
        stalled = time.monotonic()
        for _ in range(40):
            drive(0.3)
        wait_for(lambda: ends['far1'].values()[-1] == ZERO, 5.0, 'the zero of the lease')
        zero_after = ends['far1'].received[-1][0] - stalled
        drive(0.0)
        back = time.monotonic()
        self.delay.go_on()
        wait_for(lambda: ends['far2'].values()[-1] == ZERO, 10.0, 'the end of the backlog')
        moved = {name: [entry for entry in end.after(back) if entry[1:] != ZERO]
                 for name, end in ends.items()}
        print('MEASURED link stalled for 2 s: the guard says zero after {:.0f} ms; when it is '
              'back, commands that still move it: {} with a guard, {} without'.format(
                  1e3 * zero_after, len(moved['far1']), len(moved['far2'])))
        self.assertLess(zero_after, 1.0, 'promised: 300 ms')
        self.assertGreater(len(moved['far2']), 0, 'the network held nothing back')
        while (0.2, 0.0) not in ends['far1'].values():
            drive(0.2)
            self.assertLess(time.monotonic() - back, START_S, 'it to be driven again')
        late = [entry for entry in ends['far1'].after(back) if entry[1:] not in (ZERO, (0.2, 0.0))]
        self.assertEqual(late, [], 'a command from before the stall')

    def test_what_a_guard_drops_is_said(self):
        link = self.far_robot()
        self.assertEqual(link.view().note, '')
        self.guarded('bot1')
        wait_for(link.gate.guarded, START_S, 'the guard')
        publisher = rospy.Publisher('/bot1/mhri_guard/command', TwistStamped, queue_size=1)
        wait_for(publisher.get_num_connections, START_S, 'the guard')

        def said(age_s):
            link.listen_to_guard()
            message = TwistStamped()
            message.header.stamp = rospy.Time.from_sec(time.time() - age_s)
            message.twist.linear.x = 0.1
            publisher.publish(message)
            return 'its guard drops late commands' in link.view().note
        end = VelocityEnd('/bot1/cmd_vel')
        wait_for(lambda: said(0.0) or (0.1, 0.0) in end.values(), START_S, 'commands', 0.05)
        self.assertFalse(said(0.0))
        wait_for(lambda: said(1.0), START_S, 'word of what was dropped', 0.05)
        self.assertTrue(link.view().slow)
        wait_for(lambda: not said(0.0), 10.0, 'the word to go', 0.05)

    def test_a_guard_that_ends_stops_its_robot(self):
        gate = Gate('far3', ['/far3/cmd_vel'], Limits(0.5, 1.0))
        process, end = self.guarded('far3'), VelocityEnd('/far3/cmd_vel')
        wait_for(gate.guarded, START_S, 'the guard')
        begun = time.monotonic()
        while (0.3, 0.0) not in end.values():
            gate.send(Velocity(0.3, 0.0), time.monotonic())
            time.sleep(0.05)
            self.assertLess(time.monotonic() - begun, START_S, 'it to be driven')
        when = time.monotonic()
        process.terminate()
        wait_for(lambda: end.values()[-1] == ZERO, 10.0, 'the zero')
        print('MEASURED guard ended: first zero after {:.0f} ms'.format(
            1e3 * ([entry for entry in end.after(when) if entry[1:] == ZERO][0][0] - when)))

    def test_a_guard_that_is_killed_leaves_no_gap_in_the_commands(self):
        """Its robot is driven as one without a guard then: the gate has the plain topic, too."""
        gate = Gate('far4', ['/far4/cmd_vel'], Limits(0.5, 1.0))
        process, end = self.guarded('far4'), VelocityEnd('/far4/cmd_vel')
        wait_for(gate.guarded, START_S, 'the guard')
        wait_for(lambda: all(publisher.get_num_connections() for publisher in gate._publishers),
                 START_S, 'the plain topic')
        begun = time.monotonic()
        while end.values()[-1:] != [(0.3, 0.0)]:
            gate.send(Velocity(0.3, 0.0), time.monotonic())
            time.sleep(0.05)
            self.assertLess(time.monotonic() - begun, START_S, 'it to be driven')
        when = time.monotonic()
        process.kill()
        while gate.guarded() or end.values()[-1] != (0.2, 0.0):
            gate.send(Velocity(0.2, 0.0), time.monotonic())
            time.sleep(0.05)
            self.assertLess(time.monotonic() - when, START_S, 'it to be driven without the guard')
        found = [entry[0] for entry in end.after(when) if entry[1:] == (0.2, 0.0)]
        print('MEASURED guard killed: the next command reaches the robot after {:.0f} ms'.format(
            1e3 * (found[0] - when)))
        self.assertLess(found[0] - when, 0.5, 'longer than the watchdog of a robot waits')
        gate.send(Velocity(0.0, 0.0), time.monotonic())
        wait_for(lambda: end.values()[-1] == ZERO, 5.0, 'the zero')

    def test_a_parameter_that_cannot_be_is_refused(self):
        done = subprocess.run([sys.executable, GUARD, '_lease_s:=-1', '__name:=wrong'],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=START_S,
                              universal_newlines=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn('~lease_s is -1: give a number of seconds above 0', done.stdout)


if __name__ == '__main__':
    rospy.init_node('link_test')
    rostest.rosrun('mhri', 'link', LinkTest)
