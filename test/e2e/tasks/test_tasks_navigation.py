# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks of a robot with a navigation of its own, by the real nodes: sent there, and cancelled."""
import time

from mhri.msg import TaskState
from support.node_tools import measured, moves, rests
from support.own_node import own_node
from support.ros_system import freeze, processes_with, wait_for
from support.tasks_case import NavigationCase

system = own_node('tasks_navigation', 'tasks.launch')


class TasksNavigation(NavigationCase):

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

    def test_who_cancels_the_task_cancels_the_goal(self):
        goal = self.sent()
        since = time.monotonic()
        goal.cancel()
        self.assertEqual(self.ends(goal)[0][0], TaskState.STOPPED)
        wait_for(lambda: not self.navigation.goals, what='its navigation goes on')
        self.wait_still()
        first = self.commands['bot3'].wait(rests, since)
        measured('task cancelled: told to stand', first.at - since)

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
