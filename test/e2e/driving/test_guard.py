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
from std_msgs.msg import String

from mhri.driving.guard_link import GuardLink
from support.own_node import own_node
from support.paths import GUARD, SUPPORT
from support.ros_system import freeze, thaw, wait_for
from support.node_tools import measured
from support.velocity import VelocityEnd

system = own_node('guard')

OTHER = str(SUPPORT / 'other_driver.py')
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
                        what='the zero')[0][0]

    def stop(self):
        """Have the guard hold a stop; return when the robot was told to stand."""
        when = time.monotonic()
        self.say(ZERO, stop=True)
        wait_for(lambda: self.link.stop_confirmed, what='the guard to hold it')
        # Its echo may be read before what it has told the robot.
        return self.zero_after(when)

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
        begun = driver.stop()
        driver.leave()

        def gaps_s():
            """Return how long it was told to move, each time [s]."""
            said = driver.end.after(begun)
            return sorted(b[0] - a[0] for a, b in zip(said, said[1:]) if a[1])
        wait_for(lambda: len(gaps_s()) > 80, what='it to go on', poll_s=0.05)
        measured('80 times against a held stop: not told to stand for', sum(gaps_s()))
        self.assertLess(gaps_s()[40], 0.01, 'a zero directly behind each; see above')
        wait_for(lambda: 'also:/nav' in ' '.join(told[-1:]).split(), what='the name')
        other.terminate()
        wait_for(lambda: 'also' not in told[-1], START_S, 'that nobody does')
        wait_for(driver.end.is_silent, what='silence')
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
        begun = driver.stop()
        driver.leave()
        wait_for(lambda: time.monotonic() - begun > 2.0, what='a while', poll_s=0.05)
        self.assertEqual({entry[1:] for entry in driver.end.after(begun)}, {ZERO})
        driver.connect('next')
        driver.say(ZERO)
        wait_for(lambda: driver.end.values()[-1:] == [nav], START_S, 'its own navigation')
        when = time.monotonic()
        other.kill()
        measured('own navigation killed: zero', driver.zero_after(when) - when,
                 1.0 + 0.05)

    def test_a_lease_and_its_echo(self):
        driver = self.driver('lease')
        since = driver.drive()
        measured('commands ended: zero to the robot', driver.zero_after(since) - since, 0.35)
        wait_for(lambda: driver.echoes[-1][1].twist.linear.x == 0.0, 10.0, 'the echo of it')
        count = len(driver.echoes)
        wait_for(lambda: len(driver.echoes) >= count + 20, START_S, '20 echoes')

    def stalled(self, driver, seconds, words):
        """Have what is said stand in the guard's socket, and come all at once."""
        begun = freeze(driver.process.pid)
        said = [driver.say(*word) for word in words]
        wait_for(lambda: time.monotonic() > begun + seconds, 60.0, 'the stall to end')
        return thaw(driver.process.pid), said

    def test_a_stop_in_a_backlog_is_found(self):
        """The link comes back so soon that what stands behind the stop is still young."""
        driver = self.driver('stop')
        driver.drive()
        since, _ = self.stalled(driver, 0.2, [(GO,)] * 20 + [(ZERO, True)] + [(GO,)] * 20)
        wait_for(lambda: driver.link.stop_confirmed, 10.0, 'the stop to be confirmed')
        driver.say(GO)
        wait_for(lambda: driver.link.stop_confirmed and len(driver.dropped) >= 21, 10.0,
                 'what came behind the stop')
        self.assertEqual(driver.end.last(), ZERO)
        driver.say(ZERO)
        wait_for(lambda: not driver.link.stop_confirmed, 10.0, 'its release')
        driver.drive()

    def test_a_guard_that_ends_stops_its_robot(self):
        driver = self.driver('end')
        driver.drive()
        since = time.monotonic()
        driver.process.terminate()
        measured('guard ended: zero to the robot',
                 driver.zero_after(since) - since, 0.5)

    def test_a_terminal_that_takes_no_text_holds_nothing_up(self):
        """Ctrl-S was pressed in it: whoever writes there waits."""
        mine, its = os.openpty()
        self.addCleanup(os.close, mine)
        self.addCleanup(os.close, its)
        driver = self.driver('mute', output=its)
        termios.tcflow(its, termios.TCOOFF)
        self.addCleanup(termios.tcflow, its, termios.TCOON)
        # A guard that stands still while it connects may do so anew, and miss what was said before.
        driver.drive()
        since, _ = self.stalled(driver, 1.1, [(GO,)] * 20)
        wait_for(lambda: driver.dropped, 10.0, 'something to complain of')
        # It complains once a second.
        wait_for(lambda: time.monotonic() > since + 2.5, 10.0, 'it to have done so')
        driver.leave()
        driver.connect('mute2')
        since = driver.drive()
        measured('behind it: zero to the robot', driver.zero_after(since) - since, 0.35)
        driver.stop()

    def test_parameters_that_cannot_be_are_refused(self):
        for name, value, said in (
                ('lease_s', '-1', '~lease_s is -1'),
                ('pass_on', 'cmd_vel', "~pass_on is 'cmd_vel'"),
                ('command', "'a b'", "~command is 'a b'")):
            with self.subTest(name=name, value=value):
                done = subprocess.run(
                    [sys.executable, GUARD, '_{}:={}'.format(name, value), '__name:=wrong'],
                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=START_S,
                    universal_newlines=True)
                rospy.delete_param('/wrong')
                self.assertEqual(done.returncode, 1)
                self.assertIn(said, done.stdout)
