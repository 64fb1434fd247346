# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the tasks with the screen: rows, tiles, page and events; starts and ends them.

Everything here runs on the GUI thread and never blocks.
"""
from dataclasses import dataclass, replace
from functools import partial
import time

from mhri.base.config import yaml_text
from mhri.base.gui.pending import Pace
from mhri.base.part import MISSION, Part, ROBOTS
from mhri.base.task_words import carry_on_line, start_problem
from mhri.base.views import GONE, ROS_CONNECTED, ScreenView, SILENT
from mhri.driving.gui import robot_menu
from mhri.events.events import ATTENTION, KINDS
from mhri.tasks.gui.runs_list import RunsList
from mhri.tasks.gui.tasks_page import TasksPage, TITLE, UNDER_WAY
from mhri.tasks.ros.tasks_client import TasksClient
from mhri.tasks.task_book import Goal

WORDS_S = 0.25
# After a deselection: delay until mhri_tasks has received it, and timeout for the mux to
# report it [s].
SETTLE_S, FREE_S = 0.2, 3.0
# Period of reporting nodes that pose as mhri_tasks [s].
STRANGER_S = 60.0


@dataclass
class _Start:
    """A start that waits for the deselection of its robots; ``free_s`` is when it was reported."""

    goal: Goal
    was_checked: bool
    asked_s: float
    free_s: float = 0.0


class TaskPresenter(Part):
    """The tasks of all robots for one screen.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param select: function that selects exactly the robots of a list
    :param note: function of (kind, text, robot, data) that makes an event
    :param client: :class:`mhri.tasks.ros.tasks_client.TasksClient`
    """

    @classmethod
    def of(cls, context, client=None):
        """Return the presenter for a screen: see :class:`mhri.base.part.Part`."""
        tasks = cls(context.backend, context.screen, context.select, context.note, client)
        context.tiles.carry_on_requested.connect(tasks.carry_on)
        return tasks

    def __init__(self, operator, screen, select, note, client=None, clock=time.monotonic):
        self._operator = operator
        self._screen = screen
        self._select = select
        self._note = note
        self._client = client or TasksClient()
        self._clock = clock
        self._started = False
        self._view = ScreenView()
        self._tasks = self._client.view()
        self._shown = {}
        self._pace = Pace(WORDS_S, clock)
        self._waiting = []
        # None before the tasks are first available.
        self._was_there = None
        self._told_s = -STRANGER_S
        self.page = TasksPage()
        screen.arrangement.add_section(MISSION, TITLE, self.page, 0, 'flag', True)
        self.runs = RunsList()
        self._under_way = screen.arrangement.add_section(
            ROBOTS, UNDER_WAY, self.runs, 10, 'route', True)
        self._under_way.hide()
        self._connect()

    def _connect(self):
        """Wire page, rows and keys."""
        self.page.start_requested.connect(
            lambda key, parameters: self.start_task(key, self._whom(), parameters))
        self.runs.stop_requested.connect(self.stop)
        self.runs.carry_on_requested.connect(self.carry_on)
        self._screen.robot_list.carry_on_requested.connect(self.carry_on)
        self._screen.drive_keys.command_pressed.connect(self._on_command)
        self._screen.robot_menu.offer(robot_menu.RETURN, self._return_rows)
        self._screen.robot_menu.offer(robot_menu.TASK, self._task_rows)

    def _return_rows(self, robot, _):
        """Return the row of a robot's menu that sends it back along its trail."""
        return [] if robot.link in (SILENT, GONE) else [
            ('Return {}'.format(robot.name), partial(self.start_task, 'return', [robot.name], {}))]

    def _task_rows(self, robot, _):
        """Return the row that ends a robot's task, or continues it."""
        if robot.on_task:
            return [('End the task of {}'.format(robot.name), partial(self.stop, [robot.name]))]
        return [('Continue {} of {}'.format(robot.carry_on.lower(), robot.name),
                 partial(self.carry_on, robot.name))] if robot.carry_on else []

    def _on_command(self, command):
        if command == 'carry_on':
            self._carry_on_looked_at()

    def _looked_at(self):
        """Return the robot in view, '' without one."""
        stage = self._screen.stage
        return stage.looked_at or next(iter(stage.large), '')

    def _whom(self):
        """Return the robots to start a task for: the selected ones, else the one in view."""
        checked = [robot.name for robot in self._view.robots if robot.selected]
        return checked or list(filter(None, [self._looked_at()]))

    # View.

    @property
    def view(self):
        """The newest :class:`ScreenView`, with the task of each robot."""
        return self._view

    def amend(self, view):
        """Return a :class:`ScreenView` with the task of each robot; called for each repaint."""
        if not self._started and view.ros == ROS_CONNECTED:
            self._started = True
            self._client.start()
        self._tasks = self._client.view() if self._started else self._tasks
        for news in self._client.take_news():
            self._hear(news)
        self._watch()
        due = self._pace.due()
        if due:
            self._shown.clear()
        self._view = view = replace(view, robots=tuple(map(self._with_task, view.robots)))
        if due:
            self._show_page(view)
        self._send_due()
        return view

    def _with_task(self, robot):
        """Return a robot with its task; numbers in its text are updated four times a second."""
        task = self._client.of(robot.name)
        before = self._shown.get(robot.name)
        if task and before and (task.label, task.waits) == (before.label, before.waits):
            task = before
        self._shown[robot.name] = task
        # The mux releases it shortly after its task has ended.
        free = task is None and not robot.selected and robot.obeys != 'task'
        left = self._client.left(robot.name) if free else None
        if task is None and left is None:
            return robot
        return replace(robot, task=task, carry_on=self._tasks.label(left.key) if left else '')

    def _show_page(self, view):
        """Show all tasks, and the robots for which one would be started."""
        whom = self._whom()
        self.page.show_tasks(self._tasks, [robot for robot in view.robots if robot.name in whom],
                             [robot.name for robot in view.robots])
        self.runs.show_tasks(self._tasks, view.robots)
        self._under_way.setHidden(self.runs.is_empty)

    def _hear(self, news):
        """Report the news of tasks as events."""
        self._note(news.kind, news.text, news.robot, news.data)
        if KINDS[news.kind][0] == ATTENTION:
            text = ': '.join(filter(None, (news.robot, news.text)))
            self.page.show_problem(text)
            self._screen.show_look_result(text)

    def _watch(self):
        """Report the loss and return of the task service, and rejected senders."""
        there, was_there = not self._tasks.problem, self._was_there
        if was_there and not there:
            self._note('tasks.silent', self._tasks.problem, '')
        elif there and was_there is False:
            self._note('tasks.back', 'the task service is back', '')
        if there or was_there is not None:
            self._was_there = there
        strangers = self._client.strangers.words(STRANGER_S)
        if strangers and self._clock() - self._told_s >= STRANGER_S:
            self._told_s = self._clock()
            self._note('tasks.stranger', 'rejected about tasks: ' + '; '.join(strangers), '')

    # Actions of the operator.

    def offer_places(self, keys, pick):
        """Offer the map for the places of a new task.

        :param keys: of the tasks whose places can be drawn
        :param pick: function of (key, robots, {name: value}) that lets the operator draw them
        """
        self.page.offer_places(keys)
        self.page.places_requested.connect(
            lambda key, given: pick(key, self._whom(), given))

    def start_task(self, key, robots, parameters):
        """Put robots on a task; selected ones are deselected first.

        :param key: key of the task
        :param robots: their names
        :param parameters: {name: value}; others have their defaults
        """
        self._begin(Goal(key, tuple(robots), yaml_text(parameters)))

    def _begin(self, goal):
        problem = start_problem(self._view, self._tasks, goal.robots)
        if problem:
            self._refuse(goal, problem)
            return
        checked = self._operator.selection.selected
        busy = [name for name in goal.robots if name in checked]
        self.page.show_problem('')
        if busy:
            self._screen.show_look_result('{} deselected: {} by {}'.format(
                ', '.join(busy), 'it drives' if len(busy) == 1 else 'they drive',
                'itself' if len(busy) == 1 else 'themselves'))
            self._select([name for name in checked if name not in busy])
        self._waiting.append(_Start(goal, bool(busy), self._clock()))

    def _refuse(self, goal, why):
        text = '{} not started: {}'.format(self._tasks.label(goal.key).lower(), why)
        self._note('task.refused', text, goal.robots[0] if len(goal.robots) == 1 else '')
        self.page.show_problem(why)
        self._screen.show_look_result(text)

    def _send_due(self):
        """Send the goals whose robots are released."""
        now, robots = self._clock(), {robot.name: robot for robot in self._view.robots}
        for start in list(self._waiting):
            names = [name for name in start.goal.robots if name in robots and (
                robots[name].selected or robots[name].obeys == 'operator')]
            if names:
                start.free_s = 0.0
                if now - start.asked_s > FREE_S:
                    self._waiting.remove(start)
                    self._refuse(start.goal, '{} still obeys you: deselect it'.format(names[0]))
                continue
            start.free_s = start.free_s or now
            if now - start.free_s >= (SETTLE_S if start.was_checked else 0.0):
                self._waiting.remove(start)
                problem = start_problem(self._view, self._tasks, start.goal.robots)
                if problem:
                    self._refuse(start.goal, problem)
                else:
                    self._client.send(start.goal)

    def stop(self, robots):
        """End the tasks of robots; others on the same goals continue."""
        self._waiting = [start for start in self._waiting
                         if not set(robots) & set(start.goal.robots)]
        self._client.cancel(robots)

    def carry_on(self, robot):
        """Continue the task of a robot that was taken over or stopped."""
        if any(robot in start.goal.robots for start in self._waiting):
            return
        goal = self._client.left(robot)
        if goal is None or self._client.of(robot) is not None:
            self._screen.show_look_result('{} has no task to continue'.format(robot))
            return
        self._screen.show_look_result('{} {}'.format(robot, carry_on_line(goal.key)))
        self._begin(goal)

    def _carry_on_looked_at(self):
        """Continue the task of the robot in view."""
        robot = self._looked_at()
        checked = robot in self._operator.selection.selected
        if checked:
            self._screen.show_look_result('{} is selected: deselect it to continue its task'.format(
                robot))
        elif robot:
            self.carry_on(robot)

    def disable(self):
        """Disable starting and ending tasks."""
        self.page.setEnabled(False)
        self.runs.setEnabled(False)

    def close(self, forget=False):
        """Close; running tasks continue; ``forget`` as in the backend."""
        self._client.close(forget)
