#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gates of the contract: the real node, beside a mux and an operator that say what is asked."""
import os
import signal
import subprocess
import sys
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rosgraph
import rospy
import rostest
from std_srvs.srv import Trigger

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from gates_case import GatesCase, NEXT_S, start_gates, ZERO  # noqa: E402
from rostest_tools import measured, Process  # noqa: E402
from support.deaf_robot import DeafRobot  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.stuck_robot import StuckRobot  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402


class GatesTest(GatesCase):
    """Each sentence of "The gates"."""

    def test_only_checked_robots_are_driven_within_their_limits(self):
        (slow, slow_end), (other, other_end) = self.robots(1, 'turtlebot3') + self.robots(1)
        linear, angular = self.drive(other_end, 0.4, 0.2)
        self.assertEqual((linear, angular), (0.4, 0.2))
        self.assertNotIn((0.4, 0.2), slow_end.values())
        self.centre(other, other_end)
        self.operator.check(slow)
        self.state.wait_robot(slow, lambda gate: gate.obeys == 'operator', 'the other robot')
        self.centre(slow, slow_end)
        linear, angular = self.drive(slow_end, 0.5, 1.0)
        self.assertAlmostEqual(linear, 0.22)
        self.assertAlmostEqual(angular, 0.44)
        self.assertEqual(self.drive(slow_end, float('nan')), ZERO)
        self.assertEqual(self.drive(slow_end, 0.1, float('inf')), ZERO)

    def test_every_end_of_a_drive_is_a_zero_at_once(self):
        (name, receiver), = self.robots(1)
        for what, act in (('deselected', lambda: self.operator.check()),
                          ('stop-all', lambda: self.mux.stop(True))):
            self.drive(receiver, 0.2)
            self.first_zero(what, receiver, act(), 0.05)
            self.stays_at_rest(receiver, time.monotonic())
            self.mux.stop(False)
            self.operator.check(name)
            self.state.wait_robot(name, lambda gate: gate.stands == 'joining', 'it waits')
            self.centre(name, receiver)
            self.assertEqual(self.drive(receiver, 0.1), (0.1, 0.0), 'the stick was centred')
        driven = receiver.received[-1][0]
        wait_for(lambda: receiver.values()[-1] == ZERO, 2.0, 'the zero of a stale command')
        delay = measured('first zero, stale command', receiver.received[-1][0] - driven)
        self.assertLess(delay, 0.6)
        self.assertGreater(delay, 0.45)

    def test_stop_all_of_12_robots_and_of_one_that_is_not_checked(self):
        made = self.robots(12)
        self.operator.check(*[name for name, _ in made[1:]])
        self.state.wait_robot(made[0][0], lambda gate: not gate.obeys, 'one robot unchecked')
        when = self.mux.stop(True)
        wait_for(lambda: all(receiver.after(when) for _, receiver in made), what='all zeros')
        arrivals = sorted(receiver.after(when)[0][0] for _, receiver in made)
        measured('stop-all, first to last of 12 robots', arrivals[-1] - arrivals[0])
        self.assertLess(arrivals[-1] - arrivals[0], 0.1, 'promised: 20 ms; see the figure')

    def test_a_selection_that_is_not_repeated_is_no_lease(self):
        (name, receiver), = self.robots(1)
        silent_at = self.operator.fall_silent()
        while not any(entry[1:] == ZERO for entry in receiver.after(silent_at + 0.6)):
            self.mux.say(0.2)
            self.assertLess(time.monotonic() - silent_at, 3.0, 'it drives on')
            rospy.rostime.wallsleep(0.02)
        taken = receiver.after(silent_at)[-1][0] - silent_at
        self.assertLess(measured('first zero, lease not renewed (1.0 to 1.5 s left)', taken), 1.65)
        self.operator.check(name)
        self.state.wait(lambda state: state.leased, 'the lease')
        self.stays_at_rest(receiver, time.monotonic())
        self.centre(name, receiver)
        self.assertEqual(self.drive(receiver, 0.1), (0.1, 0.0))

    def test_a_killed_operator_leaves_a_zero_and_an_empty_seat(self):
        (name, receiver), = self.robots(1)
        self.operator.fall_silent()
        other = Process([sys.executable, os.path.join(os.path.dirname(__file__),
                                                      'operator_process.py')],
                        {'ROS_HOSTNAME': 'localhost'}, stdin=subprocess.PIPE)
        self.addCleanup(other.end)
        other.stdin.write('{}\n'.format(name).encode())
        other.stdin.flush()
        self.state.wait(lambda state: any('operator_process' in line for line in state.refused),
                        'the second operator to be refused and named', 20.0)
        self.assertEqual(self.state.message.operator, rospy.get_name())
        caller = next(line for line in self.state.message.refused
                      if 'operator_process' in line).split(':')[0]
        # One that publishes no selection; and as its own screen would ask for it.
        self.assertIn('success: False', self.take_as('/nobody'))
        self.assertEqual(self.state.message.operator, rospy.get_name())
        self.assertIn('success: True', self.take_as(caller))
        self.state.wait(lambda state: (state.operator, state.computer) == (caller, 'localhost'),
                        'the other one in control')
        self.state.wait_robot(name, lambda gate: gate.obeys == 'operator',
                              'the selection of the other one')
        self.centre(name, receiver)
        self.assertEqual(self.drive(receiver, 0.2), (0.2, 0.0))
        self.first_zero('operator killed', receiver, other.send(signal.SIGKILL), 0.05)
        self.assertEqual(self.state.message.operator, caller, 'it may come back')
        self.state.wait(lambda state: state.operator == '', 'an empty seat')
        self.operator.check(name)
        self.state.wait(lambda state: state.operator == rospy.get_name(), 'who comes next')

    @staticmethod
    def take_as(caller):
        """Take control under another name; return the answer."""
        return subprocess.check_output([sys.executable, '-c', TAKE.format(caller)], text=True)

    def test_taking_control_stops_whoever_is_driven(self):
        (_, receiver), = self.robots(1)
        self.drive(receiver, 0.2)
        when = time.monotonic()
        self.assertTrue(rospy.ServiceProxy('/gates/take_control', Trigger)().success)
        self.first_zero('control taken', receiver, when, 0.1)
        wait_for(lambda: self.state.robot('gate{}'.format(GatesCase.number)).stands == 'joining',
                 what='the selection once more, and the wait')
        self.stays_at_rest(receiver, when)

    def test_a_stranger_moves_nothing_and_lifts_no_stop(self):
        (name, receiver), = self.robots(1)
        self.mux.stop(True)
        self.state.wait(lambda state: state.stop_all, 'the stop')
        when = time.monotonic()
        strangers = [Process(['rostopic', 'pub', '-r', '20', '/robot_controller/' + topic, kind,
                              value], env={'ROS_NAMESPACE': '/stranger'})
                     for topic, kind, value in (
                         ('stop_all', 'std_msgs/Bool', 'false'),
                         ('twist', 'geometry_msgs/Twist', '{linear: {x: 0.3}}'),
                         ('robot_select', 'mhri/RobotSelect', '{robots: [%s]}' % name))]
        for process in strangers:
            self.addCleanup(process.end)
        self.state.wait(lambda state: len([line for line in state.refused
                                           if '/stranger/' in line]) == 3,
                        'all three to be refused and named', 20.0)
        self.assertTrue(self.state.message.stop_all)
        self.mux.stop(False)
        self.state.wait(lambda state: not state.stop_all, 'the release by the mux')
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})

    def test_a_robot_that_comes_up_in_the_middle_of_a_drive_waits(self):
        (name, receiver), = self.robots(1)
        GatesCase.number += 1
        late = 'gate{}'.format(GatesCase.number)
        self.operator.check(name, late)
        self.state.wait_robot(late, lambda gate: gate.obeys == 'operator', 'the gate of the late')
        self.centre(name, receiver)
        self.drive(receiver, 0.2)
        newcomer = VelocityEnd('/{}/cmd_vel'.format(late))
        deadline = time.monotonic() + 20.0
        while not newcomer.received and time.monotonic() < deadline:
            self.drive(receiver, 0.2)
            rospy.rostime.wallsleep(0.02)
        self.stays_at_rest(newcomer, 0.0)
        self.state.wait_robot(late, lambda gate: gate.stands == 'joining', 'that it waits')
        self.centre(late, newcomer)
        self.assertEqual(self.drive(newcomer, 0.1), (0.1, 0.0))

    def test_a_second_topic_that_is_listened_to_late_makes_the_robot_wait(self):
        topics = ('teleop/input', 'cmd_vel_mux/input/teleop')
        for first, late in (topics, topics[::-1]):
            (name, receiver), = self.robots(1, 'turtlebot2', first)
            self.drive(receiver, 0.2)
            newcomer = VelocityEnd('/{}/{}'.format(name, late))
            wait_for(lambda: self.mux.say(0.2) and newcomer.received, 20.0, 'a word to ' + late,
                     poll_s=0.02)
            self.stays_at_rest(newcomer, 0.0)
            self.assertEqual(receiver.values()[-1], ZERO, 'it joins as a whole')
            self.state.wait_robot(name, lambda gate: gate.stands == 'joining', 'that it waits')
            self.centre(name, newcomer)
            chosen = newcomer if late == topics[0] else receiver
            self.assertEqual(self.drive(chosen, 0.1), (0.1, 0.0), 'the first one is driven')
            self.operator.check()

    def test_who_merely_listens_changes_nothing(self):
        (name, receiver), = self.robots(1, 'turtlebot2', 'cmd_vel_mux/input/teleop')
        self.drive(receiver, 0.2)
        topics = ['/{}/{}'.format(name, topic) for topic in (
            'mhri_guard/command', 'teleop/input', 'cmd_vel_mux/input/teleop')]
        ears = [Process(['rostopic', 'echo', topic]) for topic in topics]
        for ear in ears:
            self.addCleanup(ear.end)
        master = rosgraph.Master(rospy.get_name())

        def all_listen():
            """Say something that the ears hear; tell whether they all did."""
            self.mux.say(0.2)
            listeners = dict(master.getSystemState()[1])
            return all(any('rostopic' in ear for ear in listeners.get(topic, ()))
                       for topic in topics)

        wait_for(all_listen, 20.0, 'rostopic echo', poll_s=0.05)
        for _ in range(40):
            self.assertEqual(self.drive(receiver, 0.2), (0.2, 0.0))
        when = self.mux.stop(True)
        self.first_zero('stop-all with listeners', receiver, when, 0.05)

    def test_a_task_is_obeyed_until_the_robot_is_checked(self):
        (name, receiver), = self.robots(1)
        self.operator.check()
        self.state.wait_robot(name, lambda gate: not gate.obeys, 'the robot let go')
        task = Twist()
        task.linear.x = 0.1
        when = time.monotonic()

        def work():
            """Go on with the task; return what the robot was told."""
            self.mux.task_twist.publish(robots=[name], twists=[task])
            return [entry[1:] for entry in receiver.after(when)]

        wait_for(lambda: (0.1, 0.0) in work(), what='the task', poll_s=0.05)
        self.state.wait_robot(name, lambda gate: gate.obeys == 'task', 'the task in the state')
        when = self.operator.check(name)
        wait_for(lambda: ZERO in work(), what='the zero of the take-over', poll_s=0.02)
        when = next(at for at, *value in receiver.after(when) if tuple(value) == ZERO)
        self.assertEqual(set(work()), {ZERO})
        self.operator.check()
        self.state.wait_robot(name, lambda gate: not gate.obeys, 'given back')
        for _ in range(20):
            self.assertEqual(set(work()), {ZERO}, 'nothing resumes by itself')
            rospy.rostime.wallsleep(0.02)

    def test_a_group_keeps_together_where_the_operator_says_so(self):
        (slow, slow_end), = self.robots(1, 'turtlebot3')
        (_, quick_end) = self.robots(1, 'turtlebot2', 'teleop/input')[0]
        quick = 'gate{}'.format(GatesCase.number)
        self.operator.check(slow, quick)
        self.state.wait(lambda state: [gate.obeys for gate in state.robots if gate.name in (
            slow, quick)] == ['operator'] * 2, 'both')
        self.operator.set(together=True)
        self.addCleanup(self.operator.set)
        self.state.wait(lambda state: state.together, 'together')
        self.centre(slow, slow_end)
        self.centre(quick, quick_end)
        self.assertAlmostEqual(self.drive(quick_end, 0.5)[0], 0.22)
        wait_for(lambda: abs(slow_end.values()[-1][0] - 0.22) < 1e-6, what='the slow one')
        self.centre(quick, quick_end)
        self.operator.set()
        self.state.wait(lambda state: not state.together, 'each for itself')
        self.assertAlmostEqual(self.drive(quick_end, 0.5)[0], 0.5)

    def test_a_dead_robot_never_delays_the_others(self):
        (name, receiver), = self.robots(1)
        GatesCase.number += 1
        dead = 'gate{}'.format(GatesCase.number)
        self.operator.check(name, dead)
        self.state.wait_robot(dead, lambda gate: gate.obeys == 'operator', 'the dead one')
        stuck = StuckRobot('/{}/cmd_vel'.format(dead))
        self.addCleanup(stuck.close)
        self.mux.say(0.0)
        delays = []
        for number in range(1500):
            value = 0.1 + 0.0001 * (number % 1000)
            when = self.mux.say(value)
            wait_for(lambda: receiver.after(when), 2.0, 'a command past it', poll_s=0.0002)
            delays.append(receiver.after(when)[0][0] - when)
            receiver.received[:] = receiver.received[-1:]
        delays.sort()
        print('MEASURED beside a dead robot, {} commands: median {:.2f} ms, p99 {:.2f} ms, most '
              '{:.2f} ms'.format(len(delays), delays[750] * 1e3, delays[1485] * 1e3,
                                 delays[-1] * 1e3))
        self.assertLess(delays[1485], 0.25)

    def test_a_robot_that_missed_who_speaks_to_it_is_told_again(self):
        """Heard, but it does not listen: it hung, or was out of reach, when the master said so."""
        GatesCase.number += 1
        name = 'gate{}'.format(GatesCase.number)
        odometry = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        self.addCleanup(odometry.unregister)
        deaf = DeafRobot('/{}/cmd_vel'.format(name))
        self.addCleanup(deaf.close)
        self.operator.check(name)
        self.state.wait_robot(name, lambda gate: gate.obeys == 'operator', 'the gate')
        wait_for(lambda: any('/mhri_gates' in names for names in deaf.told), what='the first word')
        deaf.told[:] = []
        wait_for(lambda: odometry.publish(Odometry()) or any('/mhri_gates' in names
                                                             for names in deaf.told),
                 20.0, 'the word once more', poll_s=0.1)

    def test_gates_that_are_killed_are_followed_by_a_zero(self):
        made = self.robots(4)
        self.drive_all(made, 0.2)
        when = self.gates.send(signal.SIGKILL)
        GatesCase.gates = start_gates()
        for name, receiver in made:
            wait_for(lambda: receiver.after(when), 20.0, 'the zero for ' + name)
            at, *value = receiver.after(when)[0]
            self.assertEqual(tuple(value), ZERO)
            self.assertLess(measured('zero of the next gates', at - when), NEXT_S)
            self.stays_at_rest(receiver, when, commands=5)
        self.wait_for_mux()
        for name, receiver in made:
            self.state.wait_robot(name, lambda gate: gate.obeys, 'all back')
            self.centre(name, receiver)
        for _, receiver in made:
            self.assertEqual(self.drive(receiver, 0.2), (0.2, 0.0))

    def test_a_robot_unchecked_while_there_are_no_gates_gets_its_zero(self):
        (_, still), (_, driven) = made = self.robots(2)
        self.drive_all(made, 0.2)
        when = self.gates.send(signal.SIGKILL)
        self.gates.wait()
        self.operator.check(made[0][0])
        GatesCase.gates = start_gates()
        for receiver in (still, driven):
            wait_for(lambda: receiver.after(when), 20.0, 'the zero')
            at, *value = receiver.after(when)[0]
            self.assertEqual(tuple(value), ZERO)
            self.assertLess(measured('zero of the next gates, unchecked meanwhile', at - when),
                            NEXT_S)
        self.wait_for_mux()

    def test_gates_that_end_say_zero(self):
        (name, receiver), = self.robots(1)
        self.drive(receiver, 0.2)
        when = self.gates.send(signal.SIGTERM)
        self.first_zero('SIGTERM', receiver, when, 0.25)
        self.gates.wait()
        GatesCase.gates = start_gates()
        self.wait_for_mux()


TAKE = '''
import rospy, rosgraph
from rospy.impl.tcpros_service import ServiceProxy
from std_srvs.srv import Trigger
import rospy.names
rospy.names._set_caller_id('{}')
print(ServiceProxy('/gates/take_control', Trigger)())
'''


if __name__ == '__main__':
    rospy.init_node('gates_test')
    rostest.rosrun('mhri', 'gates', GatesTest)
