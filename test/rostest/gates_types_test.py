#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot's type says, at the real gates: the power of its motors, how silent it may be."""
import os
import sys
import time

from nav_msgs.msg import Odometry
import rospy
import rostest
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.base.robot_types import SILENT_AFTER_S  # noqa: E402
from mhri.msg import GatesState  # noqa: E402
from gates_case import GatesCase  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

# What most robots may not be silent for.
LONG_S = 1.5 * SILENT_AFTER_S


class Base:
    """Notes what the base of a TurtleBot3 is told of its motors' power."""

    def __init__(self, robot):
        self.heard = []
        self.subscriber = rospy.Subscriber('/{}/motor_power'.format(robot), Bool,
                                           lambda message: self.heard.append(message.data))


class Wheels:
    """The odometry of a robot, and why it was kept standing while it said some."""

    def __init__(self, robot):
        self.stood = set()
        self.said_at = time.monotonic()
        self._robot = robot
        self.publisher = rospy.Publisher('/{}/odom'.format(robot), Odometry, queue_size=1)
        self.ear = rospy.Subscriber('/gates/state', GatesState, self._hear)

    def _hear(self, state):
        self.stood.update(gate.stands for gate in state.robots if gate.name == self._robot)

    def say(self):
        """Say something."""
        self.said_at = time.monotonic()
        self.publisher.publish(Odometry())

    def silent_s(self):
        """Return how long nothing was said [s]."""
        return time.monotonic() - self.said_at


class GatesTypesTest(GatesCase):

    def set_power(self, on):
        answer = rospy.ServiceProxy('/gates/set_motor_power', SetBool)(on)
        return answer.success, answer.message

    def powered(self):
        """Add a robot whose power can be cut; return its name and its base."""
        (name, _), = self.robots(1, 'turtlebot3')
        base = Base(name)
        self.addCleanup(base.subscriber.unregister)
        wait_for(base.subscriber.get_num_connections, what='the gates to reach the base')
        return name, base

    def power_is(self, name, *states):
        self.state.wait_robot(name, lambda gate: gate.power in states, 'its power: ' + str(states))

    def test_power_cut_under_a_stop_comes_back_with_the_release_and_not_before(self):
        name, base = self.powered()
        self.mux.stop(True)
        self.state.wait(lambda state: state.stop_all, 'the stop')
        done, words = self.set_power(False)
        self.assertTrue(done)
        self.assertTrue(words.startswith('motor power is being cut'), words)
        wait_for(lambda: base.heard, what='the cut')
        self.power_is(name, 'cut sent')
        self.assertEqual(self.set_power(True), (
            False, 'release the stop first: that restores the power'))
        self.power_is(name, 'cut sent')
        self.assertEqual(set(base.heard), {False}, 'it was told nothing else')
        self.mux.stop(False)
        wait_for(lambda: base.heard[-1], what='the power')
        self.power_is(name, '')

    def test_power_is_cut_and_restored_without_a_stop_where_there_is_such_a_thing(self):
        name, base = self.powered()
        (other, _), = self.robots(1)
        done, words = self.set_power(False)
        self.assertTrue(done)
        self.assertIn(other, words.partition('; not for ')[2].partition(': ')[0].split(', '))
        wait_for(lambda: base.heard, what='the cut')
        self.power_is(name, 'cut sent')
        done, words = self.set_power(True)
        self.assertTrue(done)
        self.assertTrue(words.startswith('motor power is being restored'), words)
        wait_for(lambda: base.heard[-1], what='the power')
        self.assertEqual(base.heard[0], False)
        self.power_is(name, '')

    def test_a_release_gives_no_power_that_was_not_cut(self):
        name, base = self.powered()
        self.mux.stop(True)
        self.state.wait(lambda state: state.stop_all, 'the stop')
        self.mux.stop(False)
        self.state.wait(lambda state: not state.stop_all, 'the release')
        self.set_power(False)
        wait_for(lambda: base.heard, what='the cut')
        self.assertEqual(base.heard[0], False, 'told before anybody asked')
        self.set_power(True)
        self.power_is(name, '')

    def silent(self, **template):
        """Add a robot whose type is overridden so; return its name, its end and its wheels."""
        name = 'gate{}'.format(GatesCase.number + 1)
        rospy.set_param('/{}/mhri'.format(name), template)
        wheels = Wheels(name)
        self.addCleanup(wheels.publisher.unregister)
        self.addCleanup(wheels.ear.unregister)
        (name, receiver), = self.robots(1)
        wait_for(wheels.publisher.get_num_connections, what='the gates to listen to its wheels')
        return name, receiver, wheels

    def heard_first(self, name, receiver, wheels):
        """Let the robot be heard for the first time: driven meanwhile, it waits for neutral."""
        self.drives(name, receiver, 0.2)
        wheels.say()
        wait_for(lambda: self.mux.say(0.2) and self.state.robot(name).stands == 'joining',
                 what='its first word', poll_s=0.05)
        self.centre(name, receiver)
        wheels.stood.clear()

    def drives(self, name, receiver, linear):
        """Centre the stick, and push it until the robot has that."""
        self.centre(name, receiver)
        wait_for(lambda: self.mux.say(linear) and receiver.values()[-1] == (linear, 0.0),
                 what='the robot to be driven', poll_s=0.05)

    def hold(self, linear, seconds):
        """Hold the stick so for a while."""
        begun = time.monotonic()
        wait_for(lambda: self.mux.say(linear) and time.monotonic() - begun > seconds, poll_s=0.05)

    def test_a_robot_that_is_heard_more_seldom_is_driven_where_its_type_says_so(self):
        name, receiver, wheels = self.silent(silent_after_s=30.0)
        self.heard_first(name, receiver, wheels)
        for _ in range(3):
            self.hold(0.2, LONG_S)
            wheels.say()
        self.assertNotIn('not_heard', wheels.stood)
        self.drives(name, receiver, 0.1)

    def test_the_same_robot_is_held_where_its_type_says_nothing(self):
        name, receiver, wheels = self.silent()
        self.heard_first(name, receiver, wheels)
        self.hold(0.2, LONG_S)
        self.state.wait_robot(name, lambda gate: gate.stands == 'not_heard', 'that it is held')
        self.assertEqual(receiver.values()[-1], (0.0, 0.0))

    def test_a_robot_that_is_heard_only_as_it_moves_is_driven_off_after_any_rest(self):
        name, receiver, wheels = self.silent(silent_after_s=0)
        self.heard_first(name, receiver, wheels)
        for _ in range(2):
            self.hold(0.0, LONG_S)
            self.assertGreater(wheels.silent_s(), SILENT_AFTER_S)
            self.drives(name, receiver, 0.2)
            wheels.say()
        self.assertNotIn('not_heard', wheels.stood)
        wheels.publisher.unregister()
        self.hold(0.2, LONG_S)
        self.state.wait_robot(name, lambda gate: gate.stands == 'not_heard',
                              'that one whose driver has gone is held all the same')


if __name__ == '__main__':
    rospy.init_node('gates_types_test')
    rostest.rosrun('mhri', 'gates_types', GatesTypesTest)
