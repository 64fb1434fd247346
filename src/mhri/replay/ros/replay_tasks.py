# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tasks of a replayed session: from its messages, and from its lines."""
from mhri.tasks.ros.tasks_client import TasksClient
from mhri.tasks.task_book import Goal


class ReplayTasks(TasksClient):
    """A :class:`TasksClient` for a session that may jump in time.

    :param history: :class:`mhri.session.history.SessionHistory`
    :param wall: function that returns the time of day of the session [s since 1970]
    """

    def __init__(self, history, wall):
        super().__init__()
        self._listed = None
        self._history = history
        self._wall = wall

    def forget(self):
        """Reset: earlier messages no longer count."""
        self._listed = None
        super().forget()

    def _on_list(self, message):
        """Handle a list; a repetition during a pause is older than the feedback since."""
        listed = [run.id for run in message.runs], message.marks, len(message.tasks)
        if listed != self._listed:
            self._listed = listed
            super()._on_list(message)

    def take_news(self):
        """Return nothing: the session's own lines contain the events."""
        super().take_news()
        return []

    def left(self, robot):
        """Return the :class:`Goal` that a robot could continue at that time, or None."""
        key = self._history.interrupted(robot, self._wall())
        return Goal(key, (robot,), '') if key else None

    def send(self, goal):
        """Do nothing in a replay."""

    def cancel(self, robots):
        """Do nothing: a replay has no running tasks."""
        return False
