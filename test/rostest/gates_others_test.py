#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Others on the topics of a robot: who commands it beside mhri, and who else has its name."""
import os
import signal
import sys
import tempfile
import threading
import time

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import rosbag
import roslib.packages
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from gates_case import GatesCase, ZERO  # noqa: E402
from rostest_tools import measured, Process  # noqa: E402
from support.robots import Witness  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

HERE = os.path.dirname(os.path.realpath(__file__))
GUARD = os.path.join(HERE, '..', '..', 'utils', 'remote', 'mhri_guard')
SUPPORT = os.path.join(HERE, '..', 'support')
NAV, NAV_MPS = '/own_navigation', 0.5
# How long somebody else drives against a stop [s], and what share of that way a robot may come.
AGAINST_S, MAX_SHARE = 3.0, 0.27
# Nothing comes through a guard to which alone the base listens; the way until it stands [m].
ALONE_M = 0.05
ALONE = 'mhri_guard/velocity'
SIM_MPS = 0.2


class GatesOthersTest(GatesCase):
    """Robots with odometry, driven by others as well."""

    def robot(self, *options, kind=None):
        """Start a robot; return (name, its witness, receiving end of its commands, process)."""
        GatesCase.number += 1
        name = 'other{}'.format(GatesCase.number)
        if kind:
            rospy.set_param('/{}/robot_type'.format(name), kind)
        process = self.process('plain_robot.py', name, *options or ('cmd_vel', 'odom'))
        return self.joined(name, options[0] if options else 'cmd_vel') + (process,)

    def simulated(self, *options, topic='cmd_vel'):
        """Start a TurtleBot3 of the simulator; return (name, its witness, its receiving end).

        :param options: of its node, such as another name for the topic that it obeys
        """
        GatesCase.number += 1
        name = 'other{}'.format(GatesCase.number)
        for key, value in (('robot_type', 'turtlebot3'), ('robot_model', 'waffle')):
            rospy.set_param('/{}/{}'.format(name, key), value)
        process = Process(roslib.packages.find_node('mhri', 'sim_robot')[:1] + [
            '__name:=base', '_x:=6.0', '_y:={}'.format(1.0 + GatesCase.number % 3),
            '_yaw:=0.0', *options],
            env={'ROS_NAMESPACE': name})
        self.addCleanup(process.end)
        self.addCleanup(process.wait)
        self.addCleanup(process.send, signal.SIGINT)
        return self.joined(name, topic)

    def alone(self, simulated=False):
        """Start a robot whose base listens to its guard alone, as a TurtleBot3 of mhri's does."""
        name = 'other{}'.format(GatesCase.number + 1)
        guard = Process([sys.executable, GUARD, '_command:=' + ALONE, '_pass_on:=cmd_vel'],
                        env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        name, witness, receiver = self.simulated('cmd_vel:=' + ALONE, topic=ALONE) if simulated \
            else self.robot(ALONE, 'odom', kind='turtlebot3')[:3]
        self.assertTrue(self.state.robot(name).guarded)
        return name, witness, receiver, guard

    def joined(self, name, topic):
        """Check a robot that was started, and centre it; return (name, witness, receiving end)."""
        witness, receiver = Witness(name), VelocityEnd('/{}/{}'.format(name, topic))
        self.operator.check(name)
        self.state.wait_robot(name, lambda gate: gate.topic and gate.obeys == 'operator',
                              'the gate of ' + name, 20.0)
        wait_for(witness.live, 20.0, 'the odometry')
        self.centre(name, receiver)
        self.addCleanup(self.operator.check)
        return name, witness, receiver

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

    def other(self, topic, rate_hz, mps):
        """Let a program of somebody's own drive a robot; return it, it ends with the test."""
        return self.process('other_driver.py', '', topic, str(rate_hz), str(mps), '__name:=' + NAV)

    def played(self, topic, rate_hz, mps):
        """Let ``rosbag play`` drive a robot with a bag of half a minute."""
        bag = os.path.join(tempfile.mkdtemp(), 'drive.bag')
        message, begin_s = Twist(), time.time()
        message.linear.x = mps
        with rosbag.Bag(bag, 'w') as out:
            for number in range(30 * rate_hz):
                out.write(topic, message, rospy.Time.from_sec(begin_s + number / rate_hz))
        process = Process(['rosbag', 'play', '-q', bag, '__name:=' + NAV[1:]])
        self.addCleanup(os.remove, bag)
        self.addCleanup(process.end)
        self.addCleanup(process.wait)
        self.addCleanup(process.send, signal.SIGINT)
        return process

    def drive_against(self, name, witness, receiver, topic, rate_hz, mps=NAV_MPS, way=None):
        """Let somebody drive the robot, and stop it; return how far it comes [m]."""
        nav = (way or self.other)(topic, rate_hz, mps)
        wait_for(lambda: witness.live() and witness.latest().speed_mps > 0.8 * mps,
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
        self.assertLess(moved_m, MAX_SHARE * mps * AGAINST_S)
        told = receiver.after(when)
        ends = [b[0] - a[0] for a, b in zip(told, told[1:]) if a[1] and not b[1]]
        print('MEASURED {} of {} messages moved it; zero behind one after {:.1f} ms at most'.format(
            len([one for one in told if one[1]]), len(told), 1e3 * max(ends, default=0.0)),
            flush=True)
        zeros = [at for at, *value in receiver.after(when) if tuple(value) == ZERO]
        self.assertGreater(len(zeros), 15 * AGAINST_S)
        self.assertLess(max(b - a for a, b in zip(zeros, zeros[1:])), 0.2)
        nav.send(signal.SIGINT)
        nav.wait()
        self.state.wait_robot(name, lambda gate: not gate.also_commanded_by, 'that nobody does')
        return moved_m

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

    def test_a_stop_holds_against_a_bag_that_is_played(self):
        name, witness, receiver, _ = self.robot()
        self.drive_against(name, witness, receiver, '/{}/cmd_vel'.format(name), 20, way=self.played)

    def test_a_stop_holds_in_the_simulator(self):
        """Against a program, and against a bag; the simulated robot brakes at its own rate."""
        name, witness, receiver = self.simulated()
        for way in (self.other, self.played):
            with self.subTest(way=way.__name__):
                self.drive_against(name, witness, receiver, '/{}/cmd_vel'.format(name), 20, SIM_MPS,
                                   way)
                self.mux.stop(False)
                self.centre(name, receiver)

    def nothing_passes(self, simulated, way, mps):
        """Drive a robot whose base listens to its guard alone: as usual, and under a stop not."""
        name, witness, receiver, _ = self.alone(simulated)
        topic = '/{}/cmd_vel'.format(name)
        self.assertLess(self.drive_against(name, witness, receiver, topic, 20, mps, way), ALONE_M)
        # Nor while mhri drives.
        self.mux.stop(False)
        self.centre(name, receiver)
        nav = way(topic, 20, mps)
        wait_for(lambda: receiver.values()[-1][0] == mps, what='somebody else to drive')
        self.drive(receiver, 0.1)
        wait_for(lambda: self.mux.say(0.1) and receiver.values()[-1][0] == 0.1, 20.0, 'mhri',
                 poll_s=0.05)
        when = time.monotonic()
        self.hold(1.0, 0.1)
        self.assertEqual({entry[1] for entry in receiver.after(when)}, {0.1})
        nav.send(signal.SIGINT)
        nav.wait()

    def test_a_base_that_listens_to_its_guard_alone_gets_nothing_under_a_stop(self):
        self.nothing_passes(False, self.other, NAV_MPS)

    def test_a_base_that_listens_to_its_guard_alone_gets_no_bag_under_a_stop(self):
        self.nothing_passes(False, self.played, NAV_MPS)

    def test_a_simulated_base_that_listens_to_its_guard_alone_gets_nothing_under_a_stop(self):
        self.nothing_passes(True, self.other, SIM_MPS)

    def test_a_guard_to_which_alone_the_base_listens_leaves_nobody_to_drive_it(self):
        """Killed while own navigation drives: its watchdog stops it, and nobody starts it again."""
        name, witness, receiver, guard = self.alone()
        self.other('/{}/cmd_vel'.format(name), 20, NAV_MPS)
        wait_for(lambda: receiver.values()[-1][0] == NAV_MPS and witness.moving(),
                 what='own navigation')
        when = guard.send(signal.SIGKILL)
        wait_for(witness.at_rest, 20.0, 'it to stand')
        self.assertLess(measured('guard killed: stands', witness.stood_still_at(when) - when), 1.0)
        self.state.wait_robot(name, lambda gate: not gate.topic, 'that nothing drives it', 20.0)
        guard = Process([sys.executable, GUARD, '_command:=' + ALONE, '_pass_on:=cmd_vel'],
                        env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        when = time.monotonic()
        wait_for(lambda: [one for one in receiver.after(when) if one[1] == NAV_MPS], 20.0,
                 'own navigation behind the next one')

    def test_its_own_smoother_is_nobody_else(self):
        """That of a TurtleBot2 publishes the topic behind the one that it reads."""
        (name, receiver), = self.robots(1, 'turtlebot2', 'teleop/input')
        self.process('own_mux.py', name, 'cmd_vel_mux/input/teleop', 'teleop/input', '--passes')
        end = VelocityEnd('/{}/cmd_vel_mux/input/teleop'.format(name))
        wait_for(lambda: self.mux.say(0.0) and ZERO in end.values(), 20.0, 'the smoother',
                 poll_s=0.05)
        self.centre(name, receiver)

        def driven(times=40):
            """Drive until it has passed on so many commands; nobody else is named meanwhile."""
            gate = self.state.robot(name)
            self.assertEqual(gate.also_commanded_by, [])
            # The smoother that has come asks for a centred stick once.
            self.mux.say(0.0 if gate.stands else 0.3)
            return end.values().count((0.3, 0.0)) >= times
        wait_for(driven, 20.0, 'the drive', poll_s=0.05)
        self.mux.stop(True)
        wait_for(lambda: time.monotonic() - receiver.received[-1][0] > 0.5, 20.0, 'silence')

    def hold(self, seconds, linear=0.3):
        """Hold the stick for a while."""
        begun = time.monotonic()
        wait_for(lambda: self.mux.say(linear) and time.monotonic() - begun > seconds,
                 what='the drive', poll_s=0.05)

    def test_odometry_that_hangs_is_said(self):
        name, _, receiver, _ = self.robot('cmd_vel', 'odom', '--frozen')
        self.not_believed(name)

    def test_odometry_that_hangs_is_said_in_the_simulator(self):
        name = 'other{}'.format(GatesCase.number + 1)
        frozen = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        first = []

        def repeat(message):
            """Pass on where it was at first, with the stamp of now."""
            first.append(message)
            first[0].header.stamp = message.header.stamp
            frozen.publish(first[0])
        true = rospy.Subscriber('/{}/true_odom'.format(name), Odometry, repeat, queue_size=1)
        self.addCleanup(frozen.unregister)
        self.addCleanup(true.unregister)
        self.assertEqual(self.simulated('odom:=true_odom')[0], name)
        self.not_believed(name)
        self.assertGreater(first[-1].pose.pose.position.x - first[0].pose.pose.position.x, 0.3)

    def not_believed(self, name):
        """Drive a robot whose odometry hangs: it is no witness, while it is driven and after."""
        self.assertTrue(self.state.robot(name).odometry_follows)
        when = time.monotonic()
        wait_for(lambda: self.mux.say(0.3) and not self.state.robot(name).odometry_follows, 5.0,
                 'the doubt', poll_s=0.05)
        measured('the doubt', time.monotonic() - when)
        self.hold(1.0)
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
