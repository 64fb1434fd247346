# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robots on a task: the real nodes, a simulated robot seen by motion capture, what ends a task.

What is timed here is timed as the robot hears it.
"""
import contextlib
import math
import signal
import time

import actionlib
import psutil

from mhri.msg import TaskState
from support.fake_mux import FakeOperator
from support.node_tools import measured, moves, rests
from support.own_node import own_node
from support.ros_system import insist, NotYet, processes_with, wait_for
from support.tasks_case import task_tool, TasksCase

system = own_node('tasks', 'tasks.launch')


class Tasks(TasksCase):

    def far_x(self):
        """Return one end of a long way, as a word: that which is farther off."""
        return '9.0' if self.place.last()[0] < 6.0 else '2.0'

    def on_its_way(self):
        """Start a robot on a long way and wait until it moves; return (goal, since when)."""
        def moves_on():
            begun = time.monotonic()
            goal = self.start('bot1', 'goto', '{{x: {}, y: 2.0}}'.format(self.far_x()))
            wait_for(lambda: goal.get_comm_state() == actionlib.CommState.DONE
                     or self.moves_since(begun), what='it neither moves nor ends')
            if goal.get_comm_state() != actionlib.CommState.DONE:
                return goal, begun
            ended = self.ends(goal)
            self.assertEqual(ended[0][0], TaskState.LOST, ended)
            raise NotYet(str(ended))
        return insist(moves_on, 'it to move')

    def rests_for_good(self, robot, since):
        """Wait for silence after a zero; return how long after a time its last zeros began [s].

        A robot whose laser was late has got zeros before.
        """
        self.commands[robot].wait(rests, since, 30.0)
        self.commands[robot].wait_silence(0.6, 60.0)
        noted = self.commands[robot].since(since)
        moved = [place for place, item in enumerate(noted) if moves(item.value)]
        last = noted[moved[-1] + 1:] if moved else noted
        self.assertTrue(last, 'its last command is no zero')
        return last[0].at - since

    def test_a_robot_goes_where_it_is_sent(self):
        x = 3.0 if self.place.last()[0] > 4.0 else 5.0
        begun = time.monotonic()
        self.done('bot1', 'goto', '{{x: {}, y: 1.5, speed: 0.6}}'.format(x))
        self.place.wait(lambda where: math.dist(where, (x, 1.5)) < 0.2, begun)

    def test_ctrl_c_stops_the_robot(self):
        def on_its_way():
            begun = time.monotonic()
            tool = task_tool('bot1', 'goto', self.far_x(), 'y=2.0')
            self.addCleanup(tool.end)
            wait_for(lambda: not tool.running() or self.moves_since(begun),
                     what=lambda: 'it to move: ' + tool.said())
            return 'bot1: lost: ' not in tool.said() and tool
        tool = insist(on_its_way, 'the terminal to drive it')
        ended = tool.send(signal.SIGINT)
        self.assertEqual(tool.wait(), 1)
        self.assertIn('bot1: stopped', tool.said())
        self.rests_for_good('bot1', ended)

    def test_stop_all_ends_every_task_and_nothing_resumes(self):
        goal, _ = self.on_its_way()
        stopped = time.monotonic()
        self.assertTrue(self.set_stop(True).success)
        measured('stop-all, first zero', self.rests_for_good('bot1', stopped))
        self.assertEqual(self.ends(goal)[0][0], TaskState.STOPPED)
        released = time.monotonic()
        wait_for(lambda: self.set_stop(False).success, what='not released', timeout_s=30.0)
        self.commands['bot1'].wait_silence(0.6, 30.0)
        self.assertFalse(self.moves_since(released))
        wait_for(lambda: not self.lists.last().runs, what='the list has it still', timeout_s=30.0)

    def test_checking_a_robot_takes_it_over(self):
        goal, _ = self.on_its_way()
        checked = self.operator.check('bot1')
        self.assertEqual(self.ends(goal)[0][0], TaskState.TAKEN_OVER)
        self.rests_for_good('bot1', checked)
        self.assertEqual(self.ends(self.start('bot1', 'hold', ''))[0][0], TaskState.TAKEN_OVER)

    def test_an_operator_who_falls_silent_or_goes_leaves_no_robot_moving(self):
        """The lease holds for tasks, too: nobody at the screen could stop them."""
        for way, promised_s in (('silent', 2.0), ('gone', 1.0)):
            goal, _ = self.on_its_way()
            lost = self.operator.fall_silent()
            if way == 'gone':
                self.operator.leave()
            measured('operator {} during a task, first zero'.format(way),
                     self.rests_for_good('bot1', lost), promised_s)
            self.assertEqual(self.ends(goal)[0][0], TaskState.LOST)
            type(self).operator = FakeOperator() if way == 'gone' else self.operator
            self.operator.check()

    def test_killed_it_leaves_zeros_and_comes_back_with_nothing_to_do(self):
        self.on_its_way()
        processes = processes_with('__name:=mhri_tasks')
        killed = time.monotonic()
        for one in processes:
            with contextlib.suppress(psutil.NoSuchProcess):
                one.kill()
        measured('mhri_tasks killed, first zero', self.rests_for_good('bot1', killed), 2.0)
        wait_for(lambda: self.lists.since(killed) and not self.lists.last().runs,
                 what='mhri_tasks does not come back', timeout_s=60.0)
        self.rests_for_good('bot1', killed)
