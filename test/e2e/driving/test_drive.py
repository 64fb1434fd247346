# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drive of the contract: the real node, driven through its inputs, and what robots receive."""
import signal
import socket
import subprocess
import sys
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rosgraph
import rospy
from std_srvs.srv import Trigger

from mhri.msg import TeamTwist
from mhri.srv import StopRobots
from support import graph
from support.deaf_robot import DeafRobot
from support.drive_case import DriveCase, ZERO
from support.own_node import own_node
from support.paths import SUPPORT
from support.ros_system import freeze, thaw, wait_for
from support.node_tools import measured, Process
from support.velocity import VelocityEnd

system = own_node('drive')

FAST, SLOW = (0.25, 0.0), (0.125, 0.0)


def break_link(topic):
    """Break the connection of a publisher or subscriber of this process; return when."""
    link, = topic.impl.connections
    when = time.monotonic()
    link.socket.shutdown(socket.SHUT_RDWR)
    return when


class DriveTest(DriveCase):
    """Each sentence of "The drive"."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.task = rospy.Publisher(graph.TASK_INPUT, TeamTwist, queue_size=2, tcp_nodelay=True)
        wait_for(cls.task.get_num_connections, what='the drive to listen to tasks')
        cls.stop_robots = rospy.ServiceProxy('/mux/stop_robots', StopRobots)

    def send_task(self, name, linear=0.1):
        """Say what a robot on a task shall do."""
        twist = Twist()
        twist.linear.x = linear
        self.task.publish(robots=[name], twists=[twist])

    def on_task(self, name, receiver):
        """Let a robot be driven by its task alone; return when that began.

        A robot that has just come obeys its task once that has left it out.
        """
        when = time.monotonic()

        def drives():
            self.task.publish()
            self.send_task(name)
            return (0.1, 0.0) in [entry[1:] for entry in receiver.after(when)]

        wait_for(drives, what='the task', poll_s=0.05)
        return when

    def test_only_selected_robots_are_driven_within_their_limits(self):
        (slow, slow_end), (other, other_end) = self.robots(1, 'turtlebot3') + self.robots(1)
        self.assertEqual(self.drive(other_end, *FAST), FAST)
        self.assertNotIn(FAST, slow_end.values())
        self.operator.check(slow)
        self.ready(slow)
        linear, angular = self.drive(slow_end, 0.5, 1.0)
        self.assertAlmostEqual(linear, 0.22)
        self.assertAlmostEqual(angular, 0.44)

    def test_every_end_of_motion_is_a_zero_at_once_and_20_a_second_for_half_a_second(self):
        (name, receiver), = self.robots(1)
        for what, act, within_s in (
                ('deselected', self.operator.check, 0.05), ('stop-all', self.operator.stop, 0.05),
                ('released stick', self.operator.centre, 0.05),
                ('stopped alone', lambda: (time.monotonic(), self.stop_robots([name]))[0], 0.05),
                ('silent stick', self.operator.stick.silence, 0.55)):
            with self.subTest(what):
                self.assertEqual(self.drive(receiver, *FAST), FAST)
                first = self.first_zero(what, receiver, act(), within_s)
                if what != 'released stick':
                    self.zeros_then_silence(receiver, first)
                    self.stays_at_rest(receiver, first)
                self.operator.release()
                self.select_anew(name)
                self.ready(name)

    def test_a_robot_that_is_removed_gets_its_zeros(self):
        name = self.new_name()
        receiver = VelocityEnd('/{}/cmd_vel'.format(name))
        rospy.set_param('/mhri/robots', [name])
        self.wait_robot(name, lambda robot: robot.topic, 'the topic')
        self.on_task(name, receiver)
        rospy.set_param('/mhri/robots', [])
        when = time.monotonic()
        wait_for(lambda: self.send_task(name) or ZERO in [
            entry[1:] for entry in receiver.after(when)], what='the zero', poll_s=0.02)
        first = next(at for at, *value in receiver.after(when) if tuple(value) == ZERO)
        self.zeros_then_silence(receiver, first)

    def test_stop_all_of_12_robots_and_of_one_that_is_not_selected(self):
        made = self.robots(12)
        self.operator.check(*[name for name, _ in made[1:]])
        self.wait_robot(made[0][0], lambda robot: not robot.obeys, 'the end of the selection')
        for _, receiver in made:
            wait_for(receiver.is_silent, what='silence')
        when = self.operator.stop()
        wait_for(lambda: all(receiver.after(when) for _, receiver in made), what='all zeros')
        arrivals = sorted(receiver.after(when)[0][0] for _, receiver in made)
        measured('stop-all, first to last of 12 robots', arrivals[-1] - arrivals[0], 0.02)

    def test_a_selection_that_is_not_repeated_is_no_lease(self):
        (name, receiver), = self.robots(1)
        self.drive(receiver, *FAST)
        first = self.first_zero('lease not renewed (1.0 to 1.5 s left)', receiver,
                                self.operator.fall_silent(), 1.6)
        self.stays_at_rest(receiver, first)
        self.operator.check(name)
        self.waits(name)
        self.stays_at_rest(receiver, first)
        self.ready(name)
        self.assertEqual(self.drive(receiver, *SLOW), SLOW)

    def other_operator(self, *names):
        """Start a second operator, which is refused; return (its process, its caller id)."""
        self.operator.fall_silent()
        other = Process([sys.executable, str(SUPPORT / 'operator_process.py')],
                        {'ROS_HOSTNAME': 'localhost'}, stdin=subprocess.PIPE)
        self.addCleanup(other.end)
        other.stdin.write('{}\n'.format(' '.join(names)).encode())
        other.stdin.flush()
        refused = self.state.wait(lambda state: any('operator_process' in line
                                                    for line in state.refused), 'its name').refused
        return other, next(line for line in refused if 'operator_process' in line).split(':')[0]

    @staticmethod
    def take_as(caller):
        """Take control under another name; return the answer."""
        return subprocess.check_output([sys.executable, '-c', TAKE.format(caller)], text=True)

    def test_a_killed_operator_leaves_a_zero_and_an_empty_seat(self):
        (name, receiver), = self.robots(1)
        other, caller = self.other_operator(name)
        self.assertEqual(self.state.message.operator, rospy.get_name())
        # One that publishes no selection; and as its own screen would ask for it.
        self.assertIn('success: False', self.take_as('/nobody'))
        self.assertEqual(self.state.message.operator, rospy.get_name())
        self.assertIn('success: True', self.take_as(caller))
        self.state.wait(lambda state: (state.operator, state.computer) == (caller, 'localhost'),
                        'the other one in control')
        self.ready(name)
        self.assertEqual(self.drive(receiver, *FAST), FAST)
        self.first_zero('operator killed', receiver, other.send(signal.SIGKILL), 0.05)
        self.assertEqual(self.state.message.operator, caller, 'it may come back')
        self.state.wait(lambda state: state.operator == '', 'an empty seat')
        self.operator.check(name)
        self.operator.take()

    def test_taking_control_stops_whoever_is_driven(self):
        (name, receiver), = self.robots(1)
        self.drive(receiver, *FAST)
        when = time.monotonic()
        self.assertTrue(rospy.ServiceProxy(graph.TAKE_CONTROL, Trigger)().success)
        first = self.first_zero('control taken', receiver, when, 0.1)
        self.waits(name)
        self.stays_at_rest(receiver, first)

    def test_a_stranger_moves_nothing_and_lifts_no_stop(self):
        (name, receiver), = self.robots(1)
        when = self.operator.stop()
        for topic, kind, value in (
                ('stop_all', 'std_msgs/Bool', 'false'),
                ('twist', 'geometry_msgs/Twist', '{linear: {x: 0.3}}'),
                ('robot_select', 'mhri/RobotSelect', '{robots: [%s]}' % name)):
            process = Process(['rostopic', 'pub', '-r', '20', '/robot_controller/' + topic, kind,
                               value], env={'ROS_NAMESPACE': '/stranger'})
            self.addCleanup(process.end)
        said = ('robot_select', graph.STOP_ALL, graph.COMMAND)
        self.state.wait(lambda state: all(
            any('/stranger/' in line and topic in line for line in state.refused)
            for topic in said), 'each to be named')
        self.assertTrue(self.state.message.stop_all)
        self.operator.release()
        self.ready(name)
        rospy.rostime.wallsleep(0.5)
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})
        self.assertEqual(self.drive(receiver, *FAST), FAST)

    def test_a_robot_that_comes_up_in_the_middle_of_a_drive_waits(self):
        (name, receiver), = self.robots(1)
        late = self.new_name()
        self.operator.check(name, late)
        self.wait_robot(late, lambda robot: robot.obeys == 'operator', 'the selection')
        self.ready(name)
        self.drive(receiver, *FAST)
        newcomer = VelocityEnd('/{}/cmd_vel'.format(late))
        wait_for(lambda: newcomer.received, what='the first word')
        self.stays_at_rest(newcomer, 0.0)
        self.waits(late)
        self.assertEqual(receiver.last(), FAST, 'the other drives on')
        self.ready(name, late)
        self.assertEqual(self.drive(newcomer, *SLOW), SLOW)

    def test_a_second_topic_that_is_listened_to_late_makes_the_robot_wait(self):
        topics = ('teleop/input', 'cmd_vel_mux/input/teleop')
        for first, late in (topics, topics[::-1]):
            (name, receiver), = self.robots(1, 'turtlebot2', first)
            self.drive(receiver, *FAST)
            newcomer = VelocityEnd('/{}/{}'.format(name, late))
            wait_for(lambda: newcomer.received, what='a word to ' + late)
            self.stays_at_rest(newcomer, 0.0)
            self.assertEqual(receiver.last(), ZERO, 'it joins as a whole')
            self.waits(name)
            self.ready(name)
            chosen = newcomer if late == topics[0] else receiver
            self.assertEqual(self.drive(chosen, *SLOW), SLOW, 'the first one is driven')
            self.operator.check()

    def test_who_merely_listens_changes_nothing(self):
        (name, receiver), = self.robots(1, 'turtlebot2', 'cmd_vel_mux/input/teleop')
        self.drive(receiver, *FAST)
        when = time.monotonic()
        topics = ['/{}/{}'.format(name, topic) for topic in (
            'mhri_guard/command', 'teleop/input', 'cmd_vel_mux/input/teleop')]
        for topic in topics:
            self.addCleanup(Process(['rostopic', 'echo', topic]).end)
        master = rosgraph.Master(rospy.get_name())

        def all_listen():
            listening = dict(master.getSystemState()[1])
            return all(any(node.startswith('/rostopic_') for node in listening.get(topic, ()))
                       for topic in topics)
        wait_for(all_listen, what='rostopic echo to listen', poll_s=0.05)
        rospy.rostime.wallsleep(1.0)
        self.assertEqual({entry[1:] for entry in receiver.after(when)}, {FAST})
        self.first_zero('stop-all with listeners', receiver, self.operator.stop(), 0.05)

    def test_a_robot_that_missed_who_publishes_its_topic_is_told_again(self):
        """Heard, but it does not listen: it hung, or was out of reach, when the master said so.

        Its own navigation, too: the drive cancels that one's goals.
        """
        name = self.new_name()
        odometry = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        self.addCleanup(odometry.unregister)
        deaf = [DeafRobot('/{}/{}'.format(name, topic))
                for topic in ('cmd_vel', 'move_base/cancel')]
        for one in deaf:
            self.addCleanup(one.close)
        self.operator.check(name)
        wait_for(lambda: all(any('/mux' in names for names in one.told) for one in deaf),
                 what='the first word')
        for one in deaf:
            one.told[:] = []
        wait_for(lambda: odometry.publish(Odometry()) or all(
            any('/mux' in names for names in one.told) for one in deaf),
                 what='the word once more', poll_s=0.1)

    def stopped_alone(self):
        """Return two driven robots of which the first is then stopped alone, and when it stood."""
        (one, one_end), (other, other_end) = self.robots(2)
        self.drive(one_end, *FAST)
        when = time.monotonic()
        self.assertTrue(self.stop_robots([one]).success)
        first = self.first_zero('stopped alone', one_end, when, 0.05)
        self.wait_robot(one, lambda robot: robot.stands == 'stopped_alone', 'the stop')
        return (one, one_end), (other, other_end), first

    def test_one_robot_is_stopped_until_it_is_selected_anew(self):
        (one, one_end), (other, other_end), first = self.stopped_alone()
        # What is merely repeated ends nothing.
        begun = time.monotonic()
        wait_for(lambda: time.monotonic() - begun > 1.2, what='two repetitions', poll_s=0.1)
        self.assertEqual({entry[1:] for entry in other_end.after(begun)}, {FAST})
        self.operator.check(other)
        self.wait_robot(one, lambda robot: not robot.selected, 'the end of the selection')
        for _ in range(20):
            self.send_task(one)
            rospy.rostime.wallsleep(0.02)
        self.assertEqual(self.state.robot(one).stands, 'stopped_alone', 'a task is refused')
        self.operator.check(one, other)
        self.waits(one)
        self.stays_at_rest(one_end, first)
        self.ready(one, other)
        self.assertEqual(self.drive(one_end, *SLOW), SLOW)

    def select_twice_at_once(self, *wishes):
        """Send selections that the drive finds in its socket together."""
        drive = self.worker()
        freeze(drive)
        try:
            for names in wishes:
                self.operator.check(*names)
            rospy.rostime.wallsleep(0.1)
        finally:
            thaw(drive)

    def test_a_robot_left_out_and_named_again_at_once_is_selected_anew(self):
        (one, one_end), (other, other_end), first = self.stopped_alone()
        self.select_twice_at_once([other], [other, one])
        self.wait_robot(one, lambda robot: robot.stands != 'stopped_alone', 'the end of the stop')
        self.stays_at_rest(one_end, first)
        self.ready(one, other)
        for receiver in (one_end, other_end):
            self.assertEqual(self.drive(receiver, *FAST), FAST)
        when = time.monotonic()
        self.select_twice_at_once([other], [other, one])
        first = self.first_zero('left out and named again', one_end, when, 0.25)
        self.stays_at_rest(one_end, first)

    def test_a_drive_that_ends_says_zeros(self):
        (_, receiver), = self.robots(1)
        self.drive(receiver, *FAST)
        first = self.first_zero('SIGTERM', receiver, self.drive_process.send(signal.SIGTERM), 0.05)
        self.zeros_then_silence(receiver, first)
        self.end_drive()
        self.start_drive()

    def test_the_state_is_published_as_soon_as_anything_begins_or_ends_to_move(self):
        (name, _), = self.robots(1)
        for what, act, moves in (('begin of motion', lambda: self.operator.push(*FAST), True),
                                 ('end of motion', self.operator.centre, False)):
            when = act()
            at = self.state.said(lambda state: any(
                robot.name == name and bool(robot.sent.linear.x) == moves
                for robot in state.robots), what, when)
            measured('state on ' + what, at - when, 0.08)

    def drives_on_after_neutral(self, name, receiver, first):
        """Show that the robot has had nothing but zeros, and drives once the stick is centred."""
        self.waits(name)
        self.stays_at_rest(receiver, first)
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0))

    def test_a_broken_connection_of_the_stick(self):
        (name, receiver), = self.robots(1)
        self.drive(receiver, 0.25)
        when = break_link(self.operator.stick.publisher)
        first = self.first_zero('connection of the stick broken', receiver, when, 0.05)
        self.operator.stick.wait_listener()
        self.drives_on_after_neutral(name, receiver, first)

    def test_a_broken_connection_of_the_selection(self):
        (name, receiver), = self.robots(1)
        self.drive(receiver, 0.25)
        when = break_link(self.operator.select)
        first = self.first_zero('connection of the selection broken', receiver, when, 0.05)
        self.drives_on_after_neutral(name, receiver, first)

    def test_a_broken_connection_to_a_robot(self):
        """It listens again as soon as it is told that the drive is there."""
        (name, receiver), = self.robots(1)
        odometry = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        self.addCleanup(odometry.unregister)
        # One that is first heard under way waits, too: not what is meant here.
        wait_for(odometry.get_num_connections, what='the drive to hear the robot')
        beats = rospy.Timer(rospy.Duration(0.1), lambda event: odometry.publish(Odometry()))
        self.addCleanup(beats.shutdown)
        rospy.rostime.wallsleep(0.3)
        self.ready(name)
        self.drive(receiver, 0.25)
        when = break_link(receiver.subscriber)
        wait_for(lambda: not receiver.connected(), what='the end of the connection')
        wait_for(lambda: receiver.after(when), what='the first word')
        self.assertEqual(receiver.after(when)[0][1:], ZERO)
        self.drives_on_after_neutral(name, receiver, when)


TAKE = '''
import rospy, rosgraph
from rospy.impl.tcpros_service import ServiceProxy
from std_srvs.srv import Trigger
import rospy.names
rospy.names._set_caller_id('{}')
print(ServiceProxy('/mux/take_control', Trigger)())
'''
