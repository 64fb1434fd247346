# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks of a robot with move_base, and of a turtle, by the real nodes."""
import contextlib
import math
import time

from move_base_msgs.msg import MoveBaseActionGoal
import psutil
import rospy

from mhri.msg import TaskState
from support.graph import navigation
from support.node_tools import measured, moves, Process
from support.own_node import own_node
from support.ros_system import freeze, processes_with, wait_for
from support.tasks_case import NavigationCase, TIMEOUT_S

system = own_node('tasks_navigation', '../../e2e/tasks/tasks.launch')


class TasksNavigation(NavigationCase):

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

    def test_a_robot_stands_when_mhri_tasks_hangs_and_what_stands_by(self):
        goal, hung = self.sent(), processes_with('__name:=mhri_tasks')
        try:
            freeze(*[process.pid for process in hung])
            since = time.monotonic()
            self.rests_for_good(since)
            measured('both hang: drove on for', max(
                item.at for item in self.commands['bot3'].since(since - 1.0)
                if moves(item.value)) - since, 3.0)
        finally:
            for process in hung:
                process.resume()
        self.ends(goal)

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
