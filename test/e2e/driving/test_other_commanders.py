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
import rosbag
import roslib.packages
import rospy

from support.drive_case import DriveCase, ZERO
from support.own_node import own_node
from support.paths import GUARD, SUPPORT
from support.robots import Witness
from support.ros_system import wait_for
from support.node_tools import measured, Process
from support.velocity import VelocityEnd

system = own_node('other_commanders')

NAV, NAV_MPS = '/own_navigation', 0.5
# How long somebody else drives against a stop [s], and what share of that way a robot may come.
AGAINST_S, MAX_SHARE = 2.0, 0.27
ALONE = 'mhri_guard/velocity'
SIM_MPS = 0.2


class OtherCommandersTest(DriveCase):
    """Robots with odometry, driven by others as well."""

    def robot(self, *options, kind=None):
        """Start a robot; return (name, its witness, receiving end of its commands, process)."""
        name = self.new_name()
        if kind:
            rospy.set_param('/{}/robot_type'.format(name), kind)
        process = self.process('plain_robot.py', name, *options or ('cmd_vel', 'odom'))
        return self.joined(name, options[0] if options else 'cmd_vel') + (process,)

    def simulated(self):
        """Start a TurtleBot3 of the simulator; return (name, its witness, its receiving end)."""
        name = self.new_name()
        for key, value in (('robot_type', 'turtlebot3'), ('robot_model', 'waffle')):
            rospy.set_param('/{}/{}'.format(name, key), value)
        process = Process(roslib.packages.find_node('mhri', 'sim_robot')[:1] + [
            '__name:=base', '_x:=6.0', '_y:={}'.format(1.0 + DriveCase.number % 3),
            '_yaw:=0.0'],
            env={'ROS_NAMESPACE': name})
        self.addCleanup(process.end)
        self.addCleanup(process.wait)
        self.addCleanup(process.send, signal.SIGINT)
        return self.joined(name, 'cmd_vel')

    def alone(self):
        """Start a robot whose base listens to its guard alone, as a TurtleBot3 of mhri's does."""
        name = self.next_name()
        guard = Process([sys.executable, GUARD, '_command:=' + ALONE, '_pass_on:=cmd_vel'],
                        env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        name, witness, receiver, _ = self.robot(ALONE, 'odom', kind='turtlebot3')
        self.assertTrue(self.state.robot(name).guarded)
        return name, witness, receiver, guard

    def joined(self, name, topic):
        """Check a robot that was started, and centre it; return (name, witness, receiving end)."""
        witness, receiver = Witness(name), VelocityEnd('/{}/{}'.format(name, topic))
        self.operator.check(name)
        wait_for(witness.live, 20.0, 'the odometry')
        self.ready(name)
        self.addCleanup(self.operator.check)
        return name, witness, receiver

    def process(self, script, namespace, *words):
        """Start one of the programs of test/support; it ends with the test."""
        process = Process([sys.executable, str(SUPPORT / script)] + list(words),
                          env={'ROS_NAMESPACE': namespace})
        self.addCleanup(process.end)
        return process

    def guard(self, name, *options):
        """Start the guard of a robot; return it once it is used."""
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel'] + list(options),
                        env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        self.wait_robot(name, lambda robot: robot.guarded, 'the guard')
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
        self.wait_robot(name, lambda robot: NAV in robot.also_commanded_by, 'the name')
        when = self.operator.stop()
        before_m = witness.path_m
        wait_for(lambda: time.monotonic() - when > AGAINST_S, what='it to end', poll_s=0.05)
        moved_m = witness.path_m - before_m
        print('MEASURED {:.3f} m in {:g} s of stop-all against {} Hz'.format(
            moved_m, AGAINST_S, rate_hz), flush=True)
        robot = self.state.robot(name)
        self.assertEqual((robot.stands, NAV in robot.also_commanded_by), ('stopped', True))
        self.assertLess(moved_m, MAX_SHARE * mps * AGAINST_S)
        told = receiver.after(when)
        ends = [b[0] - a[0] for a, b in zip(told, told[1:]) if a[1] and not b[1]]
        print('MEASURED {} of {} messages moved it; zero behind one after {:.1f} ms at most'.format(
            len([one for one in told if one[1]]), len(told), 1e3 * max(ends, default=0.0)),
            flush=True)
        zeros = [entry for entry in told if entry[1:] == ZERO]
        self.assertGreater(len(zeros), 15 * AGAINST_S)
        nav.send(signal.SIGINT)
        nav.wait()
        self.wait_robot(name, lambda robot: not robot.also_commanded_by, 'that nobody does')
        return moved_m

    def test_a_stop_holds_against_50_hz(self):
        name, witness, receiver, _ = self.robot()
        self.drive_against(name, witness, receiver, '/{}/cmd_vel'.format(name), 50)
        # Nobody else is there now: own navigation must not find the way blocked for ever.
        wait_for(receiver.is_silent, what='silence', poll_s=0.05)

    def test_a_stop_holds_in_the_simulator(self):
        """Against a bag; the simulated robot brakes at its own rate."""
        name, witness, receiver = self.simulated()
        self.drive_against(name, witness, receiver, '/{}/cmd_vel'.format(name), 20, SIM_MPS,
                           self.played)

    def test_a_guard_to_which_alone_the_base_listens_leaves_nobody_to_drive_it(self):
        """Killed while own navigation drives: its watchdog stops it, and nobody starts it again."""
        name, witness, receiver, guard = self.alone()
        self.other('/{}/cmd_vel'.format(name), 20, NAV_MPS)
        wait_for(lambda: receiver.last()[0] == NAV_MPS and witness.moving(),
                 what='own navigation')
        when = guard.send(signal.SIGKILL)
        wait_for(witness.at_rest, 20.0, 'it to stand')
        measured('guard killed: stands', witness.stood_still_at(when) - when, 1.0)
        self.wait_robot(name, lambda robot: not robot.topic, 'that nothing drives it')
        guard = Process([sys.executable, GUARD, '_command:=' + ALONE, '_pass_on:=cmd_vel'],
                        env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        when = time.monotonic()
        wait_for(lambda: [one for one in receiver.after(when) if one[1] == NAV_MPS], 20.0,
                 'own navigation behind the next one')

    def hold(self, seconds, linear=0.25):
        """Hold the stick for a while."""
        begun = self.operator.push(linear)
        wait_for(lambda: time.monotonic() - begun > seconds,
                 what='the drive', poll_s=0.05)

    def kept_standing(self, name, receiver, code, seconds=1.0):
        """Hold the stick: the robot is told nothing but to stand, and the code says why."""
        self.wait_robot(name, lambda robot: robot.stands == code, code)
        when = time.monotonic()
        self.hold(seconds)
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})
        self.assertEqual(self.state.robot(name).stands, code)

    def drives_again(self, name, receiver):
        """Centre the stick, and drive the robot."""
        self.wait_robot(name, lambda robot: robot.stands in ('', 'joining'), 'the end of it')
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.25), (0.25, 0.0))

    def unreadable(self, name, receiver, kind, frame_id, word):
        """Drive a robot with a guard whose echo cannot be read: it stands until that ends."""
        self.assertEqual(self.drive(receiver, 0.25), (0.25, 0.0))
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

    def test_a_guard_of_another_version_is_not_driven_past(self):
        """It has one field more, or its messages are defined otherwise."""
        class Other(TwistStamped):
            _md5sum = '0123456789abcdef0123456789abcdef'
        name, _, receiver, _ = self.robot()
        self.unreadable(name, receiver, TwistStamped, 'a:1:token:more', '4 fields')
        self.unreadable(name, receiver, Other, 'a:1:token', Other._md5sum)

    def test_two_computers_of_one_name_are_not_driven(self):
        for odometry, *sign in (['odom'], ['another', '--sign', 'imu', 'sensor_msgs/Imu']):
            self.two_of_one_name(odometry, sign)

    def two_of_one_name(self, odometry, sign):
        """Drive a robot, and start another one of its name, perhaps with another odometry."""
        name, _, receiver, _ = self.robot('cmd_vel', 'odom', *sign)
        self.drive(receiver, 0.25)
        when = time.monotonic()
        other = self.process('plain_robot.py', name, 'cmd_vel', odometry, *sign, '__name:=base_too')
        self.wait_robot(name, lambda robot: robot.stands == 'two_robots', 'both to be seen')
        wait_for(lambda: ZERO in [entry[1:] for entry in receiver.after(when)], what='the zero')
        self.kept_standing(name, receiver, 'two_robots')
        self.state.wait(lambda state: any('base_too' in line for line in state.refused), 'a name')
        other.end()
        self.drives_again(name, receiver)

    def test_a_generic_robot_is_not_driven_behind_its_own_multiplexer(self):
        """Until its parameter names an input of that; one that comes up late is seen, too."""
        name, _, receiver, _ = self.robot(kind='generic')
        self.assertEqual(self.drive(receiver, 0.25), (0.25, 0.0))
        self.process('own_mux.py', name, 'cmd_vel', 'joy_vel', 'nav_vel')
        self.wait_robot(name, lambda robot: robot.stands == 'unreachable', 'it to be seen')
        self.assertEqual(self.state.robot(name).topic, '')
        self.kept_standing(name, receiver, 'unreachable')
        joy = VelocityEnd('/{}/joy_vel'.format(name))
        rospy.set_param('/{}/mhri/command'.format(name), ['joy_vel'])
        self.wait_robot(name, lambda robot: robot.topic == '/{}/joy_vel'.format(name), 'the input')
        self.ready(name)
        when = time.monotonic()
        self.assertEqual(self.drive(joy, 0.25), (0.25, 0.0))
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})

    def test_what_commands_the_base_of_another_robot_is_no_robot(self):
        """The namespace of a pad, whose multiplexer has no namespace, as in husky_control."""
        name, _, receiver, _ = self.robot()
        self.assertEqual(self.drive(receiver, 0.25), (0.25, 0.0))
        pad, way = self.new_name(), '/{}/joy_vel'.format(name)
        self.process('own_mux.py', '', *('/{}/cmd_vel'.format(one) for one in (name, pad)), way)
        self.wait_robot(name, lambda robot: robot.topic == way, 'the input')
        self.ready(name)
        when = time.monotonic()
        self.hold(1.0)
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO}, 'past it')
        self.select_anew(pad)
        self.wait_robot(pad, lambda robot: robot.selected and robot.stands == 'unreachable', 'it')
        self.assertEqual(self.state.robot(pad).topic, '')

    def test_a_guard_of_another_version_that_hangs_is_not_driven_past(self):
        name, _, receiver, _ = self.robot()
        self.assertEqual(self.drive(receiver, 0.25), (0.25, 0.0))
        echo = rospy.Publisher('/{}/mhri_guard/echo'.format(name), TwistStamped, queue_size=1)
        message = TwistStamped()
        message.header.frame_id = 'a:1:token:more'
        wait_for(echo.get_num_connections, what='the mux')
        echo.publish(message)
        self.kept_standing(name, receiver, 'guard_version', seconds=2.5)
        echo.unregister()
        self.drives_again(name, receiver)

    def test_an_input_of_its_multiplexer_counts(self):
        """What wins there are zeros on the better input, as long as anybody uses the other."""
        (name, receiver), = self.robots(1, 'turtlebot2', 'cmd_vel_mux/input/teleop')
        other = rospy.Publisher('/{}/cmd_vel_mux/input/navi'.format(name), Twist, queue_size=1)
        self.addCleanup(other.unregister)
        message = Twist()
        message.linear.x = NAV_MPS
        beats = rospy.Timer(rospy.Duration(0.1), lambda _: other.publish(message))
        self.addCleanup(beats.join)
        self.addCleanup(beats.shutdown)
        self.operator.stop()
        self.wait_robot(name, lambda robot: rospy.get_name() in robot.also_commanded_by, 'the name')
        when = time.monotonic()
        # A stop alone says a dozen.
        wait_for(lambda: len(receiver.after(when)) > 40, what='zeros without an end')
        self.assertEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})
