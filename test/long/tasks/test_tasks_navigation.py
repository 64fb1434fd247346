# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks of a robot with move_base, and of a turtle, by the real nodes."""
import contextlib
import math
import time

import actionlib
from move_base_msgs.msg import MoveBaseActionGoal
import psutil
import rospy

from mhri.msg import TaskState

from support.graph import navigation
from support.own_node import own_node
from support.ros_system import freeze, insist, NotYet, processes_with, wait_for
from support.node_tools import measured, moves, Process, rests
from support.tasks_case import TIMEOUT_S, TasksCase

system = own_node('tasks_navigation', '../../e2e/tasks/tasks.launch')


class TasksNavigation(TasksCase):

    def sent(self):
        """Send the robot that has move_base somewhere; return the goal, once it is on its way."""
        def on_its_way():
            begun = time.monotonic()
            goal = self.start('bot3', 'goto', '{x: 50.0, y: 1.0, frame: odom}')
            wait_for(lambda: self.navigation.goals or goal.get_comm_state() ==
                     actionlib.CommState.DONE, what='its navigation gets no goal', timeout_s=60.0)
            if self.navigation.goals:
                self.commands['bot3'].wait(moves, begun, 60.0)
                return goal
            ended = self.ends(goal)
            self.assertEqual(ended[0][0], TaskState.LOST, ended)
            raise NotYet(str(ended))
        return insist(on_its_way, 'its navigation to get a goal')

    def wait_still(self):
        """Wait until nothing but zeros has come for 0.6 s: a stopped robot may get many of them."""
        wait_for(lambda: not [item for item in self.commands['bot3'].since(time.monotonic() - 0.6)
                              if moves(item.value)], what='it goes on', timeout_s=60.0)

    def rests_for_good(self, since):
        """Wait until it rests after the first zero of the mux; return that."""
        wait_for(lambda: not self.navigation.goals, what='its navigation goes on')
        first = self.commands['bot3'].wait(rests, since)
        self.wait_still()
        return first

    def test_a_goal_goes_to_the_navigation_of_the_robot(self):
        since = time.monotonic()
        goal = self.sent()
        # By its own clock: it would refuse what others send, whose clock is behind this one.
        self.assertEqual({item.value for item in self.navigation.stamps.since(since)}, {0.0})
        target = self.navigation.goals[0].get_goal().target_pose
        self.assertEqual((target.pose.position.x, target.pose.position.y), (50.0, 1.0))

        def drives_alone():
            lately = self.commands['bot3'].since(time.monotonic() - 0.3)
            return len(lately) > 1 and all(moves(item.value) for item in lately)
        wait_for(drives_alone, what='zeros are in the way of its navigation')
        self.navigation.end('succeeded')
        ended = self.ends(goal)
        self.assertEqual(ended[0][0], TaskState.DONE)
        goal = self.sent()
        self.navigation.end('aborted')
        ended = self.ends(goal)
        self.assertEqual(ended[0][0], TaskState.BLOCKED)
        self.assertIn('the test says so', ended[0][1])

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
                freeze(*[process.pid for process in hung])
                since = time.monotonic()
                ends()
                measured('{}, mhri_tasks hangs: first zero'.format(what),
                         self.rests_for_good(since).at - since)
            finally:
                for process in hung:
                    process.resume()

    def test_a_goal_that_somebody_sends_under_stop_all_or_to_a_checked_robot_ends(self):
        anybody = rospy.Publisher(navigation('bot3', 'goal'), MoveBaseActionGoal, queue_size=1)
        wait_for(anybody.get_num_connections, what='its navigation does not listen', timeout_s=60.0)
        for what, ends in (('stop-all', lambda: self.set_stop(True)),
                           ('checked', lambda: self.operator.check('bot3'))):
            self.setUp()
            ends()
            self.state.wait_robot('bot3', lambda gate: gate.obeys or gate.stands, what, 60.0)
            self.wait_still()
            since, taken = time.monotonic(), self.navigation.taken
            anybody.publish(MoveBaseActionGoal())
            # It may end before its first velocity.
            wait_for(lambda: self.navigation.taken > taken and not self.navigation.goals,
                     what=what + ': its navigation goes on')
            self.wait_still()
            measured('{}, a goal of somebody: drove for'.format(what), max(
                [item.at for item in self.commands['bot3'].since(since) if moves(item.value)],
                default=since) - since)

    def drives_on_for(self, ends, whole=False):
        """Do something to mhri_tasks while the navigation drives; return how long it drove on [s].

        :param whole: to what stands by as well: the last process runs
        """
        self.setUp()
        goal = self.sent()
        processes = processes_with('__name:=mhri_tasks')[0 if whole else -1:]
        self.commands['bot3'].wait(moves, time.monotonic(), 60.0)
        since = time.monotonic()
        for process in processes:
            # The second may end with the first.
            with contextlib.suppress(psutil.NoSuchProcess):
                ends(process)
        self.rests_for_good(since)
        # Asked for by a client of this process: mhri_tasks, which it belongs to, is gone.
        goal.cancel()
        wait_for(lambda: self.lists.since(since) and not self.lists.last().runs,
                 what='mhri_tasks does not come back', timeout_s=60.0)
        return max([item.at for item in self.commands['bot3'].since(since) if moves(item.value)],
                   default=since) - since

    def test_a_robot_stands_within_half_a_second_when_mhri_tasks_is_killed(self):
        for what, whole in (('mhri_tasks killed', False), ('and what stands by', True)):
            measured('{}: drove on for'.format(what),
                     self.drives_on_for(psutil.Process.kill, whole), 0.5)

    def test_a_robot_stands_when_mhri_tasks_hangs(self):
        measured('mhri_tasks hangs: drove on for', self.drives_on_for(
            psutil.Process.suspend), 3.0)

    def test_a_goal_ends_when_the_drive_service_is_started_anew(self):
        mux = processes_with('__name:=mux')[-1]
        # One that is killed right after its start has to be loaded anew.
        wait_for(lambda: time.time() - mux.create_time() > 2.5,
                 what='they do not last', timeout_s=60.0)
        goal = self.sent()
        since = time.monotonic()
        mux.kill()
        self.assertEqual(self.ends(goal)[0][0], TaskState.LOST)
        wait_for(lambda: not self.navigation.goals, what='its navigation goes on', timeout_s=60.0)
        self.wait_still()
        measured('drive service killed: drove on for', max(
            [item.at for item in self.commands['bot3'].since(since) if moves(item.value)],
            default=since) - since)

    def test_a_result_waits_for_who_is_not_connected_yet(self):
        ended = self.ends(self.start('bot1', 'return', '{mark: nowhere}'))
        late = Process(['rostopic', 'echo', '-n', '1', '/mhri_tasks/run/result/result'])
        self.addCleanup(late.end)
        self.assertEqual(late.wait(TIMEOUT_S), 0, late.said())
        self.assertIn(ended[0][1], late.said())

    def test_a_turtle_does_what_its_topics_allow(self):
        x, y, _ = self.turtle.wait(lambda where: True).value
        self.done('pond', 'goto', '{{x: {}, y: {}, frame: odom, speed: 1.0}}'.format(
            x + 1.0, y + 0.5))
        self.turtle.wait(lambda where: math.dist(where[:2], (x + 1.0, y + 0.5)) < 0.2,
                         time.monotonic())
        # Before the square: its trail is short still.
        self.done('pond', 'replay', '{seconds: 600, speed: 1.0}')
        self.done('pond', 'return', '{distance: 0.5, speed: 1.0}')
        self.assertIn('by odometry', self.done('pond', 'square', '{side: 0.5, speed: 1.0}'))
        ended = self.ends(self.start('pond', 'follow', '{leader: bot1}'))
        self.assertEqual(ended[0][0], TaskState.FAILED)
