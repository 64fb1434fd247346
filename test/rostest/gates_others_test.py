#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Others on the topics of a robot: who commands it beside mhri, and who else has its name."""
import os
import signal
import sys
import threading
import time

from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from gates_case import GatesCase, ZERO  # noqa: E402
from rostest_tools import Process  # noqa: E402
from support.robots import Witness  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

HERE = os.path.dirname(os.path.realpath(__file__))
GUARD = os.path.join(HERE, '..', '..', 'utils', 'remote', 'mhri_guard')
SUPPORT = os.path.join(HERE, '..', 'support')
NAV, NAV_MPS = '/own_navigation', 0.5
# How long somebody else drives against a stop [s], and how far a robot may then come [m]: without
# an answer to it, it would be 1.5 m.
AGAINST_S, MAX_M = 3.0, 0.4


class GatesOthersTest(GatesCase):
    """Robots with odometry, driven by others as well."""

    def robot(self, *options, kind=None):
        """Start a robot; return (name, its witness, receiving end of its commands, process)."""
        GatesCase.number += 1
        name = 'other{}'.format(GatesCase.number)
        if kind:
            rospy.set_param('/{}/robot_type'.format(name), kind)
        process = self.process('plain_robot.py', name, *options or ('cmd_vel', 'odom'))
        witness, receiver = Witness(name), VelocityEnd('/{}/{}'.format(
            name, options[0] if options else 'cmd_vel'))
        self.operator.check(name)
        self.state.wait_robot(name, lambda gate: gate.topic and gate.obeys == 'operator',
                              'the gate of ' + name, 20.0)
        wait_for(witness.live, what='the odometry')
        self.centre(name, receiver)
        self.addCleanup(self.operator.check)
        return name, witness, receiver, process

    def process(self, script, namespace, *words):
        """Start one of the programs of test/support; it ends with the test."""
        process = Process([sys.executable, os.path.join(SUPPORT, script)] + list(words),
                          env={'ROS_NAMESPACE': namespace})
        self.addCleanup(process.end)
        return process

    def guard(self, name, *options):
        """Start the guard of a robot; return it once it is used."""
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel'] + list(options),
                        env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        self.state.wait_robot(name, lambda gate: gate.guarded, 'the guard', 20.0)
        return guard

    def drive_against(self, name, witness, receiver, topic, rate_hz):
        """Let somebody drive the robot, stop it, and return how far it comes."""
        nav = self.process('other_driver.py', '', topic, str(rate_hz), str(NAV_MPS),
                           '__name:=' + NAV)
        wait_for(lambda: witness.live() and witness.latest().speed_mps > 0.4,
                 what='somebody else to drive')
        self.state.wait_robot(name, lambda gate: NAV in gate.also_commanded_by, 'the name')
        when = self.mux.stop(True)
        before_m = witness.path_m
        wait_for(lambda: time.monotonic() - when > AGAINST_S, what='it to end', poll_s=0.05)
        moved_m = witness.path_m - before_m
        print('MEASURED {:.3f} m in {:g} s of stop-all against {} Hz'.format(
            moved_m, AGAINST_S, rate_hz), flush=True)
        gate = self.state.robot(name)
        self.assertEqual((gate.stands, NAV in gate.also_commanded_by), ('stopped', True))
        self.assertLess(moved_m, MAX_M)
        told = receiver.after(when)
        ends = [b[0] - a[0] for a, b in zip(told, told[1:]) if a[1] and not b[1]]
        print('MEASURED zero behind a message after {:.1f} ms, at most {:.1f} ms'.format(
            1e3 * sorted(ends)[len(ends) // 2], 1e3 * max(ends)), flush=True)
        zeros = [at for at, *value in receiver.after(when) if tuple(value) == ZERO]
        self.assertGreater(len(zeros), 15 * AGAINST_S)
        self.assertLess(max(b - a for a, b in zip(zeros, zeros[1:])), 0.2)
        nav.end()
        self.state.wait_robot(name, lambda gate: not gate.also_commanded_by, 'that nobody does')
        return zeros

    def test_a_stop_holds_against_10_hz(self):
        name, witness, receiver, _ = self.robot()
        self.drive_against(name, witness, receiver, '/{}/cmd_vel'.format(name), 10)
        # Nobody else is there now: own navigation must not find the way blocked for ever.
        wait_for(lambda: receiver.received and time.monotonic() - receiver.received[-1][0] > 0.5,
                 what='silence', poll_s=0.05)

    def test_a_stop_holds_against_50_hz(self):
        name, witness, receiver, _ = self.robot()
        self.drive_against(name, witness, receiver, '/{}/cmd_vel'.format(name), 50)

    def test_a_stop_holds_behind_a_guard_that_answers(self):
        name, witness, receiver, _ = self.robot()
        self.guard(name)
        self.centre(name, receiver)
        self.drive_against(name, witness, receiver, '/{}/cmd_vel'.format(name), 50)

    def hold(self, seconds, linear=0.3):
        """Hold the stick for a while."""
        begun = time.monotonic()
        wait_for(lambda: self.mux.say(linear) and time.monotonic() - begun > seconds,
                 what='the drive', poll_s=0.05)

    def test_odometry_that_hangs_is_said(self):
        name, _, receiver, _ = self.robot('cmd_vel', 'odom', '--frozen')
        self.assertTrue(self.state.robot(name).odometry_follows)
        self.hold(4.0)
        self.state.wait_robot(name, lambda gate: not gate.odometry_follows, 'the doubt')
        self.mux.stop(True)
        self.state.wait(lambda state: state.stop_all, 'the stop')
        self.assertFalse(self.state.robot(name).odometry_follows, 'before it has followed again')

    def test_odometry_that_follows_is_a_witness(self):
        name, witness, receiver, _ = self.robot()
        self.hold(3.0)
        self.assertTrue(witness.moving())
        self.assertTrue(self.state.robot(name).odometry_follows)

    def kept_standing(self, name, receiver, code, seconds=1.0):
        """Hold the stick: the robot is told nothing but to stand, and the code says why."""
        self.state.wait_robot(name, lambda gate: gate.stands == code, code)
        when = time.monotonic()
        self.hold(seconds)
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})
        self.assertEqual(self.state.robot(name).stands, code)

    def drives_again(self, name, receiver):
        """Centre the stick, and drive the robot."""
        self.state.wait_robot(name, lambda gate: gate.stands in ('', 'joining'), 'the end of it')
        self.centre(name, receiver)
        self.assertEqual(self.drive(receiver, 0.2), (0.2, 0.0))

    def unreadable(self, kind, frame_id, word):
        """Drive a robot with a guard whose echo cannot be read: it stands until that ends."""
        name, _, receiver, _ = self.robot()
        self.assertEqual(self.drive(receiver, 0.2), (0.2, 0.0))
        echo = rospy.Publisher('/{}/mhri_guard/echo'.format(name), kind, queue_size=1)
        message, ends = kind(), threading.Event()
        message.header.frame_id = frame_id

        def speak():
            while not ends.wait(0.1):
                echo.publish(message)
        speaker = threading.Thread(target=speak)
        speaker.start()
        try:
            self.kept_standing(name, receiver, 'guard_version')
            self.state.wait(lambda state: any(name in line and word in line
                                              for line in state.refused), 'its version')
        finally:
            ends.set()
            speaker.join()
            echo.unregister()
        self.drives_again(name, receiver)

    def test_a_guard_with_one_field_more_is_not_driven_past(self):
        self.unreadable(TwistStamped, 'a:1:token:more', '4 fields')

    def test_a_guard_whose_messages_are_defined_otherwise_is_not_driven_past(self):
        class Other(TwistStamped):
            _md5sum = '0123456789abcdef0123456789abcdef'
        self.unreadable(Other, 'a:1:token', Other._md5sum)

    def test_two_computers_of_one_name_are_not_driven(self):
        name, _, receiver, _ = self.robot()
        self.drive(receiver, 0.2)
        when = time.monotonic()
        other = self.process('plain_robot.py', name, 'cmd_vel', 'odom', '__name:=base_too')
        self.state.wait_robot(name, lambda gate: gate.stands == 'two_robots', 'both to be seen')
        self.assertIn(ZERO, [entry[1:] for entry in receiver.after(when)])
        self.kept_standing(name, receiver, 'two_robots')
        self.state.wait(lambda state: any('base_too' in line for line in state.refused), 'a name')
        other.end()
        self.drives_again(name, receiver)

    def test_two_guards_of_one_name_are_not_driven(self):
        name, _, receiver, _ = self.robot()
        self.guard(name)
        self.centre(name, receiver)
        other = self.guard(name, '__name:=guard_too')
        self.kept_standing(name, receiver, 'two_robots')
        other.end()
        self.drives_again(name, receiver)

    def test_who_records_plays_and_looks_on_is_no_robot(self):
        """Nor is a second computer that reads what the robot is told, or a guard started anew."""
        name, _, receiver, _ = self.robot()
        rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        guard = self.guard(name)
        guard.send(signal.SIGKILL)
        self.state.wait_robot(name, lambda gate: not gate.guarded, 'no guard')
        self.guard(name)
        self.drives_again(name, receiver)
        self.hold(0.5)
        self.assertEqual(self.state.robot(name).stands, '')

    def test_a_generic_robot_is_not_driven_behind_its_own_multiplexer(self):
        """Until its parameter names an input of that; one that comes up late is seen, too."""
        name, _, receiver, _ = self.robot(kind='generic')
        self.assertEqual(self.drive(receiver, 0.2), (0.2, 0.0))
        self.process('own_mux.py', name, 'cmd_vel', 'joy_vel', 'nav_vel')
        self.state.wait_robot(name, lambda gate: gate.stands == 'unreachable', 'it to be seen',
                              20.0)
        self.assertEqual(self.state.robot(name).topic, '')
        self.kept_standing(name, receiver, 'unreachable')
        joy = VelocityEnd('/{}/joy_vel'.format(name))
        rospy.set_param('/{}/mhri/command'.format(name), ['joy_vel'])
        self.state.wait_robot(name, lambda gate: gate.topic == '/{}/joy_vel'.format(name),
                              'the input', 20.0)
        self.centre(name, joy)
        when = time.monotonic()
        self.assertEqual(self.drive(joy, 0.2), (0.2, 0.0))
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})

    def test_an_input_of_its_multiplexer_counts(self):
        """What wins there are zeros on the better input, as long as anybody uses the other."""
        (name, receiver), = self.robots(1, 'turtlebot2', 'cmd_vel_mux/input/teleop')
        self.process('other_driver.py', '', '/{}/cmd_vel_mux/input/navi'.format(name), '10', '0.5',
                     '__name:=' + NAV)
        self.mux.stop(True)
        self.state.wait_robot(name, lambda gate: NAV in gate.also_commanded_by, 'the name')
        when = time.monotonic()
        wait_for(lambda: len(receiver.after(when)) > 40, 4.0, '20 zeros a second')
        self.assertEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})


if __name__ == '__main__':
    rospy.init_node('gates_others_test')
    rostest.rosrun('mhri', 'gates_others', GatesOthersTest)
