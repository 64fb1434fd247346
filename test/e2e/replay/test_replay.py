# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A session replayed: what a screen shows at any moment is what was recorded, and nothing drives.

The player is a process of its own on a real master; the screen's ROS side is in this one.
"""
import os
import random
import shutil
import subprocess
import tempfile
import unittest

import roslib.packages
import rosgraph
import rospy
from std_srvs.srv import SetBool

from mhri.base.views import LIVE, SILENT
from mhri.replay.ros.replay_backend import ReplayBackend
from mhri.session.foreign import VELOCITY_TYPES
from support import graph
from support import made_session as made
from support.own_node import own_node
from support.ros_system import insist, wait_for
from support.node_tools import Process

system = own_node('replay')

TIMEOUT_S = 60.0
MOMENTS = 10
# So near to a change [s] a moment is not asked for: what holds there is a matter of milliseconds.
NEAR_S = 0.25
REPLAY = roslib.packages.find_node('mhri', 'mhri_replay')[0]


def changes():
    """Return when anything of the session changes [s]."""
    found = [since for rows in (made.MODES, made.SELECTED, made.STOPPED) for since, _ in rows]
    begun, ended = made.LOST_S
    # A robot is silent a second after its last word.
    return found + [begun, begun + 0.5, begun + 1.0, begun + 1.4, ended]


def moments():
    """Return random times of the session, and some where much was so at once."""
    chance = random.Random(14)
    found = [33.0, 45.0, 14.0]
    while len(found) < MOMENTS:
        time_s = chance.uniform(1.0, made.LENGTH_S - 1.0)
        if all(abs(time_s - since) > NEAR_S for since in changes()):
            found.append(time_s)
    return found


def recorded(time_s):
    """Return what was so: mode, selection, stop, and of each robot link, place, what it obeys."""
    selected, stopped = made.at(made.SELECTED, time_s), made.at(made.STOPPED, time_s)
    robots = {}
    for name in made.ROBOTS:
        silent = name == 'bot2' and made.LOST_S[0] + 1.0 < time_s < made.LOST_S[1]
        heard_s = made.LOST_S[0] - 0.1 if silent else int(10 * time_s + 1e-6) / 10
        x_m, y_m, _ = made.pose(name, heard_s)
        robots[name] = (SILENT if silent else LIVE, round(x_m, 3), round(y_m, 3),
                        name in selected, made.obeyed(name, time_s),
                        name in selected and not stopped)
    return made.at(made.MODES, time_s), stopped, robots


def shown(view):
    """Return the same of a :class:`ScreenView`."""
    return view.mode, view.stop_all, {robot.name: (
        robot.link, robot.x_m and round(robot.x_m, 3), robot.y_m and round(robot.y_m, 3),
        robot.selected, robot.obeys, robot.driven) for robot in view.robots}


class ReplayTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.mkdtemp(prefix='mhri_replay_')
        cls.folder = made.write_session(os.path.join(cls.home, 'session'))
        cls.player = Process([REPLAY, str(cls.folder)])
        cls.screen = ReplayBackend()
        cls.screen.start()
        wait_for(cls.has_robots, TIMEOUT_S, 'the robots')
        cls.screen.control('pause')

    @classmethod
    def tearDownClass(cls):
        cls.screen.close()
        cls.player.end()
        shutil.rmtree(cls.home)

    @classmethod
    def has_robots(cls):
        """Add the robots that the player has named, as the screen's host does."""
        for kind, value in cls.screen.take_events():
            if kind == 'found':
                for robot in value.live:
                    cls.screen.add(robot.name, value.facts[robot.name])
        robots = cls.screen.view().robots
        return cls.screen.replay() is not None and len(robots) == len(made.ROBOTS) and all(
            robot.type_label for robot in robots)

    def seek(self, time_s):
        """Go to a moment of the session, and wait until the player is there."""
        jumps = self.screen.replay().jumps
        self.screen.control('seek', time_s)
        wait_for(lambda: self.screen.replay().jumps > jumps and self.screen.replay().settled,
                 TIMEOUT_S, 'the player to be at {}'.format(time_s))

    def comes_to(self, time_s, condition):
        """Go to a moment of the session until a condition comes true soon."""
        def there():
            self.seek(time_s)
            return wait_for(condition, 5.0, 'the screen to show it')
        insist(there, lambda: 'the screen to show {} s: {}'.format(
            time_s, shown(self.screen.view())))

    def test_at_any_moment_it_shows_what_was_recorded(self):
        self.screen.control('pause')
        for time_s in moments():
            self.comes_to(time_s, lambda: shown(self.screen.view()) == recorded(time_s))
            self.assertAlmostEqual(self.screen.replay().position_s, time_s, 2)
            self.assertAlmostEqual(self.screen.clock.wall(), made.STARTED + time_s, 2)

    def test_a_silent_robot_is_as_old_as_it_was_wherever_one_comes_from(self):
        self.screen.control('pause')
        for time_s in (45.0, 47.0, 43.0, 14.0, 46.0):
            lost = made.LOST_S[0] < time_s
            age_s = time_s - (made.LOST_S[0] - 0.1) if lost else 0.0
            self.comes_to(time_s, lambda: abs(self.robot('bot2').age_s - age_s) < 0.15)
            self.assertIn('{:.1f} s'.format(age_s) if lost else '', self.robot('bot2').note)

    def robot(self, name):
        return next(robot for robot in self.screen.view().robots if robot.name == name)

    def test_the_requested_velocity_is_shown_though_it_is_not_replayed(self):
        self.screen.control('pause')
        for time_s, asked in ((10.0, (made.ASKED_MPS, 0.0, 0.0)), (33.0, (0.0, 0.0, 0.0))):
            self.seek(time_s)
            wait_for(lambda: self.screen.view().asked == asked, TIMEOUT_S,
                     lambda: 'asked for {}'.format(self.screen.view().asked))

    def test_it_plays_at_the_speed_asked_for_to_the_end(self):
        self.seek(50.0)
        self.screen.control('speed', 8.0)
        self.screen.control('play')
        wait_for(lambda: [now for now in [self.screen.replay()] if not now.playing and abs(
            now.position_s - now.length_s) < 1e-3], TIMEOUT_S, 'the end')
        self.assertEqual(self.screen.replay().speed, 8.0)
        self.screen.control('speed', 1.0)

    def test_no_velocity_topic_exists(self):
        """Neither the player nor the screen has one, though the bags have many."""
        self.seek(10.0)
        master = rosgraph.Master('/replay_test')
        published = {name for name, _ in master.getSystemState()[0]}
        types = dict(master.getTopicTypes())
        self.assertLessEqual({'/bot1/odom', graph.DRIVE_STATE, graph.MODE}, published)
        self.assertEqual([name for name in published if types.get(name) in VELOCITY_TYPES], [])
        self.assertEqual([name for name in published if 'cmd_vel' in name], [])
        self.assertNotIn('/bot1/lamp', published)

    def test_accessories_and_sensors_are_seen_as_they_were(self):
        for at_s, state, value in ((10.0, 'off', 12.0), (25.0, 'on', 60.0)):
            self.seek(at_s)
            wait_for(lambda: [(one.choice, one.value) for one in self.robot(
                'bot1').accessories] == [(state, ()), ('', (value,))], TIMEOUT_S, 'the states')

    def test_whatever_asks_it_to_drive_is_refused(self):
        self.screen.stop_all()
        self.screen.select(['bot1'])
        answer = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)(True)
        self.assertFalse(answer.success)

    def test_a_wrong_request_is_answered(self):
        self.screen.control('dance')
        said = []
        wait_for(lambda: said.extend(self.screen.take_events()) or any(
            'dance' in str(event) for event in said), TIMEOUT_S, 'the answer')

    def test_it_refuses_a_master_on_which_mhri_drives(self):
        """The first player serves what a mux serves."""
        done = subprocess.run([REPLAY, str(self.folder), '__name:=second'],
                              stderr=subprocess.PIPE, timeout=TIMEOUT_S)
        self.assertEqual(done.returncode, 1)

    def test_a_broken_bag_is_refused_by_name(self):
        path = os.path.join(self.home, 'broken.bag')
        with open(path, 'wb') as stream:
            stream.write(b'no bag')
        done = subprocess.run([REPLAY, path], stderr=subprocess.PIPE, timeout=TIMEOUT_S)
        self.assertEqual(done.returncode, 1)
        self.assertIn(path.encode(), done.stderr)
