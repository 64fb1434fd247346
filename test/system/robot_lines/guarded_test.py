#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The guard on the robot and the drive on the host: the real nodes, and a network in between."""
import os
import signal
import sys
import time

from geometry_msgs.msg import TwistStamped
import rosgraph
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..'))


from mhri.srv import StopRobots  # noqa: E402
from support.drive_case import DriveCase, ZERO  # noqa: E402
from support.paths import GUARD  # noqa: E402
from support.relay import Delay, put_in_front, SlowNode  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.rostest_tools import measured, Process  # noqa: E402

# Longer than a guard obeys what was said: a second [s].
STALL_S = 1.5


class GuardedTest(DriveCase):
    """What the robot does by itself."""

    def guard(self, name, *options):
        """Start the guard of a robot; return it once it is used."""
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel', *options],
                        env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        self.wait_robot(name, lambda robot: robot.guarded, 'the guard')
        return guard

    def guarded(self):
        """Return (name, receiving end, process of the guard) of a robot that is ready to drive."""
        (name, receiver), = self.robots(1)
        guard = self.guard(name)
        self.ready(name)
        return name, receiver, guard

    def test_commands_go_through_the_guard_and_one_that_is_killed_leaves_a_robot_that_waits(self):
        name, receiver, guard = self.guarded()
        self.assertEqual(self.drive(receiver, 0.25, 0.1875), (0.25, 0.1875))
        self.assertEqual(self.state.robot(name).topic, '/{}/mhri_guard/command'.format(name))
        when = guard.send(signal.SIGKILL)
        self.wait_robot(name, lambda robot: not robot.guarded, 'no guard')
        first = self.first_zero('guard killed, by the plain topic', receiver, when, 2.0)
        self.waits(name)
        self.stays_at_rest(receiver, first)
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0), 'by the plain topic')

    def test_a_stop_that_somebody_else_sends_to_the_guard_stops_all_until_it_is_released(self):
        name, receiver, _ = self.guarded()
        script = rospy.Publisher('/{}/mhri_guard/command'.format(name), TwistStamped, queue_size=1)
        self.addCleanup(script.unregister)
        wait_for(script.get_num_connections, what='the guard to listen')
        self.drive(receiver, 0.25)
        stop = TwistStamped()
        stop.header.frame_id = 'script!:1:'
        when = time.monotonic()
        script.publish(stop)
        first = self.first_zero("a script's stop", receiver, when, 0.1)
        self.state.wait(lambda state: state.stop_all, 'the stop that the robot tells of')
        self.stays_at_rest(receiver, first)
        self.operator.release()
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0))

    def test_one_robot_that_is_stopped_is_latched_on_its_guard_alone(self):
        name, receiver, _ = self.guarded()
        (other, other_end), = self.robots(1)
        self.guard(other)
        self.operator.check(name, other)
        self.ready(name, other)
        self.drive(receiver, 0.25)
        when = time.monotonic()
        rospy.ServiceProxy('/mux/stop_robots', StopRobots)([name])
        first = self.first_zero('stopped alone through the guard', receiver, when, 0.05)
        self.wait_robot(name, lambda robot: robot.stop_confirmed, 'the word of the robot')
        self.assertFalse(self.state.robot(other).stop_confirmed or self.state.message.stop_all)
        when, run = self.kill_drive()
        self.wait_for_drive(run)
        self.wait_robot(name, lambda robot: robot.stands == 'stopped_alone'
                        and robot.stop_confirmed, 'the stop')
        self.assertFalse(self.state.message.stop_all)
        self.ready(other)
        self.drive(other_end, 0.25)
        self.stays_at_rest(receiver, first)
        self.select_anew(name, besides=[other])
        self.ready(name, other)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0))

    def behind_a_network(self, node, delay, topic, kind):
        """Let everybody find a topic of a node behind a slow network only."""
        uri = rosgraph.Master(rospy.get_name()).lookupNode(node)
        slow = SlowNode(uri, delay)
        self.addCleanup(slow.close)
        put_in_front(slow, node, uri, topic, kind)

    def motion_s(self, receiver, since):
        """Return for how long the robot has moved since a time [s]."""
        told = receiver.after(since) + [(time.monotonic(), 0.0, 0.0)]
        return sum(after[0] - before[0] for before, after in zip(told, told[1:])
                   if before[1:] != ZERO)

    def test_no_backlog_moves_a_guarded_robot(self):
        """The link is stalled with the stick held.

        rospy may have found its way around the network just then: it holds up nothing, and another
        robot is put behind it.
        """
        for _ in range(3):
            moved_s = self.stalled_once()
            if moved_s is not None:
                self.assertEqual(moved_s, 0.0)
                return
        self.fail('a guarded robot that was cut off got no zero')

    def stalled_once(self):
        """Do so once; return for how long the robot moved, None where it was not told to stand."""
        delay = Delay()
        (name, receiver), = self.robots(1)
        self.behind_a_network('/mux', delay, '/{}/mhri_guard/command'.format(name),
                              'geometry_msgs/TwistStamped')
        self.guard(name)
        self.behind_a_network('/{}/mhri_guard'.format(name), delay,
                              '/{}/mhri_guard/echo'.format(name), 'geometry_msgs/TwistStamped')
        self.wait_robot(name, lambda robot: robot.guarded, 'the guard behind the network')

        def goes():
            """On a busy computer a robot that was not heard for a moment asks for neutral again.

            Be quick: a second after it was cut off, rospy finds its way around the network.
            """
            self.operator.centre()
            rospy.rostime.wallsleep(0.1)
            self.operator.push(0.25)
            rospy.rostime.wallsleep(0.3)
            return receiver.moves()
        wait_for(goes, what='it to go')
        delay.stall()
        stalled = time.monotonic()
        rospy.rostime.wallsleep(STALL_S)
        zeros = [at for at, *value in receiver.after(stalled) if tuple(value) == ZERO]
        self.operator.centre()
        if not zeros:
            delay.go_on()
            return None
        measured('link stalled: the guard says zero', zeros[0] - stalled)
        back = time.monotonic()
        delay.go_on()
        rospy.rostime.wallsleep(1.0)
        moved_s = measured('link stalled for {} s: the guarded robot moves afterwards for'.format(
            STALL_S), self.motion_s(receiver, back))
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.25), (0.25, 0.0))
        return moved_s

    def test_a_stranger_at_the_guard_is_said_and_shut_out_again(self):
        name, receiver, _ = self.guarded()
        heard = []
        ear = rospy.Subscriber('/{}/mhri_guard/echo'.format(name), TwistStamped, heard.append,
                               queue_size=1)
        self.addCleanup(ear.unregister)
        mouth = rospy.Publisher('/{}/mhri_guard/command'.format(name), TwistStamped, queue_size=1)
        self.addCleanup(mouth.unregister)
        self.drive(receiver, 0.25)
        wait_for(lambda: heard and mouth.get_num_connections(), what='the guard')
        message = TwistStamped()

        def named():
            """Speak with the newest token: it does not count for long."""
            message.header.frame_id = 'stranger:1:' + heard[-1].header.frame_id.split(':')[2]
            mouth.publish(message)
            return any(name in line for line in self.state.message.refused)
        wait_for(named, what='the word of somebody else', poll_s=0.05)
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0))


if __name__ == '__main__':
    rospy.init_node('guarded_test')
    rostest.rosrun('mhri', 'guarded', GuardedTest)
