#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks of a robot with move_base, and of a turtle, by the real nodes."""
import math
import time

import actionlib
from move_base_msgs.msg import MoveBaseActionGoal
import rospy
import rostest
from rostest_tools import measured, moves, Process, rests, wait_until
from tasks_more_case import PATIENCE_S, TasksMoreCase

from mhri.msg import TaskState  # noqa: E402
from support.graph import navigation  # noqa: E402
from support.ros_system import processes_with  # noqa: E402


class TasksNavigation(TasksMoreCase):

    def sent(self):
        """Send the robot that has move_base somewhere; return the goal, once it is on its way.

        Again where something came too late: on a busy machine that says nothing of the task.
        """
        for _ in range(12):
            begun = time.monotonic()
            goal = self.start('bot3', 'goto', '{x: 50.0, y: 1.0, frame: odom}')
            wait_until(lambda one=goal: self.navigation.goals or one.get_comm_state() ==
                       actionlib.CommState.DONE, 'its navigation gets no goal', 60.0)
            if self.navigation.goals:
                self.commands.wait(moves, begun, 60.0)
                return goal
            ended = self.ends(goal)
            print('again: {}'.format(ended))
            self.assertEqual(ended[0][0], TaskState.LOST, ended)
        raise AssertionError('its navigation gets no goal again and again')

    def wait_still(self):
        """Wait until nothing but zeros has come for 0.6 s: a stopped robot may get many of them."""
        wait_until(lambda: not [item for item in self.commands.since(time.monotonic() - 0.6)
                                if moves(item.value)], 'it goes on', 60.0)

    def rests_for_good(self, since):
        """Wait until it rests after the first zero of the gates."""
        wait_until(lambda: not self.navigation.goals, 'its navigation goes on', 60.0)
        self.wait_still()
        noted = self.commands.since(since)
        self.assertTrue([item for item in noted if rests(item.value)], 'no zero came')
        self.assertTrue(rests(noted[-1].value))

    def test_a_goal_goes_to_the_navigation_of_the_robot(self):
        # What gates that have just begun say is over.
        wait_until(lambda: not self.commands.since(time.monotonic() - 0.6), 'zeros go on', 60.0)
        begun = time.monotonic()
        goal = self.sent()
        target = self.navigation.goals[0].get_goal().target_pose
        self.assertEqual((target.pose.position.x, target.pose.position.y), (50.0, 1.0))
        self.assertEqual([item.value for item in self.commands.since(begun)
                          if rests(item.value)][3:], [], 'zeros are in the way of its navigation')
        self.navigation.end('succeeded')
        ended = self.ends(goal)
        self.assertEqual(ended[0][0], TaskState.DONE)
        self.assertIn('it is there by its own navigation', ended[0][1])
        goal = self.sent()
        self.navigation.end('aborted')
        self.assertEqual(self.ends(goal), [
            (TaskState.BLOCKED, 'its own navigation found no way (the test says so)')])

    def test_whatever_ends_a_task_cancels_the_goal_there(self):
        for ends, state in (
                (lambda goal: self.set_stop(True), TaskState.STOPPED),
                (lambda goal: self.operator.check('bot3'), TaskState.TAKEN_OVER),
                (lambda goal: goal.cancel(), TaskState.STOPPED),
                (lambda goal: self.operator.fall_silent(), TaskState.LOST),
                (lambda goal: self.start('bot3', 'hold', '{seconds: 0.5}'),
                 TaskState.TAKEN_OVER)):
            self.setUp()
            goal = self.sent()
            since = time.monotonic()
            ends(goal)
            self.assertEqual(self.ends(goal)[0][0], state)
            self.rests_for_good(since)

    def test_stop_all_and_checking_cancel_the_goal_while_mhri_tasks_hangs(self):
        """Its navigation speaks to the robot itself: nobody else would tell it to end."""
        for what, ends in (('stop-all', lambda: self.set_stop(True)),
                           ('checked', lambda: self.operator.check('bot3'))):
            self.setUp()
            self.sent()
            hung = processes_with('__name:=mhri_tasks')
            try:
                for process in hung:
                    process.suspend()
                since = time.monotonic()
                ends()
                self.rests_for_good(since)
                first = next(item for item in self.commands.since(since) if rests(item.value))
                measured('{}, mhri_tasks hangs: first zero'.format(what), first.at - since)
            finally:
                for process in hung:
                    process.resume()

    def test_a_goal_that_somebody_sends_under_stop_all_or_to_a_checked_robot_ends(self):
        anybody = rospy.Publisher(navigation('bot3', 'goal'), MoveBaseActionGoal, queue_size=1)
        wait_until(anybody.get_num_connections, 'its navigation does not listen', 60.0)
        for what, ends in (('stop-all', lambda: self.set_stop(True)),
                           ('checked', lambda: self.operator.check('bot3'))):
            self.setUp()
            ends()
            self.state.wait_robot('bot3', lambda gate: gate.obeys or gate.stands, what, 60.0)
            self.wait_still()
            since = time.monotonic()
            anybody.publish(MoveBaseActionGoal())
            self.commands.wait(moves, since, 60.0)
            wait_until(lambda: not self.navigation.goals, what + ': its navigation goes on', 60.0)
            self.wait_still()
            last = [item for item in self.commands.since(since) if moves(item.value)][-1]
            measured('{}, a goal of somebody: drove for'.format(what), last.at - since)

    def drives_on_for(self, ends):
        """Do something while the navigation drives; return how long it drove on [s]."""
        self.setUp()
        goal = self.sent()
        self.commands.wait(moves, time.monotonic(), 60.0)
        since = time.monotonic()
        ends()
        self.rests_for_good(since)
        # Asked for by a client of this process: mhri_tasks, which it belongs to, is gone.
        goal.cancel()
        wait_until(lambda: self.lists.since(since) and not self.lists.last().runs,
                   'mhri_tasks does not come back', 60.0)
        return max([item.at for item in self.commands.since(since) if moves(item.value)],
                   default=since) - since

    def test_a_robot_stands_within_half_a_second_when_mhri_tasks_is_killed(self):
        def kill(whole):
            # The last one runs, the other one stands by.
            for process in processes_with('__name:=mhri_tasks')[0 if whole else -1:]:
                process.kill()

        for what, whole in (('mhri_tasks killed', False), ('and what stands by', True)):
            drove_s = measured('{}: drove on for'.format(what),
                               self.drives_on_for(lambda kills=whole: kill(kills)))
            self.assertLess(drove_s, 0.5, what)

    def test_a_robot_stands_when_mhri_tasks_hangs(self):
        drove_s = measured('mhri_tasks hangs: drove on for', self.drives_on_for(
            lambda: processes_with('__name:=mhri_tasks')[-1].suspend()))
        self.assertLess(drove_s, 3.0)

    def test_a_goal_ends_when_the_drive_service_is_started_anew(self):
        gates = processes_with('__name:=mhri_gates')[-1]
        # Who is killed right after its start has to be loaded anew.
        wait_until(lambda: time.time() - gates.create_time() > 2.5, 'they do not last', 60.0)
        goal = self.sent()
        since = time.monotonic()
        gates.kill()
        self.assertEqual(self.ends(goal)[0][0], TaskState.LOST)
        wait_until(lambda: not self.navigation.goals, 'its navigation goes on', 60.0)
        self.wait_still()
        measured('drive service killed: drove on for', max(
            item.at for item in self.commands.since(since) if moves(item.value)) - since)

    def test_a_goal_is_stamped_by_the_clock_of_the_navigation(self):
        """Or it would refuse what others send, whose clock is behind that of this computer."""
        since = time.monotonic()
        self.sent()
        self.assertEqual([item.value for item in self.navigation.stamps.since(since)], [0.0])

    def test_a_result_waits_for_who_is_not_connected_yet(self):
        ended = self.ends(self.start('bot1', 'return', '{mark: nowhere}'))
        late = Process(['rostopic', 'echo', '-n', '1', '/mhri_tasks/run/result/result'])
        self.addCleanup(late.end)
        self.assertEqual(late.wait(PATIENCE_S), 0, late.said())
        self.assertIn(ended[0][1], late.said())

    def test_a_turtle_does_what_its_topics_allow(self):
        x, y, _ = self.turtle.last()
        self.done('pond', 'goto', '{{x: {}, y: {}, frame: odom, speed: 1.0}}'.format(
            x + 1.0, y + 0.5))
        self.assertLess(math.dist(self.turtle.last()[:2], (x + 1.0, y + 0.5)), 0.2)
        # Before the square: its trail is short still.
        self.done('pond', 'replay', '{seconds: 600, speed: 1.0}')
        self.done('pond', 'return', '{distance: 0.5, speed: 1.0}')
        self.assertIn('by odometry', self.done('pond', 'square', '{side: 0.5, speed: 1.0}'))
        ended = self.ends(self.start('pond', 'follow', '{leader: bot1}'))
        self.assertEqual(ended[0][0], TaskState.FAILED)


if __name__ == '__main__':
    rospy.init_node('tasks_navigation_test')
    rostest.rosrun('mhri', 'tasks_navigation', TasksNavigation)
