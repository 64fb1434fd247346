# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the tasks with the screen: rows, tiles, the page, events; starts, ends and continues them.

Everything here runs on the GUI thread; nothing waits.
"""
from dataclasses import dataclass, replace
import time

import yaml

from mhri.base.gui.pending import Pace
from mhri.base.task_words import carry_on_line, start_problem
from mhri.base.views import PanelView, ROS_CONNECTED
from mhri.events.events import ATTENTION, KINDS
from mhri.tasks.gui.tasks_page import TasksPage, TITLE
from mhri.tasks.ros.tasks_client import TasksClient
from mhri.tasks.task_book import Goal

WORDS_S = 0.25
# The gates tell everybody at once that a robot is unchecked: mhri_tasks has so long to hear it,
# and they have so long to say it [s].
SETTLE_S, FREE_S = 0.2, 3.0
# A stranger's word is told again after so long [s].
STRANGER_S = 60.0


@dataclass
class _Start:
    """A start that waits until its robots are unchecked; ``free_s`` is since when they are."""

    goal: Goal
    was_checked: bool
    asked_s: float
    free_s: float = 0.0


class TaskHost:
    """Knows the tasks of all robots for one screen.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param select: function that checks exactly the robots of a list
    :param note: function of (kind, text, robot) that makes an event
    :param client: :class:`mhri.tasks.ros.tasks_client.TasksClient`
    """

    def __init__(self, operator, screen, select, note, client=None, clock=time.monotonic):
        self._operator = operator
        self._screen = screen
        self._select = select
        self._note = note
        self._client = client or TasksClient()
        self._clock = clock
        self._started = False
        self._view = PanelView()
        self._tasks = self._client.view()
        self._shown = {}
        self._pace = Pace(WORDS_S, clock)
        self._waiting = []
        # None before they are first there.
        self._was_there = None
        self._told_s = -STRANGER_S
        self.page = TasksPage()
        screen.arrangement.add_page(TITLE, self.page, second=True)
        self._connect()

    def _connect(self):
        """Wire page, rows and keys."""
        self.page.start_requested.connect(
            lambda key, parameters: self.start(key, self._whom(), parameters))
        self.page.stop_requested.connect(self.stop)
        self._screen.robot_list.carry_on_requested.connect(self.carry_on)
        self._screen.drive_keys.command_pressed.connect(self._on_command)

    def _on_command(self, command):
        if command == 'carry_on':
            self._carry_on_looked_at()

    def _looked_at(self):
        """Return the robot that is looked at, '' for none."""
        stage = self._screen.stage
        return stage.looked_at or next(iter(stage.large), '')

    def _whom(self):
        """Return the robots that a task is started for: those checked, else the one looked at."""
        checked = [robot.name for robot in self._view.robots if robot.selected]
        return checked or list(filter(None, [self._looked_at()]))

    # What there is to see.

    @property
    def view(self):
        """The newest :class:`PanelView`, with the task of each robot."""
        return self._view

    def tell(self, view):
        """Return a :class:`PanelView` with the task of each robot; call it with each drawing."""
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
        """Return a robot with its task; words that only count change four times a second."""
        task = self._client.of(robot.name)
        before = self._shown.get(robot.name)
        if task and before and (task.label, task.waits) == (before.label, before.waits):
            task = before
        self._shown[robot.name] = task
        # Its gate lets go of it a moment after its task has.
        free = task is None and not robot.selected and robot.obeys != 'task'
        left = self._client.left(robot.name) if free else None
        if task is None and left is None:
            return robot
        return replace(robot, task=task, carry_on=self._tasks.label(left.key) if left else '')

    def _show_page(self, view):
        """Show all tasks, and for whom one would be started."""
        whom = self._whom()
        self.page.show_tasks(self._tasks, [robot for robot in view.robots if robot.name in whom],
                             [robot.name for robot in view.robots])

    def _hear(self, news):
        """Tell of what has happened."""
        self._note(news.kind, news.text, news.robot)
        if KINDS[news.kind][0] == ATTENTION:
            text = ': '.join(filter(None, (news.robot, news.text)))
            self.page.show_problem(text)
            self._screen.show_look_result(text)

    def _watch(self):
        """Tell of whoever runs the tasks falling silent or coming back, and of strangers."""
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
            self._note('tasks.stranger', 'not believed about tasks: ' + '; '.join(strangers), '')

    # What the operator does.

    def start(self, key, robots, parameters):
        """Put robots on a task; those that are checked are unchecked first.

        :param key: key of the task
        :param robots: their names
        :param parameters: {name: value}; what is left out has its default
        """
        self._begin(Goal(key, tuple(robots), yaml.safe_dump(parameters, default_flow_style=True)))

    def _begin(self, goal):
        problem = start_problem(self._view, self._tasks, goal.robots)
        if problem:
            self._refuse(goal, problem)
            return
        checked = self._operator.selection.selected
        busy = [name for name in goal.robots if name in checked]
        self.page.show_problem('')
        if busy:
            self._screen.show_look_result('{} unchecked: {} by {}'.format(
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
        """Send the goals whose robots are let go of."""
        now, robots = self._clock(), {robot.name: robot for robot in self._view.robots}
        for start in list(self._waiting):
            names = [name for name in start.goal.robots if name in robots and (
                robots[name].selected or robots[name].obeys == 'operator')]
            if names:
                start.free_s = 0.0
                if now - start.asked_s > FREE_S:
                    self._waiting.remove(start)
                    self._refuse(start.goal, '{} still obeys you: uncheck it'.format(names[0]))
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
        """End the tasks of robots; the others on the same goals go on."""
        self._waiting = [start for start in self._waiting
                         if not set(robots) & set(start.goal.robots)]
        self._client.cancel(robots)

    def carry_on(self, robot):
        """Put a robot back on the task that it was taken from, or that was stopped."""
        if any(robot in start.goal.robots for start in self._waiting):
            return
        goal = self._client.left(robot)
        if goal is None or self._client.of(robot) is not None:
            self._screen.show_look_result('{} has no task to continue'.format(robot))
            return
        self._screen.show_look_result('{} {}'.format(robot, carry_on_line(goal.key)))
        self._begin(goal)

    def _carry_on_looked_at(self):
        """Continue the task of the robot that is looked at."""
        robot = self._looked_at()
        checked = robot in self._operator.selection.selected
        if checked:
            self._screen.show_look_result('{} is checked: uncheck it to continue its task'.format(
                robot))
        elif robot:
            self.carry_on(robot)

    def close(self, forget=False):
        """Let go of the tasks, those under way go on; ``forget`` as in the backend."""
        self._client.close(forget)
