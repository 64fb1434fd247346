#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The guard on the robot and the gates on the host: the real nodes, and a network in between."""
import os
import signal
import subprocess
import sys
import time

from geometry_msgs.msg import TwistStamped
import rosgraph
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from gates_case import GatesCase, start_gates, ZERO  # noqa: E402
from rostest_tools import measured, Process  # noqa: E402
from support.relay import Delay, put_in_front, SlowNode  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

GUARD = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'utils', 'remote',
                     'mhri_guard')
# Longer than a guard obeys what was said: a second [s].
STALL_S = 1.5


class GatesGuardTest(GatesCase):
    """What the robot does by itself."""

    def guarded(self, *options):
        """Return (name, receiving end, process of the guard) of a robot that is ready to drive."""
        (name, receiver), = self.robots(1)
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel'] + list(options),
                        env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        self.state.wait_robot(name, lambda gate: gate.guarded, 'the guard', 20.0)
        self.centre(name, receiver)
        return name, receiver, guard

    def test_commands_go_through_the_guard(self):
        name, receiver, _ = self.guarded()
        self.assertEqual(self.drive(receiver, 0.2, 0.1), (0.2, 0.1))
        self.assertEqual(self.state.robot(name).topic, '/{}/mhri_guard/command'.format(name))

    def test_a_guard_that_is_killed_leaves_a_robot_that_waits(self):
        name, receiver, guard = self.guarded()
        self.drive(receiver, 0.2)
        when = guard.send(signal.SIGKILL)
        deadline = time.monotonic() + 10.0
        while self.state.robot(name).guarded and time.monotonic() < deadline:
            self.mux.say(0.2)
            rospy.rostime.wallsleep(0.02)
        self.stays_at_rest(receiver, when)
        zeros = [at for at, *value in receiver.after(when) if tuple(value) == ZERO]
        measured('guard killed: first zero by the plain topic', zeros[0] - when)
        self.state.wait_robot(name, lambda gate: gate.stands == 'joining', 'that it waits')
        self.centre(name, receiver)
        self.assertEqual(self.drive(receiver, 0.1), (0.1, 0.0), 'by the plain topic')

    def test_a_guard_that_ends_says_zero(self):
        _, receiver, guard = self.guarded()
        self.drive(receiver, 0.2)
        when = guard.send(signal.SIGTERM)
        wait_for(lambda: ZERO in [entry[1:] for entry in receiver.after(when)], what='the zero')

    def test_a_stop_is_latched_on_the_robot_and_outlives_the_gates(self):
        name, receiver, _ = self.guarded()
        self.drive(receiver, 0.2)
        when = self.mux.stop(True)
        self.first_zero('stop-all through the guard', receiver, when, 0.05)
        self.state.wait_robot(name, lambda gate: gate.stop_confirmed, 'the word of the robot')
        # Gates and mux start anew, and the mux knows nothing of it: nobody has released the stop.
        self.gates.send(signal.SIGKILL)
        self.mux.stop(False)
        GatesCase.gates = start_gates()
        self.wait_for_mux()
        self.state.wait(lambda state: state.stop_all, 'the stop that the robot tells of', 20.0)
        self.stays_at_rest(receiver, when)
        # The mux takes it over, as the real one does, and its service releases it.
        self.mux.stop(True)
        self.mux.stop(False)
        self.state.wait(lambda state: not state.stop_all, 'the release')
        self.centre(name, receiver)
        wait_for(lambda: self.drive(receiver, 0.1) == (0.1, 0.0), what='it to be driven again')

    def behind_a_network(self, node, delay, topic, kind):
        """Let everybody find a topic of a node behind a slow network only."""
        uri = rosgraph.Master(rospy.get_name()).lookupNode(node)
        slow = SlowNode(uri, delay)
        self.addCleanup(slow.close)
        put_in_front(slow, node, uri, topic, kind)

    def hold_stick(self, linear, seconds):
        """Hold the stick for a while."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self.mux.say(linear)
            rospy.rostime.wallsleep(0.05)

    def motion_s(self, receiver, since):
        """Return for how long the robot has moved since a time [s]."""
        told = receiver.after(since) + [(time.monotonic(), 0.0, 0.0)]
        return sum(after[0] - before[0] for before, after in zip(told, told[1:])
                   if before[1:] != ZERO)

    def stalled_robot(self, back_too):
        """Stall the link of a guarded robot with the stick held; return how it moved."""
        delay = Delay()
        (name, receiver), = self.robots(1)
        self.behind_a_network('/mhri_gates', delay, '/{}/mhri_guard/command'.format(name),
                              'geometry_msgs/TwistStamped')
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel'], env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        self.state.wait_robot(name, lambda gate: gate.guarded, 'the guard', 20.0)
        if back_too:
            self.behind_a_network('/{}/mhri_guard'.format(name), delay,
                                  '/{}/mhri_guard/echo'.format(name), 'geometry_msgs/TwistStamped')
            wait_for(lambda: self.state.robot(name).guarded, what='the guard behind the network')

        def goes():
            """On a busy computer a robot that was not heard for a moment asks for neutral again."""
            self.centre(name, receiver)
            self.hold_stick(0.3, 0.5)
            return receiver.received[-1][1] > 0.0
        wait_for(goes, what='it to go')
        delay.stall()
        stalled = time.monotonic()
        self.hold_stick(0.3, STALL_S)
        zero = next(at for at, *value in receiver.after(stalled) if tuple(value) == ZERO)
        measured('link stalled: the guard says zero', zero - stalled)
        back = time.monotonic()
        delay.go_on()
        self.hold_stick(0.0, 1.0)
        moved_s = measured('link stalled for {} s{}: the guarded robot moves afterwards for'.format(
            STALL_S, '' if back_too else ', one way'), self.motion_s(receiver, back))
        self.centre(name, receiver)
        wait_for(lambda: self.drive(receiver, 0.2) == (0.2, 0.0), what='it to be driven again')
        return moved_s

    def test_no_backlog_moves_a_guarded_robot(self):
        self.assertEqual(self.stalled_robot(back_too=True), 0.0)

    def test_a_link_that_stalls_one_way_moves_it_for_a_moment_at_most(self):
        """Its echoes come through, so that the commands that were held up are not a second old.

        They come all at once, but a busy computer takes its time to pass them on.
        """
        self.assertLess(self.stalled_robot(back_too=False), 0.3)

    def test_round_trips_are_measured_and_may_slow_a_group(self):
        (name, receiver), = self.robots(1)
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel'], env={'ROS_NAMESPACE': name})
        self.addCleanup(guard.end)
        self.state.wait_robot(name, lambda gate: gate.guarded and gate.round_trip_s < 0.1,
                              'a round trip', 20.0)
        self.operator.set(slow_with_link=True)
        self.addCleanup(self.operator.set)
        guard.send(signal.SIGSTOP)
        self.state.wait_robot(name, lambda gate: not gate.round_trip_s < 0.1, 'a hung node', 20.0)
        guard.send(signal.SIGCONT)
        self.state.wait(lambda state: state.share == 1.0, 'the full speed')

    def test_a_stranger_at_the_guard_is_said_and_shut_out_again(self):
        name, receiver, _ = self.guarded()
        echo, heard = '/{}/mhri_guard/echo'.format(name), []
        ear = rospy.Subscriber(echo, TwistStamped, heard.append, queue_size=1)
        self.addCleanup(ear.unregister)
        mouth = rospy.Publisher('/{}/mhri_guard/command'.format(name), TwistStamped, queue_size=1)
        self.addCleanup(mouth.unregister)
        self.drive(receiver, 0.2)
        wait_for(lambda: heard and mouth.get_num_connections(), what='the guard')
        message = TwistStamped()
        message.header.frame_id = 'stranger:1:' + heard[-1].header.frame_id.split(':')[2]
        mouth.publish(message)
        self.state.wait(lambda state: any(name in line for line in state.refused),
                        'the word of somebody else')
        self.centre(name, receiver)
        wait_for(lambda: self.drive(receiver, 0.1) == (0.1, 0.0), what='it to be driven again')

    def test_a_parameter_that_cannot_be_is_refused(self):
        done = subprocess.run([sys.executable, GUARD, '_lease_s:=-1', '__name:=wrong'],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60.0,
                              universal_newlines=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn('~lease_s is -1', done.stdout)


if __name__ == '__main__':
    rospy.init_node('gates_guard_test')
    rostest.rosrun('mhri', 'gates_guard', GatesGuardTest)
