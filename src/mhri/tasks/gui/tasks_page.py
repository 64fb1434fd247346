# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The section of the drawer that starts a task."""
from python_qt_binding.QtCore import Qt, Signal

from mhri.base.gui import theme, words
from mhri.base.gui.choices import offer
from mhri.base.gui.controls import Button, Combo
from mhri.base.gui.labels import plain_label, SignedText, TextLine
from mhri.base.gui.layouts import add_parts, in_row
from mhri.base.gui.page import Page
from mhri.base.task_words import for_whom
from mhri.tasks.gui.task_fields import TaskFields

TITLE, UNDER_WAY = 'New task', 'Tasks under way'
PLACES = 'Choose on the map'


class TasksPage(Page):
    """Values in (:meth:`show_tasks`, :meth:`show_problem`), signals out.

    Child widgets: ``task_combo``, a ``task_field_<name>`` for each field, ``task_start_button``,
    ``task_places_button`` for a task whose places can be drawn.
    """

    #: key of a task, its parameters {name: value}
    start_requested = Signal(str, dict)
    #: key of a task whose places are to be drawn on the map, its other parameters {name: value}
    places_requested = Signal(str, dict)

    def __init__(self, parent=None):
        super().__init__('tasks_page', parent)
        self._kinds = ()
        self._drawn = ()
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.problem = SignedText(self)
        self.about_label = plain_label(self)
        self.combo = theme.for_fingers(Combo(self), 'task_combo', 'Task')
        self.fields = TaskFields(self)
        self.who_label = TextLine(self)
        self.start_button = theme.for_fingers(Button('Start', self), 'task_start_button')
        self.start_button.setMinimumWidth(3 * theme.touch_size(self))
        self.start_button.set_icon('play')
        self.places_button = theme.finger_button(
            self, 'task_places_button', PLACES, room=0.5).set_icon('map-pin')
        self.places_button.hide()
        self.column.setSpacing(2 * theme.GRID)
        start = in_row(self.start_button, (self.who_label, 1))
        add_parts(self.column, self.combo, self.about_label,
                  (self.places_button, 0, Qt.AlignLeft), self.fields, start, self.problem)

    def _connect(self):
        """Wire the parts."""
        self.combo.currentIndexChanged.connect(self._on_kind)
        self.start_button.clicked.connect(self._start)
        self.places_button.clicked.connect(self._ask_places)

    def _restore(self):
        """Show no tasks at first."""
        self.show_problem('')
        self._on_kind()

    @property
    def keys(self):
        """The keys of the available tasks, in order."""
        return [kind.key for kind in self._kinds]

    @property
    def kind(self):
        """The chosen :class:`mhri.base.task_views.KindView`, or None."""
        return next((kind for kind in self._kinds if kind.key == self.combo.currentData()), None)

    def show_tasks(self, tasks, whom, names):
        """Update the page.

        :param tasks: :class:`mhri.base.task_views.TasksView`
        :param whom: :class:`mhri.base.views.RobotView` of the robots to start
        :param names: every robot of the list
        """
        if tasks.kinds != self._kinds:
            self._kinds = tasks.kinds
            offer(self.combo, [(kind.label, kind.key) for kind in self._kinds],
                  self.combo.currentData())
            self._on_kind()
        self.fields.show_names(names, tasks.marks)
        if tasks.problem:
            self.show_problem(tasks.problem, lasts=False)
        elif not self._lasts:
            self.show_problem('')
        first, *shorter = for_whom(whom)
        self.who_label.show_text(first, theme.TEXT if whom else theme.MUTED, shorter)
        for button in (self.start_button, self.places_button):
            button.setEnabled(bool(whom and self._kinds and not tasks.problem))

    def offer_places(self, keys):
        """Offer the map for tasks with these keys."""
        self._drawn = tuple(keys)
        self._on_kind()

    def choose(self, key):
        """Choose a task by its key, if it exists."""
        if key in self.keys:
            self.combo.setCurrentIndex(self.combo.findData(key))

    def _on_kind(self, *_):
        """Show the fields of the chosen task."""
        self.about_label.setText(self.kind.text if self.kind else '')
        self.about_label.setVisible(bool(self.kind))
        self.places_button.setVisible(self.kind is not None and self.kind.key in self._drawn)
        self.fields.show_kind(self.kind)
        self.show_problem('')

    def _ask_places(self):
        """Request the map for the places of the task, or show what is wrong."""
        values, problem = self.fields.given(all_needed=False)
        self.show_problem(problem)
        if not problem:
            self.fields.let_go()
            self.places_requested.emit(self.kind.key, values)

    def _start(self):
        """Request the task, or show what is missing."""
        values, problem = self.fields.given()
        self.show_problem(problem)
        if not problem and self.kind is not None:
            self.fields.let_go()
            self.start_requested.emit(self.kind.key, values)

    def show_problem(self, text, lasts=True):
        """Show below "Start" why nothing was started; '' clears it.

        :param lasts: whether it stays until the next start
        """
        self._lasts = bool(text) and lasts
        self.problem.show_text(words.kept_together(text), bool(text))
        self.problem.setVisible(bool(text))
