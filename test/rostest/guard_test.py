#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The guard as a node: what reaches the robot through it, in time and late."""
import os
import signal
import subprocess
import sys
import termios
import time
import unittest

from geometry_msgs.msg import TwistStamped
import rospy
import rostest
from std_msgs.msg import String

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, '..'))

from mhri.driving.guard_link import GuardLink  # noqa: E402
from rostest_tools import measured  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

GUARD = os.path.join(HERE, '..', '..', 'utils', 'remote', 'mhri_guard')
OTHER = os.path.join(HERE, '..', 'support', 'other_driver.py')
START_S = 60.0
ZERO, GO = (0.0, 0.0), (0.3, 0.1)


class Driver:
    """A guard, what drives through it, and the end that the robot has."""

    def __init__(self, name, *options, output=None, topic='cmd_vel'):
        self.process = subprocess.Popen([sys.executable, GUARD, *options], stderr=output,
                                        stdout=output, env=dict(os.environ, ROS_NAMESPACE=name))
        self.end = VelocityEnd('/{}/{}'.format(name, topic))
        self.echoes, self.dropped = [], []
        self._topic = '/{}/mhri_guard/'.format(name)
        self.link = GuardLink(name)
        rospy.Subscriber(self._topic + 'echo', TwistStamped, self._on_echo, tcp_nodelay=True)
        dropped = rospy.Subscriber(self._topic + 'dropped', TwistStamped, self.dropped.append)
        self.connect(name)
        wait_for(lambda: self.end.connected() and dropped.get_num_connections(), START_S,
                 'the robot, and the guard to be heard')

    def connect(self, session):
        """Begin a session with connections of its own."""
        self.link = GuardLink(session)
        self._publisher = rospy.Publisher(self._topic + 'command', TwistStamped, queue_size=1000,
                                          tcp_nodelay=True)
        count = len(self.echoes)
        wait_for(lambda: self._publisher.get_num_connections() and len(self.echoes) > count,
                 START_S, 'the guard to listen')

    def leave(self):
        """Give up the connection."""
        self._publisher.unregister()

    def _on_echo(self, message):
        self.echoes.append((time.monotonic(), message))
        self.link.on_echo(message.header.frame_id, time.monotonic())

    def say(self, velocity, stop=False):
        """Send a command; return its frame_id."""
        message = TwistStamped()
        message.header.frame_id = self.link.next_id(stop)
        message.twist.linear.x, message.twist.angular.z = velocity
        self._publisher.publish(message)
        return message.header.frame_id

    def drive(self):
        """Say the same until the robot has it."""
        begun = time.monotonic()
        while not [entry for entry in self.end.after(begun) if entry[1:] == GO]:
            self.say(GO)
            time.sleep(0.02)
            assert time.monotonic() < begun + START_S, 'it is not driven'
        return time.monotonic()

    def zero_after(self, when):
        """Return when the robot was told to stand still [s, monotonic]."""
        return wait_for(lambda: [entry for entry in self.end.after(when) if entry[1:] == ZERO],
                        10.0, 'the zero')[0][0]

    def close(self):
        """End the guard."""
        self.process.send_signal(signal.SIGCONT)
        self.process.terminate()
        self.process.wait()


class GuardTest(unittest.TestCase):

    def driver(self, name, *options, **keywords):
        """Return a driver, which ends with the test."""
        driver = Driver(name, *options, **keywords)
        self.addCleanup(driver.close)
        return driver

    def other(self, topic):
        """Let somebody else drive the robot at 50 Hz, and wait until it gets that."""
        process = subprocess.Popen([sys.executable, OTHER, topic, '50', '0.5', '__name:=nav'])
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        return process

    def test_a_stop_that_it_holds_answers_whoever_else_drives(self):
        driver = self.driver('beside', '_beside:=mux/input/navi')
        told = []
        rospy.Subscriber('/beside/mhri_guard/state', String, lambda said: told.append(said.data))
        driver.drive()
        other = self.other('/beside/cmd_vel')
        wait_for(lambda: driver.end.values()[-1:] == [(0.5, 0.0)], START_S, 'somebody else')
        begun = time.monotonic()
        driver.say(ZERO, stop=True)
        wait_for(lambda: driver.link.stop_confirmed, START_S, 'the guard to hold it')
        driver.leave()
        begun = time.monotonic()
        wait_for(lambda: time.monotonic() - begun > 2.0, 20.0, 'it to end', poll_s=0.05)
        said = driver.end.after(begun)
        moving_s = sum(b[0] - a[0] for a, b in zip(said, said[1:]) if a[1])
        measured('2 s of a held stop against 50 Hz: not told to stand for', moving_s)
        self.assertGreater(len([one for one in said if one[1]]), 50, 'it goes on')
        self.assertLess(moving_s, 0.4)
        self.assertIn('also:/nav', told[-1].split())
        other.terminate()
        wait_for(lambda: 'also' not in told[-1], START_S, 'that nobody does')
        wait_for(lambda: time.monotonic() - driver.end.received[-1][0] > 0.5, START_S, 'silence')
        # By another way to the robot, which only zeros on this one can win against.
        begun = time.monotonic()
        self.other('/beside/mux/input/navi')
        wait_for(lambda: len(driver.end.after(begun)) > 50, START_S, 'zeros')
        self.assertEqual({entry[1:] for entry in driver.end.after(begun)}, {ZERO})

    def test_what_its_own_navigation_says_is_passed_on_and_no_stop_lets_it_through(self):
        """The base listens to the guard alone; the stop holds with nobody there any more."""
        driver = self.driver('alone', '_command:=mhri_guard/velocity', '_pass_on:=cmd_vel',
                             '_max_linear_mps:=0.4', topic='mhri_guard/velocity')
        other, nav = self.other('/alone/cmd_vel'), (0.4, 0.0)
        wait_for(lambda: driver.end.values()[-1:] == [nav], START_S, 'its own navigation')
        since = driver.drive()
        for _ in range(20):
            driver.say(GO)
            time.sleep(0.02)
        self.assertEqual({entry[1:] for entry in driver.end.after(since)}, {GO})
        since = time.monotonic()
        wait_for(lambda: [one for one in driver.end.after(since) if one[1:] == nav], START_S,
                 'its own navigation again')
        driver.say(ZERO, stop=True)
        wait_for(lambda: driver.link.stop_confirmed, START_S, 'the guard to hold it')
        begun = time.monotonic()
        driver.leave()
        wait_for(lambda: time.monotonic() - begun > 2.0, 20.0, 'it to end', poll_s=0.05)
        self.assertEqual({entry[1:] for entry in driver.end.after(begun)}, {ZERO})
        driver.connect('next')
        driver.say(ZERO)
        wait_for(lambda: driver.end.values()[-1:] == [nav], START_S, 'its own navigation')
        when = time.monotonic()
        other.kill()
        self.assertLess(measured('own navigation killed: zero', driver.zero_after(when) - when),
                        1.3, 'promised: 1 s; see the figure')

    def test_a_lease_and_its_echo(self):
        driver = self.driver('lease')
        since = driver.drive()
        measured('commands ended: zero to the robot', driver.zero_after(since) - since)
        self.assertLess(driver.zero_after(since) - since, 0.6, 'promised: 0.35 s; see the figure')
        wait_for(lambda: driver.echoes[-1][1].twist.linear.x == 0.0, 10.0, 'the echo of it')
        begun, count = time.monotonic(), len(driver.echoes)
        wait_for(lambda: len(driver.echoes) >= count + 20, START_S, '20 echoes')
        measured('20 echoes', time.monotonic() - begun)
        self.assertLess(time.monotonic() - begun, 3.0)
        self.assertLess(abs(driver.echoes[-1][1].header.stamp.to_sec() - time.time()), 1.0)

    def stalled(self, driver, seconds, words):
        """Have what is said stand in the guard's socket, and come all at once."""
        driver.process.send_signal(signal.SIGSTOP)
        begun = time.monotonic()
        said = [driver.say(*word) for word in words]
        wait_for(lambda: time.monotonic() > begun + seconds, 60.0, 'the stall to end')
        since = time.monotonic()
        driver.process.send_signal(signal.SIGCONT)
        return since, said

    def test_a_backlog_moves_nothing_and_is_published_as_it_came(self):
        driver = self.driver('late')
        driver.drive()
        count = len(driver.dropped)
        since, said = self.stalled(driver, 1.2, [(GO,)] * 100)
        wait_for(lambda: len(driver.dropped) >= count + 100, 10.0, 'all that was dropped')
        self.assertEqual([message.header.frame_id for message in driver.dropped[count:]], said)
        self.assertEqual({entry[1:] for entry in driver.end.after(since)}, {ZERO})
        driver.drive()

    def test_a_stop_in_a_backlog_is_found(self):
        """The link comes back so soon that what stands behind the stop is still young."""
        driver = self.driver('stop')
        driver.drive()
        since, _ = self.stalled(driver, 0.2, [(GO,)] * 20 + [(ZERO, True)] + [(GO,)] * 20)
        wait_for(lambda: driver.link.stop_confirmed, 10.0, 'the stop to be confirmed')
        driver.say(GO)
        wait_for(lambda: driver.link.stop_confirmed and len(driver.dropped) >= 21, 10.0,
                 'what came behind the stop')
        self.assertEqual(driver.end.values()[-1], ZERO)
        driver.say(ZERO)
        wait_for(lambda: not driver.link.stop_confirmed, 10.0, 'its release')
        driver.drive()

    def test_a_guard_that_ends_stops_its_robot(self):
        driver = self.driver('end')
        driver.drive()
        since = time.monotonic()
        driver.process.terminate()
        self.assertLess(measured('guard ended: zero to the robot',
                                 driver.zero_after(since) - since), 0.5)

    def test_a_terminal_that_takes_no_text_holds_nothing_up(self):
        """Ctrl-S was pressed in it: whoever writes there waits."""
        mine, its = os.openpty()
        self.addCleanup(os.close, mine)
        self.addCleanup(os.close, its)
        driver = self.driver('mute', output=its)
        termios.tcflow(its, termios.TCOOFF)
        self.addCleanup(termios.tcflow, its, termios.TCOON)
        since, _ = self.stalled(driver, 1.1, [(GO,)] * 20)
        wait_for(lambda: driver.dropped, 10.0, 'something to complain of')
        # It complains once a second.
        wait_for(lambda: time.monotonic() > since + 2.5, 10.0, 'it to have done so')
        driver.leave()
        driver.connect('mute2')
        since = driver.drive()
        self.assertLess(driver.zero_after(since) - since, 0.6, 'promised: 0.35 s; see the figure')
        driver.say(ZERO, True)
        wait_for(lambda: driver.link.stop_confirmed, 10.0, 'the stop')

    def test_parameters_that_cannot_be_are_refused(self):
        for name, value, said in (
                ('lease_s', '-1', '~lease_s is -1: give a number from 0.05 to 2.0, such as 0.3'),
                ('answer_s', 'soon', "~answer_s is 'soon': give a number from 0.1 to 10.0"),
                ('max_linear_mps', '.nan', '~max_linear_mps is nan: give a number from 0 to 100'),
                ('max_angular_rad_s', 'true', '~max_angular_rad_s is True: give a number'),
                ('max_linear_mps2', '-0.1', 'such as 0 (no limit)'),
                ('pass_on', 'cmd_vel', "~pass_on is 'cmd_vel', which is ~command, too"),
                ('command', '5', '~command is 5: give the name of a velocity topic'),
                ('command', "'a b'", "~command is 'a b': give the name of a velocity topic")):
            with self.subTest(name=name, value=value):
                done = subprocess.run(
                    [sys.executable, GUARD, '_{}:={}'.format(name, value), '__name:=wrong'],
                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=START_S,
                    universal_newlines=True)
                rospy.delete_param('/wrong')
                self.assertEqual(done.returncode, 1)
                self.assertIn(said, done.stdout)


if __name__ == '__main__':
    rospy.init_node('guard_test')
    rostest.rosrun('mhri', 'guard', GuardTest)
