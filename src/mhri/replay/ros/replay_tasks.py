# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tasks of a session that is replayed: as they are heard, and as its lines recall them."""
from mhri.tasks.ros.tasks_client import TasksClient
from mhri.tasks.task_book import Goal


class ReplayTasks(TasksClient):
    """A :class:`TasksClient` to which a session may jump.

    :param recalled: :class:`mhri.session.recalled.Recalled`
    :param wall: function that returns the time of day of the session [s since 1970]
    """

    def __init__(self, recalled, wall):
        super().__init__()
        self._listed = None
        self._recalled = recalled
        self._wall = wall

    def forget(self):
        """Begin anew: what was heard before counts no more."""
        self._listed = None
        super().forget()

    def _hear_list(self, message):
        """Take in a list; the same again, in a pause, is older than the feedback since."""
        listed = [run.id for run in message.runs], message.marks, len(message.tasks)
        if listed != self._listed:
            self._listed = listed
            super()._hear_list(message)

    def take_news(self):
        """Return nothing: the session's own lines tell what happened."""
        super().take_news()
        return []

    def left(self, robot):
        """Return the :class:`Goal` that a robot could continue then, None for none."""
        label = self._recalled.interrupted(robot, self._wall())
        key = next((kind.key for kind in self.view().kinds if kind.label.lower() == label), None)
        return Goal(key, (robot,), '') if key else None

    def send(self, goal):
        """Send nothing."""

    def cancel(self, robots):
        """End nothing."""
        return False
