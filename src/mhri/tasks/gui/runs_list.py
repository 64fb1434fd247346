# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tasks under way, each with "Stop", and the interrupted ones, each with "Continue"."""
from functools import partial

from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QFrame, QGridLayout, QWidget

from mhri.base.gui import theme
from mhri.base.gui.controls import Button
from mhri.base.gui.labels import plain_label, Sign
from mhri.base.gui.layouts import in_row
from mhri.base.gui.page import Page
from mhri.base.task_views import TaskView
from mhri.base.task_words import interrupted_line, task_line
from mhri.tasks.base import ENDS, WAITING

CONTINUE = 'Continue'


def run_lines(run, label):
    """Return [(progress of a robot as text, whether it waits)] of a run.

    :param run: :class:`mhri.base.task_views.RunView`
    :param label: name of its task
    """
    lines = []
    for robot in run.robots:
        line = robot.text if robot.state in ENDS else task_line(TaskView(
            label, robot.text, robot.state == WAITING, robot.left_m))
        lines.append(('{}  {}'.format(robot.robot, line), robot.state == WAITING))
    return lines


class RunRow(QFrame):
    """A running task: a line per robot, and "Stop"; for several robots also one per robot.

    :param goal_id: id of its goal
    """

    #: robots whose task is to end
    stop_requested = Signal(list)

    def __init__(self, goal_id, parent=None):
        super().__init__(parent)
        self.goal_id = goal_id
        self._robots = ()
        self._lines = []
        self._build()
        self._connect()

    def _build(self):
        """Create the button and the layout of the lines."""
        self.setFrameShape(QFrame.StyledPanel)
        self.stop_button = theme.for_fingers(Button('Stop', self), 'task_stop_button')
        self._grid = QGridLayout(self)
        self._grid.setColumnStretch(1, 1)
        self._grid.addWidget(self.stop_button, 0, 2, Qt.AlignTop)

    def _connect(self):
        """Wire the button."""
        self.stop_button.clicked.connect(self._stop)

    def _stop(self):
        """Request its end."""
        self.stop_requested.emit(list(self._robots))

    def _stop_one(self, row, *_):
        """Request the end for one robot."""
        self.stop_requested.emit([self._robots[row]])

    def show_run(self, run, label):
        """Show a :class:`mhri.base.task_views.RunView`."""
        self._robots = tuple(robot.robot for robot in run.robots)
        busy = [robot.robot for robot in run.robots if robot.state not in ENDS]
        self.stop_button.setAccessibleName('stop {} of {}'.format(label, ', '.join(self._robots)))
        lines = run_lines(run, label)
        while len(self._lines) < len(lines):
            row = len(self._lines)
            sign, line = Sign(self), plain_label(self)
            self._grid.addWidget(sign, row, 0, Qt.AlignTop)
            self._grid.addWidget(line, row, 1, Qt.AlignTop)
            self._lines.append((sign, line, self._single_button(row)))
        for name, (text, waits), (sign, line, button) in zip(self._robots, lines, self._lines):
            sign.show_sign(theme.TASK_WAITS if waits else theme.ON_TASK)
            button.setAccessibleName('stop {} of {}'.format(label, name))
            button.setVisible(len(busy) > 1 and name in busy)
            if text != line.text():
                line.setText(text)
        several = len(self._robots) > 1
        self.stop_button.setText('Stop all of them' if several else 'Stop')
        if several:
            self._grid.addWidget(self.stop_button, len(self._lines), 1, 1, 2)

    def _single_button(self, row):
        """Make the button that ends the part of one robot."""
        button = theme.for_fingers(Button('Stop', self), 'task_stop_one_button')
        button.clicked.connect(partial(self._stop_one, row))
        self._grid.addWidget(button, row, 2, Qt.AlignTop)
        return button


class InterruptedRow(QWidget):
    """A robot whose task was interrupted, and "Continue"."""

    #: name of the robot
    carry_on_requested = Signal(str)

    def __init__(self, name, parent=None):
        super().__init__(parent)
        self._name = name
        self.line = plain_label(self)
        self.button = theme.finger_button(self, 'task_continue_button', CONTINUE, room=0.5)
        in_row((self.line, 1), self.button, of=self, margins=(theme.GRID, 0, 0, 0))
        self.button.clicked.connect(self._ask)

    def _ask(self):
        self.carry_on_requested.emit(self._name)

    def show_task(self, label):
        """Show the label of its task."""
        text = '{}  {}'.format(self._name, interrupted_line(label))
        if text != self.line.text():
            self.line.setText(text)
            self.button.setAccessibleName('{} {} of {}'.format(CONTINUE, label.lower(), self._name))


class RunsList(Page):
    """Values in (:meth:`show_tasks`), signals out.

    Child widgets: a ``task_stop_button`` for each task under way, for each robot of several a
    ``task_stop_one_button``; a ``task_continue_button`` for each interrupted task.
    """

    #: robots whose task is to end
    stop_requested = Signal(list)
    #: name of the robot that is to continue its interrupted task
    carry_on_requested = Signal(str)

    def __init__(self, parent=None):
        super().__init__('tasks_under_way', parent)
        self._runs = {}
        self._interrupted = {}
        self.column.setSpacing(theme.GRID)

    @property
    def is_empty(self):
        """Whether there is no task to stop or to continue."""
        return not (self._runs or self._interrupted)

    def show_tasks(self, tasks, robots=()):
        """Show a row for each running and each interrupted task.

        :param tasks: :class:`mhri.base.task_views.TasksView`
        :param robots: every :class:`mhri.base.views.RobotView` of the list
        """
        runs = {run.id: run for run in tasks.runs}
        self._match(self._runs, runs, self._new_run)
        for goal_id, run in runs.items():
            self._runs[goal_id].show_run(run, tasks.label(run.key))
        interrupted = {robot.name: robot.carry_on for robot in robots if robot.carry_on}
        self._match(self._interrupted, interrupted, self._new_interrupted)
        for name, label in interrupted.items():
            self._interrupted[name].show_task(label)

    def _match(self, rows, wanted, make):
        """Remove the rows of what has ended, and make those of what is new."""
        for key in [key for key in rows if key not in wanted]:
            row = rows.pop(key)
            row.hide()
            row.deleteLater()
        for key in wanted:
            if key not in rows:
                rows[key] = make(key)
                self.column.addWidget(rows[key])

    def _new_run(self, goal_id):
        row = RunRow(goal_id, self)
        row.stop_requested.connect(self.stop_requested)
        return row

    def _new_interrupted(self, name):
        row = InterruptedRow(name, self)
        row.carry_on_requested.connect(self.carry_on_requested)
        return row
