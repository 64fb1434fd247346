# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the drawer for tasks: those under way, and one to start."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import (
    QComboBox, QFrame, QGridLayout, QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout,
    QWidget)

from mhri.base.gui import theme, words
from mhri.base.gui.labels import Sign, TextLine
from mhri.base.gui.wide_scroll_bar import WideScrollBar
from mhri.base.task_views import TaskView
from mhri.base.task_words import for_whom, task_line
from mhri.tasks.base import ENDS, WAITING
from mhri.tasks.gui.task_fields import TaskFields

TITLE = 'Tasks'
NONE_UNDER_WAY = 'no robot is on a task'


def run_lines(run, label):
    """Return [(how a robot is getting on, in words; whether it waits)] of a run.

    :param run: :class:`mhri.base.task_views.RunView`
    :param label: what its task is called
    """
    lines = []
    for robot in run.robots:
        line = robot.text if robot.state in ENDS else task_line(TaskView(
            label, robot.text, robot.state == WAITING, robot.left_m))
        lines.append(('{}  {}'.format(robot.robot, line), robot.state == WAITING))
    return lines


class RunRow(QFrame):
    """A task under way: a line for each of its robots, and "Stop"; of several for each as well.

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
        """Make the button and the place of the lines."""
        self.setFrameShape(QFrame.StyledPanel)
        self.stop_button = QPushButton('Stop', self)
        self.stop_button.setObjectName('task_stop_button')
        self.stop_button.setFocusPolicy(Qt.TabFocus)
        self.stop_button.setMinimumHeight(theme.touch_size(self))
        self._grid = QGridLayout(self)
        self._grid.setColumnStretch(1, 1)
        self._grid.addWidget(self.stop_button, 0, 2, Qt.AlignTop)

    def _connect(self):
        """Wire the button."""
        self.stop_button.clicked.connect(self._stop)

    def _stop(self):
        """Ask for the end of it."""
        self.stop_requested.emit(list(self._robots))

    def show_run(self, run, label):
        """Show a :class:`mhri.base.task_views.RunView`."""
        self._robots = tuple(robot.robot for robot in run.robots)
        busy = [robot.robot for robot in run.robots if robot.state not in ENDS]
        self.stop_button.setAccessibleName('stop {} of {}'.format(label, ', '.join(self._robots)))
        lines = run_lines(run, label)
        while len(self._lines) < len(lines):
            row = len(self._lines)
            sign, line = Sign(self), QLabel(self)
            line.setTextFormat(Qt.PlainText)
            line.setWordWrap(True)
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
        button = QPushButton('Stop', self)
        button.setObjectName('task_stop_one_button')
        button.setFocusPolicy(Qt.TabFocus)
        button.setMinimumHeight(theme.touch_size(self))
        button.clicked.connect(lambda: self.stop_requested.emit([self._robots[row]]))
        self._grid.addWidget(button, row, 2, Qt.AlignTop)
        return button


class TasksPage(QWidget):
    """Values in (:meth:`show_tasks`, :meth:`show_problem`), signals out.

    Child widgets: ``task_combo``, a ``task_field_<name>`` for each field, ``task_start_button``,
    and a ``task_stop_button`` for each task under way, for each robot of several a
    ``task_stop_one_button``.
    """

    #: key of a task, its parameters {name: value}
    start_requested = Signal(str, dict)
    #: robots whose task is to end
    stop_requested = Signal(list)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._kinds = ()
        self._rows = {}
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('tasks_page')
        self.setFont(theme.base_font(self.font()))
        self.problem_sign, self.problem_label = Sign(self), self._text()
        self.under_way_label = self._text()
        self.combo = QComboBox(self)
        self.combo.setObjectName('task_combo')
        self.combo.setAccessibleName('Task')
        self.combo.setFocusPolicy(Qt.TabFocus)
        self.about_label = self._text()
        self.fields = TaskFields(self)
        self.who_label = TextLine(self)
        self.start_button = QPushButton('Start', self)
        self.start_button.setObjectName('task_start_button')
        self.start_button.setFocusPolicy(Qt.TabFocus)
        for part in (self.combo, self.start_button):
            part.setMinimumHeight(theme.touch_size(self))
        self.start_button.setMinimumWidth(3 * theme.touch_size(self))
        self._under_way = QVBoxLayout()
        self._lay_out()

    def _lay_out(self):
        """Place the parts: "Start" and what is wrong are always in sight, the rest scrolls."""
        area = QScrollArea(self)
        area.setFrameShape(QFrame.NoFrame)
        area.setFocusPolicy(Qt.NoFocus)
        area.setWidgetResizable(True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarAlwaysOff)
        area.setVerticalScrollBar(WideScrollBar(area))
        area.setWidget(QWidget(area))
        inside = QVBoxLayout(area.widget())
        inside.setContentsMargins(0, 0, 0, 0)
        inside.addWidget(self._heading('Under way'))
        inside.addWidget(self.under_way_label)
        inside.addLayout(self._under_way)
        inside.addSpacing(self.fontMetrics().height() // 2)
        inside.addWidget(self._heading('A new task'))
        for part in (self.combo, self.about_label, self.fields):
            inside.addWidget(part)
        inside.addStretch(1)
        start, problem = QHBoxLayout(), QHBoxLayout()
        start.addWidget(self.start_button)
        start.addWidget(self.who_label, 1)
        problem.addWidget(self.problem_sign, 0, Qt.AlignTop)
        problem.addWidget(self.problem_label, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(area, 1)
        column.addLayout(start)
        column.addLayout(problem)

    def _heading(self, text):
        label = QLabel(text, self)
        label.setFont(theme.larger(self.font(), 1.1, bold=True))
        return label

    def _text(self):
        """Make a text of as many lines as it needs."""
        label = QLabel(self)
        label.setTextFormat(Qt.PlainText)
        label.setWordWrap(True)
        return label

    def _connect(self):
        """Wire the parts."""
        self.combo.currentIndexChanged.connect(self._on_kind)
        self.start_button.clicked.connect(self._start)

    def _restore(self):
        """Begin with nothing known."""
        self.under_way_label.setText(NONE_UNDER_WAY)
        self.show_problem('')
        self._on_kind()

    @property
    def keys(self):
        """The keys of the tasks on offer, in order."""
        return [kind.key for kind in self._kinds]

    @property
    def kind(self):
        """The :class:`mhri.base.task_views.KindView` that is chosen, None for none."""
        place = self.combo.currentIndex()
        return self._kinds[place] if 0 <= place < len(self._kinds) else None

    def show_tasks(self, tasks, whom, names):
        """Show what there is.

        :param tasks: :class:`mhri.base.task_views.TasksView`
        :param whom: :class:`mhri.base.views.RobotView` of those a task would be started for
        :param names: every robot of the list
        """
        if tasks.kinds != self._kinds:
            self._show_kinds(tasks.kinds)
        self.fields.show_names(names, tasks.marks)
        self._show_runs(tasks)
        if tasks.problem:
            self.show_problem(tasks.problem, lasts=False)
        elif not self._lasts:
            self.show_problem('')
        first, *shorter = for_whom(whom)
        self.who_label.show_text(first, theme.TEXT if whom else theme.MUTED, shorter)
        self.start_button.setEnabled(bool(whom and self._kinds and not tasks.problem))

    def _show_kinds(self, kinds):
        """Offer other tasks; the one that is chosen stays, where there still is one."""
        chosen = self.kind.key if self.kind else ''
        self._kinds = kinds
        self.combo.blockSignals(True)
        self.combo.clear()
        self.combo.addItems([kind.label for kind in kinds])
        self.combo.blockSignals(False)
        self.choose(chosen)
        self._on_kind()

    def choose(self, key):
        """Choose a task by its key, if there is such a one."""
        for place, kind in enumerate(self._kinds):
            if kind.key == key:
                self.combo.setCurrentIndex(place)

    def _show_runs(self, tasks):
        """Show a row for each task under way."""
        runs = {run.id: run for run in tasks.runs}
        for goal_id in [goal_id for goal_id in self._rows if goal_id not in runs]:
            row = self._rows.pop(goal_id)
            row.hide()
            row.deleteLater()
        for goal_id, run in runs.items():
            if goal_id not in self._rows:
                row = self._rows[goal_id] = RunRow(goal_id, self)
                row.stop_requested.connect(self.stop_requested)
                self._under_way.addWidget(row)
            self._rows[goal_id].show_run(run, tasks.label(run.key))
        self.under_way_label.setVisible(not runs)

    def _on_kind(self, *_):
        """Show the fields of the task that is chosen."""
        self.about_label.setText(self.kind.text if self.kind else '')
        self.about_label.setVisible(bool(self.kind))
        self.fields.show_kind(self.kind)
        self.show_problem('')

    def _start(self):
        """Ask for the task, or say in place what is missing."""
        values, problem = self.fields.given()
        self.show_problem(problem)
        if not problem and self.kind is not None:
            self.fields.let_go()
            self.start_requested.emit(self.kind.key, values)

    def show_problem(self, text, lasts=True):
        """Say below "Start" why nothing was started; '' clears it.

        :param lasts: until the next start, not only for as long as it is so
        """
        self._lasts = bool(text) and lasts
        if text != self.problem_label.text():
            self.problem_label.setText(words.kept_together(text))
        self.problem_sign.show_sign((theme.TRIANGLE, theme.ATTENTION) if text else None)
        for part in (self.problem_sign, self.problem_label):
            part.setVisible(bool(text))
