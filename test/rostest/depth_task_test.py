#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A task of a robot without a laser, from goal to rest: the real nodes, its depth camera alone."""
import os
import sys
import time
import unittest

import actionlib
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from drive_tools import Hall  # noqa: E402
from mhri.msg import RunTaskAction, RunTaskGoal, TaskState  # noqa: E402
from rostest_tools import wait_until  # noqa: E402
from support.fake_mux import FakeOperator, StateEar  # noqa: E402

PATIENCE_S = 180.0
RADIUS_M = 0.177
GOAL = (10.2, 2.6)


class DepthTask(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.operator, cls.state = FakeOperator(), StateEar()
        cls.hall = Hall('bot1', RADIUS_M)
        cls.client = actionlib.ActionClient('/mhri_tasks/run', RunTaskAction)
        cls.operator.check()

    def goes(self, x, y):
        """Send it to a place; return (state, sentence) of how that ended.

        Again where pictures came too late: on a busy machine that says nothing of the task.
        """
        self.assertTrue(self.client.wait_for_server(rospy.Duration(PATIENCE_S)))
        for _ in range(8):
            self.state.wait_robot('bot1', lambda gate: gate.topic and not gate.obeys and
                                  not gate.stands, 'the gate of bot1', PATIENCE_S)
            goal = self.client.send_goal(RunTaskGoal(
                'goto', ['bot1'], '{{x: {}, y: {}}}'.format(x, y)))
            wait_until(lambda: goal.get_comm_state() == actionlib.CommState.DONE,
                       'the task goes on', PATIENCE_S)
            robot = goal.get_result().robots[0]
            if robot.state != TaskState.LOST and 'has said nothing' not in robot.text:
                break
            print('again: {}'.format(robot.text))
        return robot.state, robot.text

    def test_it_reaches_a_goal_and_stops_before_a_wall_that_it_sees(self):
        ended = self.goes(*GOAL)
        self.assertEqual(ended[0], TaskState.DONE, ended)
        self.hall.rests()
        off_m = abs(self.hall.places.last() - GOAL[0])
        self.assertLess(off_m, 0.2)
        begun = time.monotonic()
        # Behind the wall.
        ended = self.goes(13.0, GOAL[1])
        self.assertEqual(ended[0], TaskState.BLOCKED, ended)
        self.hall.rests()
        least_m = self.hall.least_gap(begun)
        print('MEASURED by a depth camera alone: {:.3f} m off its goal; before a wall {:.3f} m: '
              '{}'.format(off_m, least_m, ended[1]))
        self.assertGreater(least_m, 0.0)


if __name__ == '__main__':
    rospy.init_node('depth_task_test')
    rostest.rosrun('mhri', 'depth_task', DepthTask)
