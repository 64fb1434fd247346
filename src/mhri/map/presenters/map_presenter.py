# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the map widget with its data and its actions.

Everything here runs on the GUI thread; while the map is hidden nothing is subscribed for it and
nothing is drawn.
"""
from dataclasses import replace
from functools import partial
import math
import queue
import threading
import time

import numpy as np
from python_qt_binding.QtCore import QObject, QTimer

from mhri.base.geometry import composed, out_of, Pose
from mhri.base.part import Part
from mhri.base.views import GONE, LIVE, ScreenView, SILENT
from mhri.driving.gui import robot_menu
from mhri.events.events import CALM, KINDS
from mhri.map import gesture
from mhri.map.gui.map_menu import robot_rows
from mhri.map.gui.map_pane import MapPane
from mhri.map.last_place import LastPlaces
from mhri.map.ros.map_source import map_stream
from mhri.map.ros.places_client import PlacesClient
from mhri.map.scan_memory import ScanMemory
from mhri.map.scene import goals_of, map_robot, own_pose, Scene
from mhri.map.spread import has_room, spread
from mhri.map.track import Track
from mhri.map.trail import link_grade, Trail
from mhri.robots.ros.bot_feeds import MAP_SCAN
from mhri.sensors.gui.scan_view import scan_points

DRAW_MS = 100
NO_TASKS, SILENT_TEXT = 'the task service is not there', 'nothing comes from {}'
_RADIUS_M = 0.25
# The tool that draws the places of a task.
_TOOL_OF = {'goto': gesture.GOTO, 'patrol': gesture.ROUTE, 'follow': gesture.LEADER}


class MapPresenter(QObject, Part):
    """The map of one screen.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param tasks: starts and ends tasks with ``start_task(key, robots, parameters)``, parameters a
        dict, and ``stop(robots)``; ``offer_places(keys, pick)`` offers the map for the places of a
        new task; None: tasks are unavailable
    :param guard: function of a widget: see :class:`mhri.base.part.ScreenContext`
    :param places: :class:`mhri.map.ros.places_client.PlacesClient`
    :param clocks: functions that return monotonic time and time of day [s]
    """

    @classmethod
    def of(cls, context):
        """Return it for a screen: see :class:`mhri.base.part.Part`."""
        return cls(context.backend, context.screen, context.parts.get('tasks'), context.guard,
                   clocks=(time.monotonic, context.backend.wall))

    def __init__(self, operator, screen, tasks, guard, places=None,
                 clocks=(time.monotonic, time.time)):
        super().__init__(screen)
        self._operator = operator
        self._screen = screen
        self._tasks = tasks
        self._clock, self._wall = clocks
        self.pane = MapPane(screen.stage)
        self._guard = guard(self.pane)
        self._view = ScreenView()
        self._trails = {}
        self._scans = {}
        self._tracks = {}
        self._last = LastPlaces()
        # {robot: its pose on the map, None if not placed}, also while the map is hidden.
        self._poses = {}
        self._placing = False
        # What the stage showed before the map was enlarged to pick a place, None otherwise.
        self._before_pick = None
        self._answers = queue.Queue()
        self._map = map_stream()
        self._places = places or PlacesClient()
        self._watched = False
        self._grid = None
        self._timer = QTimer(self, interval=DRAW_MS)
        screen.stage.set_map(self.pane)
        self._connect()

    def _connect(self):
        """Connect the signals of the map, and the keys."""
        pane = self.pane
        pane.goal_drawn.connect(self._go)
        pane.route_drawn.connect(lambda robots, corners: self._start(
            'patrol', robots,
            {**pane.given, 'route': [_rounded(*corner) for corner in corners]},
            'along a route of {}'.format(len(corners))))
        pane.leader_chosen.connect(
            lambda robots, leader: self._follow(robots, leader, pane.given))
        pane.fence_drawn.connect(lambda corners: self._ask(
            'the fence', self._places.set_fence, corners))
        pane.robot_placed.connect(self._place)
        pane.fit_requested.connect(lambda robot, other: self._ask(
            robot, self._places.fit_place, robot, other))
        pane.mark_set.connect(lambda name, pose: self._ask(
            name, self._places.set_mark, name, pose))
        pane.look_requested.connect(self._screen.look_at)
        pane.done.connect(self._end_pick)
        pane.robot_menu_requested.connect(self._screen.robot_menu.open)
        for group, rows in ((robot_menu.SEND, self._send_rows),
                            (robot_menu.FOLLOW, self._follow_rows),
                            (robot_menu.PLACE, self._place_rows),
                            (robot_menu.OTHERS, self._rows_of_others)):
            self._screen.robot_menu.offer(group, rows)
        if self._tasks is not None:
            self._tasks.offer_places(tuple(_TOOL_OF), lambda key, robots, given: self._pick(
                _TOOL_OF[key], tuple(robots), given))
        self._screen.drive_keys.command_pressed.connect(self._on_command)
        self._timer.timeout.connect(lambda: self._guard.run(self.draw))
        self._timer.start()

    def _on_command(self, command):
        """Handle a key of the map."""
        if command == 'map':
            self._screen.stage.swap_map()
        elif command == 'closer':
            self.pane.view.zoom(1)
        elif command == 'wider':
            self.pane.view.zoom(-1)

    # Showing.

    def show_view(self, view):
        """Store the newest :class:`ScreenView`; :meth:`draw` draws it."""
        self._view = view
        if self._watched:
            now = self._clock()
            for robot in view.robots:
                pose = own_pose(robot)
                if pose is not None and robot.age_s is not None:
                    self._tracks.setdefault(robot.name, Track()).add(now - robot.age_s, pose)

    def draw(self):
        """Draw the map if it is visible."""
        watched = self.pane.is_watched()
        if watched != self._watched:
            self._watched = watched
            self._operator.do(self._open if watched else self._map.close)
        now = self._clock()
        places, looked_at = self._places.view(), self._looked_at()
        self._forget({robot.name for robot in self._view.robots})
        robots = [self._robot(view, places, looked_at, now) for view in self._view.robots]
        self._poses = {robot.name: robot.pose for robot in robots}
        if not watched:
            self._request_scans(())
            self._scans.clear()
            self._tracks.clear()
            return
        robots = [self._with_scan(robot, places, now) for robot in robots]
        self._request_scans({robot.name for robot in robots if robot.pose is not None})
        newest = self._map.take()
        if newest is not None:
            self._grid = newest.value
            self.pane.view.show_grid(self._grid)
        goals, leaders = goals_of(self._places.runs())
        # Those of robots that were not placed are in no frame of the map.
        flags = tuple(flag for flag in self._view.flags if flag.frame == places.frame)
        self.pane.show_scene(Scene(places.frame, tuple(robots), goals, leaders, places.marks,
                                   places.fence, places.answers, flags))
        while not self._answers.empty():
            self.pane.show_answer(*self._answers.get())

    def place_of(self, name):
        """Return (pose of a robot on the map, age of what that rests on [s]), None if unknown.

        It makes sure that the places are subscribed, as for a map that is visible.
        """
        if not self._placing:
            self._placing = True
            self._operator.do(self._places.open)
        placing = self._places.view().robots.get(name)
        return self._poses.get(name), placing.age_s if placing is not None else None

    def _request_scans(self, names):
        """Subscribe the lasers of these robots only."""
        for robot in self._view.robots:
            feeds = self._operator.feeds(robot.name)
            if feeds is not None:
                feeds.request({MAP_SCAN} if robot.name in names else (), 'map')

    def _open(self):
        """Subscribe (blocking, on the worker)."""
        self._places.open()
        self._map.open()

    def _looked_at(self):
        stage = self._screen.stage
        return stage.looked_at or next(iter(stage.large), '')

    def _type(self, name):
        """Return the :class:`RobotType` of a robot, None while unknown."""
        feeds = self._operator.feeds(name)
        return feeds.robot_type if feeds is not None else None

    def _robot(self, view, places, looked_at, now):
        """Return a robot as drawn on the map without its scan, and extend its trail.

        Also while the map is hidden: a robot that is lost then is where it was.
        """
        kind = self._type(view.name)
        robot = map_robot(view, places.robots.get(view.name), kind.radius_m if kind else _RADIUS_M,
                          view.name == looked_at)
        robot = self._last.update(robot, view, self._wall())
        if robot.pose is None:
            return robot
        trail = self._trails.setdefault(view.name, Trail())
        if view.link == LIVE:
            trail.add(robot.pose, link_grade(view.figures, True), now)
        return replace(robot, trail=trail)

    def _with_scan(self, robot, places, now):
        """Return a robot with its laser points, if it is live and placed."""
        placing = places.robots.get(robot.name)
        if robot.pose is None or robot.trouble or placing is None or placing.origin is None:
            return robot
        return replace(robot, points=self._points(robot.name, robot.pose, placing.origin, now))

    def _forget(self, names):
        """Forget the robots that were removed from the list."""
        self._last.keep(names)
        for name in set(self._trails).difference(names):
            del self._trails[name]

    def _points(self, name, pose, origin, now):
        """Return the laser points of a robot (n, 2) [m], from its pose at the time of the scan.

        :param pose: its present pose, like ``origin`` of its odometry in the frame
        """
        feeds = self._operator.feeds(name)
        lasers = feeds.get(MAP_SCAN) if feeds is not None else None
        memory, track = self._scans.setdefault(name, ScanMemory()), self._tracks.get(name)
        for laser, (scan, age_s, (mount, turned_over)) in (
                lasers.each(feeds.frames) if lasers is not None else {}).items():
            ahead, left, _ = scan_points(*scan[:3])
            seen = out_of(mount, np.column_stack((ahead, -left if turned_over else left)))
            then = track.at(now - age_s) if track is not None else None
            memory.add(laser, out_of(pose if then is None else composed(origin, then), seen), now)
        return memory.points(now)

    # Actions.

    def _send_rows(self, robot, others):
        """Return the row that sends a robot."""
        return [] if robot.link in (SILENT, GONE) else [
            ('Send ' + robot_menu.clicked(robot, others),
             partial(self._pick, gesture.GOTO, (robot.name,)))]

    def _follow_rows(self, robot, others):
        """Return the row with which a robot follows the driven one, else one to be clicked."""
        if robot.link in (SILENT, GONE):
            return []
        if len(others) == 1:
            return [('{} follows {}'.format(robot.name, robot_menu.driven(others)),
                     partial(self._follow, [robot.name], others[0]))]
        return [('{} follows ...'.format(robot.name),
                 partial(self._pick, gesture.LEADER, (robot.name,)))]

    def _place_rows(self, robot, _):
        """Return the rows of a robot's place, while the map is large."""
        return robot_rows(self.pane, robot.name) if self.pane.is_watched() and self.pane.large \
            else []

    def _rows_of_others(self, robot, others):
        """Return the rows of the driven robots, if another one was clicked."""
        if not others:
            return []
        rows = [('Send ' + robot_menu.driven(others), partial(self._pick, gesture.GOTO, others))]
        return rows + ([] if robot.link in (SILENT, GONE) else [
            ('{} after {}'.format(robot_menu.driven(others), robot.name),
             partial(self._follow, list(others), robot.name))])

    def _pick(self, tool, names, given=None):
        """Let the operator pick a place or a robot for some robots, on the large map.

        :param given: other parameters of their task, {name: value}
        """
        stage = self._screen.stage
        if not (self.pane.large and self.pane.isVisible()):
            self._before_pick = stage.map_state
            self.pane.view.wait_for_paint()
            stage.swap_map()
        self.pane.choose_tool(tool, names, given)

    def _end_pick(self):
        """Show again what the stage showed before a pick."""
        before, self._before_pick = self._before_pick, None
        if before is not None and self.pane.large:
            self._screen.stage.show_map(before)

    def _follow(self, robots, leader, given=()):
        """Let robots follow another one."""
        self._start('follow', list(robots), {**dict(given), 'leader': leader}, 'after ' + leader)

    def _place(self, name, pose):
        """Place a robot by hand, or take it off the map (None); a lost one goes at once."""
        robot = self.pane.view.scene.robot(name)
        if pose is None and robot is not None and robot.lost:
            self._last.take_off(name)
            self._trails.pop(name, None)
            self._report('{} is off the map until it is back'.format(name))
        self._ask(name, self._places.set_place, name, pose)

    def _report(self, text, good=True):
        """Show an answer below the map; beside the pictures while the map is not large."""
        self.pane.show_answer(text, good)
        if not (self.pane.large and self.pane.isVisible()):
            self._screen.show_look_result(text)

    def _go(self, names, pose, aimed):
        """Send robots to a position; several stop side by side there."""
        scene, lost = self.pane.view.scene, self._lost(names)
        robots = {name: scene.robot(name) for name in names if name not in lost}
        robots = {name: robot for name, robot in robots.items() if robot is not None}
        poses = {name: robot.pose for name, robot in robots.items()}
        if not poses:
            self._report('none sent: {}'.format(
                SILENT_TEXT.format(' and '.join(lost)) if lost else
                'those robots are no longer listed'), False)
            return
        if not aimed:
            pose = _away(pose, [there for there in poses.values() if there is not None])
        radius_m, grid = max(robot.radius_m for robot in robots.values()), self._grid
        goals = spread(pose, poses, radius_m, lambda x_m, y_m: grid is None or has_room(
            grid, x_m, y_m, radius_m))
        for name, goal in goals.items():
            x_m, y_m = _rounded(goal.x_m, goal.y_m)
            self._start('goto', [name], {**self.pane.given, 'x': x_m, 'y': y_m, **(
                {'heading': round(goal.heading_rad, 4)} if aimed else {})},
                'to x {:.2f} m, y {:.2f} m'.format(x_m, y_m), len(goals) > 1)
        left = [name for name in poses if name not in goals]
        problems = ['no room there for ' + ' and '.join(left)] if left else []
        problems += [SILENT_TEXT.format(' and '.join(lost))] if lost else []
        if problems:
            self._report('; '.join(([self.pane.line.text()] if goals else []) + problems), False)

    def _lost(self, names):
        """Return those of some robots that no longer send."""
        return [robot.name for robot in self._view.robots
                if robot.name in names and robot.link in (SILENT, GONE)]

    def _start(self, key, robots, parameters, words, more=False):
        """Start a task; the answer comes from the task service."""
        text = '{}: asked to go {}'.format(' and '.join(robots), words)
        lost = self._lost(robots)
        problem = NO_TASKS if self._tasks is None else SILENT_TEXT.format(
            ' and '.join(lost)) if lost else ''
        if problem:
            self._report('not started: ' + problem, False)
            return
        before = self.pane.line.text() if more else ''
        self._report('; '.join(filter(None, (before if 'asked to go' in before else '', text))))
        self._tasks.start_task(key, robots, parameters)

    def note(self, kind, text, robot='', data=None):
        """Show the outcome of a task; its progress only appears in the events.

        :param kind: a key of :data:`mhri.events.events.KINDS`
        """
        if kind in KINDS and kind.startswith('task.') and kind != 'task.said':
            self.pane.show_answer(': '.join(filter(None, (robot, text))), KINDS[kind][0] == CALM)

    def _ask(self, what, call, *words):
        """Call the task service about a robot, a mark or the fence."""
        self.pane.show_answer('{}: asked'.format(what))
        call(*words, lambda done, text: self._answers.put((
            '{}: {}{}'.format(what, '' if done else 'refused: ',
                              text or ('done' if done else 'no reason given')), done)))

    # Settings, end.

    def save_settings(self):
        """Return the settings to keep between runs: JSON values."""
        return {'shown': self._screen.stage.map_state, **self.pane.save_settings()}

    def restore_settings(self, settings):
        """Restore a dict of :meth:`save_settings`, even if parts are missing."""
        self.pane.restore_settings(settings)
        self._screen.stage.show_map(settings.get('shown'))

    def close(self, forget=False):
        """Stop drawing; returns at once. ``forget`` as in the backend."""
        self._timer.stop()
        self._guard.end()
        self._places.close(forget)
        if forget:
            threading.Thread(target=self._map.close, name='forget_map', daemon=True).start()


def _rounded(x_m, y_m):
    """Return a position rounded to 1 mm, as numbers that are short in YAML."""
    return [round(x_m, 3), round(y_m, 3)]


def _away(pose, poses):
    """Return a pose that faces away from the present position of the robots."""
    if not poses:
        return pose
    ahead = pose.x_m - sum(there.x_m for there in poses) / len(poses)
    left = pose.y_m - sum(there.y_m for there in poses) / len(poses)
    return Pose(pose.x_m, pose.y_m, math.atan2(left, ahead))
