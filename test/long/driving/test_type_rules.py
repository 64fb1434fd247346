# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot's type says, at the real drive: the power of its motors, how silent it may be."""
import time

from nav_msgs.msg import Odometry
import rospy
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

from mhri.base.robot_types import SILENT_AFTER_S
from mhri.msg import DriveState
from support import graph
from support.drive_case import DriveCase, ZERO
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('type_rules')

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
        self.ear = rospy.Subscriber(graph.DRIVE_STATE, DriveState, self._hear)

    def _hear(self, state):
        self.stood.update(robot.stands for robot in state.robots if robot.name == self._robot)

    def say(self):
        """Say something."""
        self.said_at = time.monotonic()
        self.publisher.publish(Odometry())

    def silent_s(self):
        """Return how long nothing was said [s]."""
        return time.monotonic() - self.said_at


class TypeRulesTest(DriveCase):

    def set_power(self, on):
        answer = rospy.ServiceProxy(graph.SET_MOTOR_POWER, SetBool)(on)
        return answer.success, answer.message

    def powered(self):
        """Add a robot whose power can be cut; return its name and its base."""
        (name, _), = self.robots(1, 'turtlebot3')
        base = Base(name)
        self.addCleanup(base.subscriber.unregister)
        wait_for(base.subscriber.get_num_connections, what='the drive to reach the base')
        return name, base

    def power_is(self, name, *states):
        self.wait_robot(name, lambda robot: robot.power in states, 'its power: ' + str(states))

    def test_power_cut_under_a_stop_comes_back_with_the_release_and_not_before(self):
        name, base = self.powered()
        self.operator.stop()
        self.state.wait(lambda state: state.stop_all, 'the stop')
        done, words = self.set_power(False)
        self.assertTrue(done)
        self.assertTrue(words.startswith('motor power is being cut'), words)
        wait_for(lambda: base.heard, what='the cut')
        self.power_is(name, 'cut_sent')
        self.assertEqual(self.set_power(True), (
            False, 'release the stop first: that restores the power'))
        self.power_is(name, 'cut_sent')
        self.assertEqual(set(base.heard), {False}, 'it was told nothing else')
        self.operator.release()
        wait_for(lambda: base.heard[-1], what='the power')
        self.power_is(name, 'on')

    def test_power_is_cut_and_restored_without_a_stop_where_there_is_such_a_thing(self):
        name, base = self.powered()
        (other, _), = self.robots(1)
        done, words = self.set_power(False)
        self.assertTrue(done)
        self.assertIn(other, words.partition('; not for ')[2].partition(': ')[0].split(', '))
        wait_for(lambda: base.heard, what='the cut')
        self.power_is(name, 'cut_sent')
        done, words = self.set_power(True)
        self.assertTrue(done)
        self.assertTrue(words.startswith('motor power is being restored'), words)
        wait_for(lambda: base.heard[-1], what='the power')
        self.assertEqual(base.heard[0], False)
        self.power_is(name, 'on')

    def stands_and_then_joins(self, name, receiver, reason, hold, let_go):
        """Hold a robot that is driven, let it go while the stick is held: it waits for neutral."""
        self.drives(name, receiver, 0.125)
        hold()
        self.wait_robot(name, lambda robot: robot.stands == reason, 'its stand')
        wait_for(lambda: receiver.last() == ZERO, what='its zero')
        zero_at = time.monotonic()
        let_go()
        wait_for(lambda: self.operator.push(0.125) and self.state.robot(name).stands == 'joining',
                 what='the wait', poll_s=0.05)
        self.assertLessEqual({entry[1:] for entry in receiver.after(zero_at)}, {ZERO})
        self.drives(name, receiver, 0.125)

    def test_a_robot_whose_power_comes_back_while_the_stick_is_held_waits_for_neutral(self):
        (name, receiver), = self.robots(1, 'turtlebot3')
        base = Base(name)
        self.addCleanup(base.subscriber.unregister)
        wait_for(base.subscriber.get_num_connections, what='the drive to reach the base')
        self.stands_and_then_joins(name, receiver, 'power_cut', lambda: self.set_power(False),
                                   lambda: self.set_power(True))

    def test_a_robot_whose_own_emergency_stop_is_unlocked_waits_for_neutral(self):
        name = self.next_name()
        rospy.set_param('/{}/mhri'.format(name), {'hardware_stop': {'topic': 'e_stop'}})
        switch = rospy.Publisher('/{}/e_stop'.format(name), Bool, queue_size=1, latch=True)
        self.addCleanup(switch.unregister)
        (name, receiver), = self.robots(1)
        self.stands_and_then_joins(name, receiver, 'hardware_stop', lambda: switch.publish(True),
                                   lambda: switch.publish(False))

    def silent(self, **template):
        """Add a robot whose type is overridden so; return its name, its end and its wheels."""
        name = self.next_name()
        rospy.set_param('/{}/mhri'.format(name), template)
        wheels = Wheels(name)
        self.addCleanup(wheels.publisher.unregister)
        self.addCleanup(wheels.ear.unregister)
        (name, receiver), = self.robots(1)
        wait_for(wheels.publisher.get_num_connections, what='the drive to listen to its wheels')
        return name, receiver, wheels

    def heard_first(self, name, receiver, wheels):
        """Let the robot be heard for the first time: driven meanwhile, it waits for neutral."""
        self.drives(name, receiver, 0.25)
        wheels.say()
        wait_for(lambda: self.operator.push(0.25) and self.state.robot(name).stands == 'joining',
                 what='its first word', poll_s=0.05)
        # It is silent from then on, not before.
        beats = rospy.Timer(rospy.Duration(0.2), lambda _: wheels.say())
        self.ready(name)
        beats.shutdown()
        beats.join()
        wheels.stood.clear()

    def drives(self, name, receiver, linear):
        """Centre the stick, and push it until the robot has that."""
        self.ready(name)
        wait_for(lambda: self.operator.push(linear) and receiver.last() == (linear, 0.0),
                 what='the robot to be driven', poll_s=0.05)

    def hold(self, linear, seconds):
        """Hold the stick so for a while."""
        begun = self.operator.push(linear)
        wait_for(lambda: time.monotonic() - begun > seconds, poll_s=0.05)

    def test_odometry_that_shows_no_motion_through_several_pushes_proves_no_stop(self):
        name, receiver, wheels = self.silent()
        self.heard_first(name, receiver, wheels)
        beats = rospy.Timer(rospy.Duration(0.05), lambda _: wheels.say())
        self.addCleanup(beats.shutdown)
        self.assertTrue(self.state.robot(name).odometry_follows)
        for _ in range(3):
            self.drives(name, receiver, 0.25)
            self.hold(0.25, 0.7)
            self.hold(0.0, 0.7)
        self.wait_robot(name, lambda robot: not robot.odometry_follows, 'the word for it')

    def test_a_robot_that_is_heard_more_seldom_is_driven_where_its_type_says_so(self):
        name, receiver, wheels = self.silent(silent_after_s=30.0)
        self.heard_first(name, receiver, wheels)
        self.hold(0.25, LONG_S)
        self.assertGreater(wheels.silent_s(), SILENT_AFTER_S)
        self.drives(name, receiver, 0.125)
        self.assertNotIn('not_heard', wheels.stood)

    def test_the_same_robot_is_held_where_its_type_says_nothing(self):
        name, receiver, wheels = self.silent()
        self.heard_first(name, receiver, wheels)
        self.hold(0.25, LONG_S)
        self.wait_robot(name, lambda robot: robot.stands == 'not_heard', 'that it is held')
        wait_for(lambda: receiver.last() == ZERO, what='its zero')

    def test_a_robot_that_is_heard_only_as_it_moves_is_driven_off_after_any_rest(self):
        name, receiver, wheels = self.silent(silent_after_s=0)
        self.heard_first(name, receiver, wheels)
        for _ in range(2):
            self.hold(0.0, LONG_S)
            self.assertGreater(wheels.silent_s(), SILENT_AFTER_S)
            self.drives(name, receiver, 0.25)
            wheels.say()
        self.assertNotIn('not_heard', wheels.stood)
        wheels.publisher.unregister()
        self.hold(0.25, LONG_S)
        self.wait_robot(name, lambda robot: robot.stands == 'not_heard',
                        'that one whose driver has gone is held all the same')
