#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""More tasks by the real nodes: formation, replay, marks, fence, a map."""
import math
import os
import re
import tempfile
import time

import actionlib
from geometry_msgs.msg import Point32, Pose2D
import rosbag
import rospy
import rostest
from rostest_tools import Recorder, wait_until
from tasks_more_case import PATIENCE_S, TasksMoreCase

from mhri.base.mocap import Pose  # noqa: E402
from mhri.map.grid import grid_of  # noqa: E402
from mhri.map.ros.map_source import grid_message, publish_map  # noqa: E402
from mhri.msg import Places, TaskState  # noqa: E402


class TasksMore(TasksMoreCase):

    def test_a_formation_keeps_its_spacing_in_a_bend(self):
        for tries_left in reversed(range(8)):
            self.all_done(('bot1', 'goto', '{x: 3.0, y: 1.0, heading: 0.0, speed: 0.4}'),
                          ('bot2', 'goto', '{x: 2.2, y: 1.0, heading: 0.0, speed: 0.4}'))
            begun = time.monotonic()
            formed = self.start('bot2', 'formation', '{leader: bot1, shape: column, spacing: 0.8}')
            self.done('bot1', 'patrol', '{route: [[4.0, 1.0], [4.4, 1.4], [4.4, 1.8]], rounds: 1, '
                      'speed: 0.2}')
            wait_until(lambda: formed.get_comm_state() == actionlib.CommState.DONE or abs(
                self.gap() - 0.8) < 0.2, 'the spacing does not come back', PATIENCE_S)
            formed.cancel()
            ended = self.ends(formed)
            if not (tries_left and ended[0][0] == TaskState.LOST):
                break
        self.assertEqual(ended, [(TaskState.STOPPED, 'it was cancelled')])
        second = [item.value for item in self.places['bot2'].since(begun)]
        first = self.places['bot1'].since(begun)
        gaps = [math.dist(item.value, place) for item, place in zip(first, second)]
        print('formation: {:.2f} to {:.2f} m between the two'.format(min(gaps), max(gaps)))
        self.assertGreater(min(gaps), 0.45)

    def gap(self):
        """Return the way between the two robots [m]."""
        return math.dist(self.places['bot1'].last(), self.places['bot2'].last())

    def test_a_drive_of_a_bag_is_replayed_within_015_m(self):
        self.all_done(('bot1', 'goto', '{x: 3.0, y: 1.0, heading: 0.0, speed: 0.4}'),
                      ('bot2', 'goto', '{x: 2.0, y: 1.0, speed: 0.4}'))
        begun = time.monotonic()
        self.done('bot1', 'patrol', '{route: [[3.8, 1.0], [4.2, 1.5]], rounds: 1, speed: 0.4}')
        path = os.path.join(tempfile.mkdtemp(), 'drive.bag')
        with rosbag.Bag(path, 'w') as bag:
            for item in self.odometry.since(begun):
                bag.write('/bot1/odom', item.value, item.value.header.stamp)
        said = self.done('bot1', 'replay', '{{bag: {}, begin: there, speed: 0.4}}'.format(path))
        print('replay:', said)
        off = [float(most) for most in re.findall(r'([\d.]+) m at most', said)]
        self.assertEqual(len(off), 2, said)
        self.assertLess(max(off), 0.15, said)
        for words, why in (('{bag: /nowhere/x.bag}', 'cannot be read: No such file'),
                           ('{{bag: {}, topic: /odom}}'.format(path), 'topic could be: /bot1/odom'),
                           ('{seconds: 1, bag: ""}', '')):
            ended = self.ends(self.start('bot1', 'replay', words))
            self.assertIn(ended[0][0], (TaskState.FAILED, TaskState.DONE))
            self.assertIn(why, ended[0][1])

    def leave_room(self):
        """Bring bot2 away from where bot1 shall drive, if it is not."""
        if self.places['bot2'].last()[1] > 1.2:
            self.done('bot2', 'goto', '{x: 4.4, y: 1.0, speed: 0.4}')

    def test_marks_and_the_fence(self):
        self.leave_room()
        self.assertTrue(self.set_mark('dock', True, Pose2D(3.2, 1.8, math.pi)).success)
        self.assertTrue(self.set_fence([Point32(x, y, 0.0) for x, y in (
            (2.4, 0.4), (4.8, 0.4), (4.8, 2.6), (2.4, 2.6))]).success)
        self.done('bot1', 'return', '{mark: dock, speed: 0.4}')
        self.assertLess(math.dist(self.places['bot1'].last(), (3.2, 1.8)), 0.2)
        self.assertIn('there are: dock', self.ends(
            self.start('bot1', 'return', '{mark: door}'))[0][1])
        self.assertEqual(self.ends(self.start('bot1', 'goto', '{x: 5.0, y: 1.8}')), [
            (TaskState.FAILED, 'its goal lies outside of the fence')])
        begun = time.monotonic()
        ended = self.ended('bot1', 'square', '{side: 3.0, speed: 0.4}')
        self.assertEqual(ended, [(TaskState.BLOCKED, 'for 5 s: it is at the fence')])
        furthest = min(item.value[0] for item in self.places['bot1'].since(begun))
        print('fence at 2.40 m: the middle of the robot came to {:.2f} m'.format(furthest))
        self.assertGreater(furthest, 2.4 + 0.15)
        unplaced = self.ends(self.start('pond', 'square', '{side: 1.0}'))
        self.assertEqual(unplaced[0][0], TaskState.FAILED)
        self.assertIn('there is a fence, and ', unplaced[0][1])

    def test_the_end_of_the_floor_on_a_map_holds_a_robot(self):
        """What its laser does not see: cells that are not free, from 3.6 m on."""
        self.leave_room()
        self.done('bot1', 'goto', '{x: 2.7, y: 1.8, speed: 0.4}')
        frames = Recorder('/mhri_tasks/places', Places, lambda message: message.header.frame_id)
        publisher = publish_map(grid_of(0.1, Pose(2.0, 0.0, 0.0), 30, 30, (
            [0] * 16 + [100] * 14) * 30))
        # A map of one free cell ends nowhere.
        everywhere = grid_of(0.1, Pose(2.0, 0.0, 0.0), 1, 1, [0])
        self.addCleanup(publisher.publish, grid_message(everywhere))
        wait_until(lambda: frames.last() == 'map', 'the map is not heard', 60.0)
        begun, there = time.monotonic(), '{x: 4.2, y: 1.8, speed: 0.4, timeout: 12}'
        ended = self.ended('bot1', 'goto', there)
        self.assertIn(ended[0][0], (TaskState.BLOCKED, TaskState.TIMEOUT), ended)
        furthest = max(item.value[0] for item in self.places['bot1'].since(begun))
        print('floor up to 3.60 m: {}; the middle of the robot came to {:.2f} m'.format(
            ended[0][1], furthest))
        self.assertLess(furthest, 3.6 - 0.15)
        # Without that map nothing is in its way.
        publisher.publish(grid_message(everywhere))
        wait_until(lambda: self.ended('bot1', 'goto', there)[0][0] == TaskState.DONE,
                   'the map holds it still', PATIENCE_S)


if __name__ == '__main__':
    rospy.init_node('tasks_more_test')
    rostest.rosrun('mhri', 'tasks_more', TasksMore)
