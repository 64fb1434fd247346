# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the map with what feeds it and with what is done on it.

Everything here runs on the GUI thread; while nobody can see the map nothing is listened to for it
and nothing is drawn.
"""
import math
import queue
import threading
import time

import numpy as np
from python_qt_binding.QtCore import QObject, QTimer

from mhri.base.mocap import Pose
from mhri.base.tf_tree import OdometryFrames
from mhri.base.views import LIVE, PanelView
from mhri.events.events import CALM, KINDS
from mhri.map.gui.map_pane import MapPane
from mhri.map.met import Met
from mhri.map.places import composed
from mhri.map.ros.map_feed import MapFeed, MapScans
from mhri.map.ros.places_client import PlacesClient
from mhri.map.scene import goals_of, in_frame, map_robot, own_pose, Scene
from mhri.map.spread import has_room, spread
from mhri.map.track import Track
from mhri.map.trail import link_grade, Trail
from mhri.screen.gui.stage import MAP_BESIDE, MAP_CLOSED, MAP_LARGE
from mhri.screen.presenters.draw_guard import DrawGuard
from mhri.sensors.gui.scan_view import scan_points

DRAW_MS = 100
NO_TASKS = 'the task service is not there'
_RADIUS_M = 0.25


class MapHost(QObject):
    """The map of one screen.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param tasks: starts and ends tasks: has ``start(key, robots, parameters)``, of a dict, and
        ``stop(robots)``; None for nobody
    :param places: :class:`mhri.map.ros.places_client.PlacesClient`
    :param clock: seconds, monotonic
    """

    def __init__(self, operator, screen, tasks=None, places=None,
                 clock=time.monotonic):
        super().__init__(screen)
        self._operator = operator
        self._screen = screen
        self._tasks = tasks
        self._clock = clock
        self.pane = MapPane(screen.stage)
        self._guard = DrawGuard(self.pane)
        self._view = PanelView()
        self._trails = {}
        self._met = {}
        self._tracks = {}
        self._answers = queue.Queue()
        self._map = MapFeed()
        self._scans = MapScans(operator.do)
        self._places = places or PlacesClient()
        self._watched = False
        self._grid = None
        self._timer = QTimer(self)
        self._timer.setInterval(DRAW_MS)
        screen.stage.set_map(self.pane)
        self._connect()

    def _connect(self):
        """Wire what is done on the map, and the keys."""
        pane = self.pane
        pane.goal_drawn.connect(self._go)
        pane.route_drawn.connect(lambda robots, corners: self._start(
            'patrol', robots, {'route': [_rounded(*corner) for corner in corners]},
            'along a route of {}'.format(len(corners))))
        pane.leader_chosen.connect(lambda robots, leader: self._start(
            'follow', robots, {'leader': leader}, 'after ' + leader))
        pane.end_requested.connect(self._end)
        pane.fence_drawn.connect(lambda corners: self._ask(
            'the fence', self._places.set_fence, corners))
        pane.robot_placed.connect(lambda robot, pose: self._ask(
            robot, self._places.set_place, robot, pose))
        pane.fit_requested.connect(lambda robot, other: self._ask(
            robot, self._places.fit_place, robot, other))
        pane.mark_set.connect(lambda name, pose: self._ask(
            name, self._places.set_mark, name, pose))
        pane.look_requested.connect(self._screen.look_at)
        self._screen.drive_keys.command_pressed.connect(self._on_command)
        self._timer.timeout.connect(lambda: self._guard.run(self.draw))
        self._timer.start()

    def _on_command(self, command):
        """Do what a key of the map says."""
        if command == 'map':
            self._screen.stage.swap_map()
        elif command == 'closer':
            self.pane.view.zoom(1)
        elif command == 'wider':
            self.pane.view.zoom(-1)

    # What is shown.

    def show_view(self, view):
        """Take note of the newest :class:`PanelView`; :meth:`draw` draws it."""
        self._view = view
        if self._watched:
            now = self._clock()
            for robot in view.robots:
                pose = own_pose(robot)
                if pose is not None and robot.age_s is not None:
                    self._tracks.setdefault(robot.name, Track()).add(now - robot.age_s, pose)

    def draw(self):
        """Draw the map, if anybody can see it."""
        watched = self.pane.is_watched()
        if watched != self._watched:
            self._watched = watched
            self._operator.do(self._open if watched else self._map.close)
        if not watched:
            self._scans.want({})
            self._met.clear()
            self._tracks.clear()
            return
        now = self._clock()
        places, looked_at = self._places.view(), self._looked_at()
        robots = [self._robot(view, places, looked_at, now) for view in self._view.robots]
        self._scans.want({robot.name: self._type(robot.name) for robot in robots
                          if robot.pose is not None})
        grid = self._map.take()
        if grid is not None:
            self._grid = grid
            self.pane.view.show_grid(grid)
        goals, leaders = goals_of(self._places.runs())
        self.pane.show_scene(Scene(places.frame, tuple(robots), goals, leaders, places.marks,
                                   places.fence, places.answers))
        while not self._answers.empty():
            self.pane.show_answer(*self._answers.get())

    def _open(self):
        """Begin to listen (blocking, on the worker)."""
        self._places.open()
        self._map.open()

    def _looked_at(self):
        stage = self._screen.stage
        return stage.looked_at or next(iter(stage.large), '')

    def _type(self, name):
        """Return the :class:`RobotType` of a robot, None while it is not known."""
        feeds = self._operator.feeds(name)
        return feeds.robot_type if feeds is not None else None

    def _robot(self, view, places, looked_at, now):
        """Return a robot as the map draws it; its trail grows."""
        kind = self._type(view.name)
        robot = map_robot(view, places.robots.get(view.name), kind.radius_m if kind else _RADIUS_M,
                          view.name == looked_at)
        if robot.pose is None:
            return robot
        trail = self._trails.setdefault(view.name, Trail())
        if view.link == LIVE:
            trail.add(robot.pose, link_grade(view.figures, True), now)
        return map_robot(view, places.robots.get(view.name), robot.radius_m, robot.looked_at,
                         trail, self._points(view.name, robot.pose,
                                             places.robots[view.name].origin, now))

    def _points(self, name, pose, origin, now):
        """Return what a robot's lasers have met (n, 2) [m], from where it was then.

        :param pose: where it is now, like ``origin`` of its odometry in the frame
        """
        feeds = self._operator.feeds(name)
        met, track = self._met.setdefault(name, Met()), self._tracks.get(name)
        for laser, (scan, age_s, (mount, turned_over)) in self._scans.take(
                name, feeds.frames if feeds is not None else OdometryFrames()).items():
            ahead, left, _ = scan_points(*scan[:3])
            seen = in_frame(mount, np.column_stack((ahead, -left if turned_over else left)))
            then = track.at(now - age_s) if track is not None else None
            met.see(laser, in_frame(pose if then is None else composed(origin, then), seen), now)
        return met.points(now)

    # What is done.

    def _go(self, names, pose, aimed):
        """Send robots to a place; several stand side by side there."""
        scene = self.pane.view.scene
        robots = {name: scene.robot(name) for name in names}
        robots = {name: robot for name, robot in robots.items() if robot is not None}
        poses = {name: robot.pose for name, robot in robots.items()}
        if not poses:
            self.pane.show_answer('nobody is sent: those robots are off the list', False)
            return
        if not aimed:
            pose = _away(pose, [there for there in poses.values() if there is not None])
        radius_m, grid = max(robot.radius_m for robot in robots.values()), self._grid
        goals = spread(pose, poses, radius_m, lambda x_m, y_m: grid is None or has_room(
            grid, x_m, y_m, radius_m))
        for name, goal in goals.items():
            x_m, y_m = _rounded(goal.x_m, goal.y_m)
            self._start('goto', [name], {'x': x_m, 'y': y_m, **(
                {'heading': round(goal.heading_rad, 4)} if aimed else {})},
                'to x {:.2f} m, y {:.2f} m'.format(x_m, y_m), len(goals) > 1)
        left = [name for name in poses if name not in goals]
        if left:
            self.pane.show_answer('{}no room there for {}'.format(
                self.pane.line.text() + '; ' if goals else '', ' and '.join(left)), False)

    def _start(self, key, robots, parameters, words, more=False):
        """Start a task; its answer comes from whoever runs it."""
        text = '{}: asked to go {}'.format(' and '.join(robots), words)
        if self._tasks is None:
            self.pane.show_answer('not started: ' + NO_TASKS, False)
            return
        before = self.pane.line.text() if more else ''
        self.pane.show_answer('; '.join(filter(None, (
            before if 'asked to go' in before else '', text))))
        self._tasks.start(key, robots, parameters)

    def hear(self, kind, text, robot):
        """Show what has become of a task; what it says on its way is for the events.

        :param kind: a key of :data:`mhri.events.events.KINDS`
        """
        if kind != 'task.said':
            self.pane.show_answer(': '.join(filter(None, (robot, text))), KINDS[kind][0] == CALM)

    def _end(self, robots):
        """End the tasks of robots."""
        if self._tasks is not None:
            self._tasks.stop(robots)
            self.pane.show_answer('{}: asked to end the task'.format(' and '.join(robots)))

    def _ask(self, what, call, *words):
        """Ask the task service for something about a robot, a mark or the fence."""
        self.pane.show_answer('{}: asked'.format(what))
        call(*words, lambda done, text: self._answers.put((
            '{}: {}{}'.format(what, '' if done else 'refused: ',
                              text or ('done' if done else 'no reason given')), done)))

    # Settings, end.

    def save_settings(self):
        """Return what is kept between runs: JSON values."""
        return {'shown': self._screen.stage.map_state, **self.pane.save_settings()}

    def restore_settings(self, settings):
        """Take back a dict of :meth:`save_settings`, even if parts are missing."""
        self.pane.restore_settings(settings)
        if settings.get('shown') in (MAP_BESIDE, MAP_LARGE):
            self._screen.stage.show_map(settings['shown'])
        else:
            self._screen.stage.show_map(MAP_CLOSED)

    def close(self, forget=False):
        """Draw no more; returns at once. ``forget`` as in the backend."""
        self._timer.stop()
        self._guard.end()
        self._places.close(forget)
        if forget:
            threading.Thread(target=self._forget, name='forget_map', daemon=True).start()

    def _forget(self):
        """Unregister every topic (blocking)."""
        for end in (self._scans.close, self._map.close):
            end()


def _rounded(x_m, y_m):
    """Return a place to the millimetre, as numbers that YAML writes short."""
    return [round(x_m, 3), round(y_m, 3)]


def _away(pose, poses):
    """Return a pose that looks away from where robots come from."""
    if not poses:
        return pose
    ahead = pose.x_m - sum(there.x_m for there in poses) / len(poses)
    left = pose.y_m - sum(there.y_m for there in poses) / len(poses)
    return Pose(pose.x_m, pose.y_m, math.atan2(left, ahead))
