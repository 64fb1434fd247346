# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What robots on a task do: the real nodes, a simulated robot seen by motion capture, a turtle."""
import math
import os
import re
import sys
import tempfile
import time

import actionlib
from actionlib_msgs.msg import GoalID, GoalStatusArray
from geometry_msgs.msg import Point32, Pose2D
import rosbag
import rospkg
import rospy
from rosgraph_msgs.msg import Log

from mhri.base.geometry import Pose
from mhri.graph.ros.resources import read_text
from mhri.map.grid import grid_of
from mhri.map.ros.map_source import grid_message, publish_map
from mhri.msg import Places, TaskState
from support.node_tools import Process, Recorder
from support.own_node import own_node
from support.ros_system import insist, NotYet, wait_for
from support.tasks_case import task_tool, TasksCase, TIMEOUT_S

system = own_node('tasks', '../../e2e/tasks/tasks.launch')


class Tasks(TasksCase):

    def said_at_its_end(self, start):
        """Return what a program says that gives bot1 a task; it has to end well."""
        def in_time():
            # Away from everything.
            self.done('bot1', 'goto', '{x: 5.0, y: 2.0, speed: 0.6}')
            tool = start()
            self.addCleanup(tool.end)
            status, said = tool.wait(TIMEOUT_S), tool.said()
            if re.search('^bot1:? lost', said, re.M):
                raise NotYet(said)
            self.assertEqual(status, 0, said)
            return said
        return insist(in_time, 'the program to end its task')

    def test_the_terminal_drives_a_square_and_says_its_corners(self):
        said = self.said_at_its_end(lambda: task_tool('bot1', 'square', '0.4', 'speed=0.4'))
        for number in (1, 2, 3, 4):
            self.assertIn('bot1: corner {}:'.format(number), said)
        errors = re.search(r'by odometry ([\d.]+) m .* by motion capture ([\d.]+) m', said)
        self.assertLess(float(errors.group(1)), 0.1, said)
        self.assertLess(float(errors.group(2)), 0.2, said)

    def test_words_that_cannot_be_are_refused_by_name(self):
        tools = [(task_tool('bot1', 'goto', '1.0'), 'y:'), (task_tool('bot1', 'dance'), 'dance')]
        for tool, said in tools:
            self.addCleanup(tool.end)
            self.assertNotEqual(tool.wait(60.0), 0)
            self.assertIn(said, tool.said())
        begun = time.monotonic()
        ended = self.ends(self.start('bot1 bot9', 'goto', '{x: 9.0, y: 2.0}'))
        self.assertEqual([state for state, _ in ended], [TaskState.FAILED, TaskState.LOST])
        self.assertTrue(all('bot9' in text for _, text in ended), ended)
        self.commands['bot1'].wait_silence(0.6, 60.0)
        self.assertFalse(self.moves_since(begun), 'a good robot of a bad goal moved')
        goal = self.start('bot1', 'goto', '{x: 1, z: 1, y: 1}')
        wait_for(lambda: goal.get_comm_state() == actionlib.CommState.DONE,
                 what='not refused', timeout_s=30.0)
        self.assertIn('z:', goal.get_goal_status_text())

    def test_a_storm_of_cancels_is_neither_kept_nor_logged(self):
        cancels = rospy.Publisher('/mhri_tasks/run/cancel', GoalID, queue_size=1000)
        statuses = Recorder('/mhri_tasks/run/status', GoalStatusArray,
                            lambda message: [row.goal_id.id for row in message.status_list])
        logged = Recorder('/rosout', Log, lambda message: message.name)
        for recorder in (statuses, logged):
            self.addCleanup(recorder.close)
            recorder.wait_publisher()
        wait_for(cancels.get_num_connections, what='mhri_tasks does not listen', timeout_s=60.0)
        begun = time.monotonic()
        cancels.publish(GoalID(stamp=rospy.Time(4e9)))
        for number in range(300):
            cancels.publish(GoalID(id='none {}'.format(number)))
            cancels.publish(GoalID())
        cancels.publish(GoalID(id='last'))
        statuses.wait(lambda ids: 'last' in ids, begun)
        # Still heard, and one of the future refuses no goal.
        ended = self.ends(self.start('bot1', 'goto', '{x: 9.0, y: 2.0, timeout: 0.1}'))
        self.assertIn(ended[0][0], (TaskState.TIMEOUT, TaskState.LOST))
        self.assertLess(max(len(item.value) for item in statuses.since(begun)), 200)
        lines = [item for item in logged.since(begun) if item.value == '/mhri_tasks']
        self.assertLess(len(lines), 20)

    def test_a_team_does_one_task(self):
        self.done('bot1 pond', 'hold', '{seconds: 0.5}')

    def test_the_example_of_the_guide(self):
        path = os.path.join(rospkg.RosPack().get_path('mhri'), 'doc', 'guide', 'tasks.md')
        pattern = re.compile(r'```python\n(import actionlib\n.*?)```', re.S)
        example = pattern.search(read_text(path)).group(1)
        self.assertLessEqual(len(example.splitlines()), 12)
        self.assertIn('bot1 done', self.said_at_its_end(
            lambda: Process([sys.executable, '-c', example])))

    def test_a_robot_uses_its_accessories_on_its_way(self):
        def lamp():
            return next(state.choice for state in self.state.robot('bot1').accessories
                        if state.key == 'lamp')
        route = '{{route: [[{:.2f}, {:.2f}]], rounds: 1'.format(*self.place.last())
        for choice in ('on', 'off', 'on'):
            self.done('bot1', 'patrol', route + ', act: lamp {}}}'.format(choice))
            wait_for(lambda wanted=choice: lamp() == wanted, what='the lamp')
        for robot, task, parameters, words in (
                ('bot1', 'patrol', route + ', act: lamp up}', 'lamp'),
                ('bot3', 'goto', '{x: 1, y: 0, frame: odom, act: horn}', 'act')):
            (state, said), = self.ended(robot, task, parameters)
            self.assertEqual(state, TaskState.FAILED)
            self.assertIn(words, said)

    def test_a_drive_of_a_bag_is_replayed_within_015_m(self):
        self.done('bot1', 'goto', '{x: 3.0, y: 1.0, heading: 0.0, speed: 0.6}')
        begun = time.monotonic()
        self.done('bot1', 'patrol', '{route: [[3.8, 1.0], [4.2, 1.5]], rounds: 1, speed: 0.4}')
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = os.path.join(folder.name, 'drive.bag')
        with rosbag.Bag(path, 'w') as bag:
            for item in self.odometry.since(begun):
                bag.write('/bot1/odom', item.value, item.value.header.stamp)
        said = self.done('bot1', 'replay', '{{bag: {}, begin: there, speed: 0.4}}'.format(path))
        print('replay:', said)
        off = [float(most) for most in re.findall(r'([\d.]+) m at most', said)]
        self.assertEqual(len(off), 2, said)
        self.assertLess(max(off), 0.15, said)

    def test_marks_and_the_fence(self):
        self.assertTrue(self.set_mark('dock', True, Pose2D(3.2, 1.8, math.pi)).success)
        self.assertTrue(self.set_fence([Point32(x, y, 0.0) for x, y in (
            (2.4, 0.4), (4.8, 0.4), (4.8, 2.6), (2.4, 2.6))]).success)
        self.done('bot1', 'return', '{mark: dock, speed: 0.4}')
        self.place.wait(lambda where: math.dist(where, (3.2, 1.8)) < 0.2, time.monotonic())
        self.assertIn('dock', self.ended('bot1', 'return', '{mark: door}')[0][1])
        outside = self.ended('bot1', 'goto', '{x: 5.0, y: 1.8}')
        self.assertEqual(outside[0][0], TaskState.FAILED)
        self.assertIn('fence', outside[0][1])
        begun = time.monotonic()
        ended = self.ended('bot1', 'square', '{side: 3.0, speed: 0.4}')
        self.assertEqual(ended[0][0], TaskState.BLOCKED)
        self.assertIn('fence', ended[0][1])
        furthest = min(item.value[0] for item in self.place.since(begun))
        print('fence at 2.40 m: the middle of the robot came to {:.2f} m'.format(furthest))
        self.assertGreater(furthest, 2.4 + 0.15)
        unplaced = self.ended('pond', 'square', '{side: 1.0}')
        self.assertEqual(unplaced[0][0], TaskState.FAILED)
        self.assertIn('fence', unplaced[0][1])

    def test_the_end_of_the_floor_on_a_map_holds_a_robot(self):
        """What its laser does not see: cells that are not free, from 3.6 m on."""
        self.done('bot1', 'goto', '{x: 2.7, y: 1.8, speed: 0.4}')
        frames = Recorder('/mhri_tasks/places', Places, lambda message: message.header.frame_id)
        publisher = publish_map(grid_of(0.1, Pose(2.0, 0.0, 0.0), 30, 30, (
            [0] * 16 + [100] * 14) * 30))
        # A map of one free cell ends nowhere.
        everywhere = grid_of(0.1, Pose(2.0, 0.0, 0.0), 1, 1, [0])
        self.addCleanup(publisher.publish, grid_message(everywhere))
        wait_for(lambda: frames.last() == 'map', what='the map is not heard', timeout_s=60.0)
        begun, there = time.monotonic(), '{x: 4.2, y: 1.8, speed: 0.4, timeout: 8}'
        ended = self.ended('bot1', 'goto', there)
        self.assertIn(ended[0][0], (TaskState.BLOCKED, TaskState.TIMEOUT), ended)
        furthest = max(item.value[0] for item in self.place.since(begun))
        print('floor up to 3.60 m: {}; the middle of the robot came to {:.2f} m'.format(
            ended[0][1], furthest))
        self.assertLess(furthest, 3.6 - 0.15)
        # Without that map nothing is in its way.
        publisher.publish(grid_message(everywhere))
        self.done('bot1', 'goto', there)
