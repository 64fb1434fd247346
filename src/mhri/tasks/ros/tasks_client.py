# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen's side of the tasks: goals to ``mhri_tasks``, and what it says of every task.

Speaks the protocol of the action ``/mhri_tasks/run`` (``mhri/RunTask``) itself: actionlib's client
tells of its own goals alone, and the screen shows everybody's, those of a screen before it, too.
Publishes ``/mhri_tasks/run/goal`` and ``/mhri_tasks/run/cancel``; calls ``/mhri_tasks/end``.
Subscribes ``/mhri_tasks/list``, ``/mhri_tasks/run/feedback`` and ``/mhri_tasks/run/result``, and
believes only the ``mhri_tasks`` in force (:mod:`mhri.graph.ros.in_force`), by a service that
every node of rospy has.
"""
from dataclasses import replace
import itertools
import math
import threading
import time

from actionlib_msgs.msg import GoalID, GoalStatus
import rospy

from mhri.base.task_views import FieldView, KindView, Progress, RunView
from mhri.base.task_words import NOT_ANSWERING, NOT_RUNNING
from mhri.base.text import tidy_text
from mhri.graph.ros.in_force import Strangers
from mhri.graph.ros.node_client import NodeClient
from mhri.graph.ros.rospy_inside import publishers
from mhri.msg import (
    RunTaskActionFeedback, RunTaskActionGoal, RunTaskActionResult, RunTaskGoal, TaskList)
from mhri.srv import EndTask
from mhri.tasks.task_book import TaskBook

SERVICE = '/mhri_tasks/get_loggers'
# Feedback comes at 5 Hz while anything is under way; the first one takes a moment [s].
SILENT_S = 3.0
# A call waits so long for its service [s].
CALL_S = 1.0
_END = '/mhri_tasks/end'


class TasksClient:
    """What the screen knows of the tasks; every method returns at once.

    :param clock: function that returns seconds, monotonic
    ``strangers`` are nodes that pose as ``mhri_tasks``.
    """

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._lock = threading.RLock()
        self._book = TaskBook()
        self._heard_at = clock()
        self._there = False
        self._numbers = itertools.count(1)
        self._list = None
        self.strangers = Strangers(clock)
        self._node = NodeClient('tasks_client', SERVICE, CALL_S, self.strangers.refuse,
                                self._on_new)

    def start(self):
        """Begin to listen, on a worker; call it after ``rospy.init_node``."""
        self._node.do(self._connect)
        return self

    def _connect(self):
        """Open every topic (on the worker: it asks the master)."""
        self._goal = self._node.advertise('/mhri_tasks/run/goal', RunTaskActionGoal, 20)
        self._cancel = self._node.advertise('/mhri_tasks/run/cancel', GoalID, 20)
        heard = self._node.subscribe('/mhri_tasks/list', TaskList, self._hear_list, 50)
        self._node.subscribe('/mhri_tasks/run/feedback', RunTaskActionFeedback,
                             self._hear_feedback, 50)
        self._node.subscribe('/mhri_tasks/run/result', RunTaskActionResult, self._hear_result, 50)
        self._node.start()
        self._list = heard

    def _on_new(self, _):
        """Take in that another process runs the tasks now: what the last one ran is over."""
        with self._lock:
            self._book.lose('the task service was restarted')

    def _hear_list(self, message):
        with self._lock:
            self._heard_at = self._clock()
            self._book.hear_list(tuple(map(_kind, message.tasks)), tuple(
                RunView(run.id, run.task, run.parameters, _progress(run.robots))
                for run in message.runs), self._heard_at, tuple(map(tidy_text, message.marks)))

    def _hear_feedback(self, message):
        with self._lock:
            self._heard_at = self._clock()
            self._book.hear_feedback(message.status.goal_id.id,
                                     _progress(message.feedback.robots))

    def _hear_result(self, message):
        with self._lock:
            self._heard_at = self._clock()
            self._book.hear_result(
                message.status.goal_id.id, tidy_text(message.status.text),
                _progress(message.result.robots),
                message.status.status in (GoalStatus.PREEMPTED, GoalStatus.RECALLED))

    def forget(self):
        """Begin anew: what was heard before counts no more."""
        with self._lock:
            self._book = TaskBook()

    def view(self):
        """Return the :class:`mhri.base.task_views.TasksView` of this moment."""
        now = self._clock()
        there = self._list is not None and self._node.caller in publishers(self._list)
        with self._lock:
            if self._there and not there:
                self._book.lose('the task service has ended, and the robot stands')
            self._there = there
            self._book.tick(now)
            view = self._book.view()
            silent = bool(view.runs) and now - self._heard_at > SILENT_S
        return replace(view, problem=NOT_RUNNING if not there else
                       NOT_ANSWERING if silent else '')

    def take_news(self):
        """Return the :class:`mhri.tasks.task_book.News` since the last call."""
        with self._lock:
            return self._book.take_news()

    def of(self, robot):
        """Return the :class:`mhri.base.task_views.TaskView` of a robot, None for none."""
        with self._lock:
            return self._book.of(robot)

    def left(self, robot):
        """Return the :class:`mhri.tasks.task_book.Goal` that a robot could continue."""
        with self._lock:
            return self._book.left(robot)

    def send(self, goal):
        """Ask for a task; what becomes of it is news.

        :param goal: :class:`mhri.tasks.task_book.Goal`
        """
        if self._list is None:
            return
        message = RunTaskActionGoal(goal=RunTaskGoal(goal.key, list(goal.robots),
                                                     goal.parameters))
        message.header.stamp = message.goal_id.stamp = rospy.Time.now()
        message.goal_id.id = '{}-{}-{:.6f}'.format(rospy.get_name(), next(self._numbers),
                                                   message.header.stamp.to_sec())
        with self._lock:
            self._book.ask(message.goal_id.id, goal, self._clock())
        self._goal.publish(message)

    def cancel(self, robots):
        """End the tasks of robots; the others on the same goals go on.

        :returns: whether there was any
        """
        with self._lock:
            parts = self._book.parts_of(tuple(robots))
            for goal_id, some in parts:
                self._book.cancel(goal_id, some)
        for goal_id, some in parts:
            if some:
                self._node.request(lambda answer, robots=some: self._ended(robots, answer), _END,
                                   EndTask, some)
            else:
                self._cancel.publish(GoalID(id=goal_id))
        return bool(parts)

    def _ended(self, robots, answer):
        """Take in whether robots are out of their goals."""
        if answer is None:
            with self._lock:
                self._book.keep_on(robots, 'the task service does not answer')

    def close(self, forget=False):
        """End; returns at once.

        :param forget: unregister every topic as well, in the background
        """
        self._node.close(forget)


def _kind(message):
    """Return the :class:`KindView` of a ``mhri/TaskKind``."""
    return KindView(message.key, tidy_text(message.label), tidy_text(message.text), tuple(
        FieldView(field.name, tidy_text(field.unit), tidy_text(field.text), field.default_value,
                  field.least, field.greatest, tuple(field.choices)) for field in message.fields))


def _progress(states):
    """Return the :class:`Progress` of each ``mhri/TaskState``."""
    return tuple(Progress(state.robot, state.state, tidy_text(state.text),
                          state.left_m if math.isfinite(state.left_m) else None,
                          tuple(state.said)) for state in states)
