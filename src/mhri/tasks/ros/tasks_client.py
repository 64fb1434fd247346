# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen's client of ``mhri_tasks``: sends goals, and follows all tasks.

It implements the protocol of the action ``/mhri_tasks/run`` (``mhri/RunTask``) itself: actionlib's
client only reports its own goals, but the screen shows all, including those of an earlier screen.
Publishes ``/mhri_tasks/run/goal`` and ``/mhri_tasks/run/cancel``; calls ``/mhri_tasks/end``.
Subscribes ``/mhri_tasks/list``, ``/mhri_tasks/run/feedback`` and ``/mhri_tasks/run/result``, and
accepts only the ``mhri_tasks`` in force (:mod:`mhri.graph.ros.service_owner`), by a service that
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
from mhri.graph.ros.node_client import NodeClient
from mhri.graph.ros.rospy_inside import publishers
from mhri.graph.ros.service_owner import RejectedSenders
from mhri.msg import (
    RunTaskActionFeedback, RunTaskActionGoal, RunTaskActionResult, RunTaskGoal, TaskList)
from mhri.srv import EndTask
from mhri.tasks.task_book import TaskBook

SERVICE = '/mhri_tasks/get_loggers'
# Feedback arrives at 5 Hz while a task runs; the first one takes a moment [s].
SILENT_S = 3.0
# Time that a call waits for its service [s].
CALL_S = 1.0
_END = '/mhri_tasks/end'


class TasksClient:
    """The state of the tasks for the screen; no method blocks.

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
        self.strangers = RejectedSenders(clock)
        self._node = NodeClient('tasks_client', SERVICE, CALL_S, self.strangers.refuse,
                                self._on_new)

    def start(self):
        """Subscribe, on a worker; to be called after ``rospy.init_node``."""
        self._node.do(self._connect)
        return self

    def _connect(self):
        """Open every topic (on the worker: calls the master)."""
        self._goal = self._node.advertise('/mhri_tasks/run/goal', RunTaskActionGoal, 20)
        self._cancel = self._node.advertise('/mhri_tasks/run/cancel', GoalID, 20)
        heard = self._node.subscribe('/mhri_tasks/list', TaskList, self._on_list, 50)
        self._node.subscribe('/mhri_tasks/run/feedback', RunTaskActionFeedback,
                             self._on_feedback, 50)
        self._node.subscribe('/mhri_tasks/run/result', RunTaskActionResult, self._on_result, 50)
        self._node.start()
        self._list = heard

    def _on_new(self, _):
        """Handle a new process of the task service: the runs of the last one are over."""
        with self._lock:
            self._book.lose('the task service was restarted')

    def _on_list(self, message):
        with self._lock:
            self._heard_at = self._clock()
            self._book.on_list(tuple(map(_kind, message.tasks)), tuple(
                RunView(run.id, run.task, run.parameters, _progress(run.robots))
                for run in message.runs), self._heard_at, tuple(map(tidy_text, message.marks)))

    def _on_feedback(self, message):
        with self._lock:
            self._heard_at = self._clock()
            self._book.on_feedback(message.status.goal_id.id,
                                   _progress(message.feedback.robots))

    def _on_result(self, message):
        with self._lock:
            self._heard_at = self._clock()
            self._book.on_result(
                message.status.goal_id.id, tidy_text(message.status.text),
                _progress(message.result.robots),
                message.status.status in (GoalStatus.PREEMPTED, GoalStatus.RECALLED))

    def forget(self):
        """Discard everything received so far."""
        with self._lock:
            self._book = TaskBook()

    def view(self):
        """Return the current :class:`mhri.base.task_views.TasksView`."""
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
        """Return the :class:`mhri.base.views.Change` values since the last call."""
        with self._lock:
            return self._book.take_news()

    def of(self, robot):
        """Return the :class:`mhri.base.task_views.TaskView` of a robot, None without a task."""
        with self._lock:
            return self._book.of(robot)

    def left(self, robot):
        """Return the :class:`mhri.tasks.task_book.Goal` that a robot could continue, or None."""
        with self._lock:
            return self._book.left(robot)

    def send(self, goal):
        """Request a task; its progress is reported as news.

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
        """End the tasks of robots; other robots on the same goals continue.

        :returns: whether there were any
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
        """Record whether robots were taken out of their goals."""
        if answer is None:
            with self._lock:
                self._book.keep_on(robots, 'the task service does not answer')

    def close(self, forget=False):
        """Close without blocking.

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
