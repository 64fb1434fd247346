# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What joins the tasks with the screen, told by a client that is made up: no ROS, no waiting."""
from dataclasses import replace
import types

import pytest
from python_qt_binding.QtCore import Qt

from mhri.base.task_views import KindView, TasksView
from mhri.base.views import Change
from mhri.driving.selection import Selection
from mhri.tasks.presenters.task_presenter import FREE_S, SETTLE_S, TaskPresenter
from mhri.tasks.task_book import Goal

SQUARE = Goal('square', ('bot2',), '{side: 1.0}')
THERE = TasksView(kinds=(KindView('square', 'Square'),))


class Client:
    """Says what it is told to, and keeps what it is asked for."""

    def __init__(self):
        self.strangers = types.SimpleNamespace(words=lambda within_s: self.strange)
        self.strange, self.news, self.sent, self.cancelled = [], [], [], []
        self.tasks, self.busy, self.lefts = THERE, {}, {}
        self.started = 0

    def start(self):
        self.started += 1

    def view(self):
        return self.tasks

    def take_news(self):
        news, self.news = self.news, []
        return news

    def of(self, robot):
        return self.busy.get(robot)

    def left(self, robot):
        return self.lefts.get(robot)

    def send(self, goal):
        self.sent.append(goal)

    def cancel(self, robots):
        self.cancelled.append(list(robots))

    def close(self, forget=False):
        pass


class Desk:
    """A screen with a presenter of tasks, whose clock goes on by hand."""

    def __init__(self, panel, view):
        self.now, self.view, self.notes, self.client = 100.0, view, [], Client()
        self.panel = panel
        self.selection = Selection()
        for robot in view.robots:
            self.selection.add(robot.name)
        self.check(['bot1'])
        panel.show_view(self.view)
        self.presenter = TaskPresenter(
            types.SimpleNamespace(selection=self.selection), panel, self.check,
            lambda *note: self.notes.append(note), self.client, lambda: self.now)

    def check(self, names):
        self.selection.check(names)
        self.view = replace(self.view, robots=tuple(
            replace(robot, selected=robot.name in names, driven=False) for robot in
            self.view.robots))

    def obey(self, name, obeys):
        self.view = replace(self.view, robots=tuple(
            replace(robot, obeys=obeys) if robot.name == name else robot
            for robot in self.view.robots))

    def draw(self, later_s=0.05):
        self.now += later_s
        shown = self.presenter.amend(self.view)
        self.panel.show_view(shown)
        return {robot.name: robot for robot in shown.robots}


@pytest.fixture
def desk(panel, four_robots):
    made = Desk(panel, four_robots)
    made.draw()
    return made


def test_an_unchecked_robot_is_started_at_once(desk):
    desk.presenter.start_task('square', ['bot2'], {'side': 1.0})
    desk.draw()
    assert desk.client.sent == [Goal('square', ('bot2',), '{side: 1.0}')]
    desk.draw()
    assert len(desk.client.sent) == 1 and desk.client.started == 1


def test_a_checked_one_is_unchecked_first_and_started_once_it_obeys_nobody(desk):
    desk.obey('bot1', 'operator')
    desk.draw()
    desk.presenter.start_task('square', ['bot1'], {})
    assert desk.selection.selected == ()
    assert 'bot1' in desk.panel.look_label.text()
    desk.draw(1.0)
    desk.obey('bot1', '')
    desk.draw()
    assert desk.client.sent == []
    desk.draw(SETTLE_S)
    assert [goal.robots for goal in desk.client.sent] == [('bot1',)]


def test_one_that_is_not_let_go_of_is_not_started(desk):
    desk.obey('bot1', 'operator')
    desk.draw()
    desk.presenter.start_task('square', ['bot1'], {})
    desk.draw(FREE_S + 0.1)
    desk.obey('bot1', '')
    desk.draw(10.0)
    assert desk.client.sent == [] and desk.notes[-1][::2] == ('task.refused', 'bot1')
    assert 'bot1' in desk.presenter.page.problem.text()


@pytest.mark.parametrize('when', ['before', 'meanwhile'])
def test_nothing_is_started_under_a_stop(desk, when):
    stopped = replace(desk.view, stop_all=True)
    if when == 'before':
        desk.view = stopped
        desk.draw()
    desk.presenter.start_task('square', ['bot2'], {})
    desk.view = stopped
    desk.draw()
    desk.view = replace(stopped, stop_all=False)
    desk.draw(1.0)
    assert desk.client.sent == [] and desk.notes[-1][::2] == ('task.refused', 'bot2')


def test_ending_a_task_drops_a_start_that_waits(desk):
    desk.presenter.start_task('square', ['bot2'], {})
    desk.presenter.stop(['bot2'])
    desk.draw()
    assert desk.client.sent == [] and desk.client.cancelled == [['bot2']]


def test_to_continue_is_offered_to_who_is_free_and_done_by_one_key(desk, operator):
    desk.client.lefts = {'bot1': replace(SQUARE, robots=('bot1',)), 'bot2': SQUARE}
    desk.obey('bot2', 'task')
    shown = desk.draw()
    assert shown['bot1'].carry_on == '' and shown['bot2'].carry_on == ''
    desk.obey('bot2', '')
    assert desk.draw()['bot2'].carry_on == 'Square'
    desk.panel.look_at('bot2')
    for _ in range(2):
        operator.hit(desk.panel.stage, Qt.Key_C, scan=54)
    desk.draw()
    assert desk.client.sent == [SQUARE]
    assert 'bot2' in desk.panel.look_label.text()


def test_news_are_events_and_a_refusal_is_said_in_place(desk):
    desk.client.news = [Change('bot2', 'task.done', 'square done: it ended'),
                        Change('bot2', 'task.refused', 'side is too small')]
    desk.draw()
    assert [note[0] for note in desk.notes] == ['task.done', 'task.refused']
    assert 'side is too small' in desk.presenter.page.problem.text()


def test_who_runs_the_tasks_is_missed_and_welcomed_back(desk):
    desk.client.tasks = replace(THERE, problem='it is not running')
    desk.draw(1.0)
    desk.draw(1.0)
    desk.client.tasks = THERE
    desk.draw(1.0)
    assert [note[0] for note in desk.notes] == ['tasks.silent', 'tasks.back']
