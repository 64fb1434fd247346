# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The fields of a task, made from its description: number, text, choice, or a name."""
from functools import partial
import math

from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QComboBox, QGridLayout, QLabel, QWidget

from mhri.base.gui import theme
from mhri.base.gui.choices import IgnoresWheel
from mhri.base.gui.controls import Button, Combo, LineField, NumberField
from mhri.base.task_views import typed_value

LEFT_OUT, MISSING = 'optional', 'required'
# Fields for the name of a robot, or of a mark, with their hints.
LEADER, MARK = 'leader', 'mark'
_WHICH = {LEADER: 'which robot', MARK: 'which mark'}
# Display of a unit: unit on the screen, factor, decimals, step.
_SHOWN = {'rad': ('\u00b0', 180.0 / math.pi, 0, 15.0), 's': ('s', 1.0, 0, 10.0),
          'm/s': ('m/s', 1.0, 2, 0.05), '': ('', 1.0, 0, 1.0)}
# Maximum length of typed text.
_MAX_TEXT = 10000


class QuantityField(NumberField):
    """A number with its unit and limits.

    :param field: :class:`mhri.base.task_views.FieldView`
    """

    def __init__(self, field, parent=None):
        unit, self._factor, decimals, step = _SHOWN.get(field.unit, (field.unit, 1.0, 2, 0.1))
        self.may_be_left_out = field.default == 'null'
        super().__init__(unit, field.least * self._factor, field.greatest * self._factor, step,
                         decimals, LEFT_OUT if self.may_be_left_out else MISSING, parent)
        default = field.default_value
        if isinstance(default, (int, float)):
            self.set_value(default * self._factor)

    def given(self):
        """Return the number in the unit of the task, None if it is not given.

        :raises ValueError: it is not a number within the limits
        """
        value = self.value()
        return None if value is None else round(value / self._factor, 6)


class TextField(LineField):
    """A text; one that begins with a bracket is a list, e.g. of places.

    :param field: :class:`mhri.base.task_views.FieldView`
    """

    def __init__(self, field, parent=None):
        super().__init__(parent)
        self.may_be_left_out = bool(field.default)
        default = field.default_value
        self.setMaxLength(_MAX_TEXT)
        self.setText('' if default is None else str(default))
        self.setPlaceholderText(field.text)

    def given(self):
        """Return the text or list, None if it is empty; raises ValueError for a broken list."""
        return typed_value(self.text())


class ChoiceField(IgnoresWheel, Combo):
    """A choice among a few words.

    :param field: :class:`mhri.base.task_views.FieldView`
    """

    def __init__(self, field, parent=None):
        super().__init__(parent)
        self.may_be_left_out = True
        for choice in field.choices:
            self.addItem(choice or LEFT_OUT, choice)
        self.setCurrentIndex(max(0, self.findData(field.default_value)))

    def given(self):
        """Return the word, None if it is not given."""
        return self.currentData() or None


class NameField(IgnoresWheel, Combo):
    """The name of a robot or a mark, chosen or typed.

    :param field: :class:`mhri.base.task_views.FieldView`
    """

    def __init__(self, field, parent=None):
        super().__init__(parent)
        self.may_be_left_out = bool(field.default)
        self.setEditable(True)
        self.setInsertPolicy(QComboBox.NoInsert)
        self.lineEdit().setMaxLength(_MAX_TEXT)
        self.lineEdit().setTextMargins(*(theme.GRID, 0) * 2)
        self.lineEdit().setPlaceholderText(_WHICH[field.name])

    def show_names(self, names):
        """Set the offered names; the present choice stays."""
        if [self.itemText(place) for place in range(self.count())] != list(names):
            text = self.currentText()
            self.clear()
            self.addItems(names)
            self.setEditText(text)

    def given(self):
        """Return the name, None if it is empty."""
        return self.currentText().strip() or None


def _class_of(field):
    """Return the widget's class for a :class:`mhri.base.task_views.FieldView`."""
    if field.is_number:
        return QuantityField
    if field.choices:
        return ChoiceField
    return NameField if field.name in _WHICH else TextField


class TaskFields(QWidget):
    """One line per field of a task: its name, the widget, and its description."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._kind = None
        self._names = {}
        self._kept = {}
        self._fields = {}
        self._inside = None
        self._build()

    def _build(self):
        """Create the layout of the fields."""
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)

    def show_kind(self, kind):
        """Show the fields of a :class:`mhri.base.task_views.KindView`; None removes them.

        The entries of a task are kept while another one is shown.
        """
        if kind == self._kind:
            return
        if self._inside is not None:
            self._inside.hide()
        self._kind = kind
        if kind is None:
            self._inside, self._fields = None, {}
        else:
            if kind not in self._kept:
                self._kept[kind] = self._make(kind)
            self._inside, self._fields = self._kept[kind]
            self._inside.show()
        self._offer()

    def _make(self, kind):
        """Make the fields of a task; return (their widget, {name: field})."""
        inside, fields = QWidget(self), {}
        grid = QGridLayout(inside)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setColumnStretch(1, 1)
        for row, field in enumerate(kind.fields):
            widget = fields[field.name] = _class_of(field)(field, inside)
            widget.setObjectName('task_field_' + field.name)
            widget.setAccessibleName('{} [{}]'.format(field.text, field.unit))
            widget.setToolTip(field.text)
            widget.setMinimumHeight(theme.touch_size(self))
            name = QLabel(field.name.replace('_', ' '), inside, textFormat=Qt.PlainText,
                          toolTip=field.text)
            name.setBuddy(widget)
            grid.addWidget(name, row, 0)
            grid.addWidget(widget, row, 1, 1, 1 if field.is_number else 3)
            if field.is_number:
                for place, (sign, steps) in enumerate((('\u2212', -1), ('+', 1)), 2):
                    grid.addWidget(self._step_button(
                        field, sign, partial(widget.step, steps)), row, place)
        self._grid.addWidget(inside, 0, 0)
        return inside, fields

    def _step_button(self, field, sign, step):
        """Make a button that makes a number larger or smaller."""
        button, side = Button(sign, self), theme.touch_size(self)
        button.setFixedSize(side, side)
        button.setFocusPolicy(Qt.NoFocus)
        button.setAutoRepeat(True)
        button.setAccessibleName('{} {}'.format(field.name, sign))
        button.clicked.connect(lambda _: step())
        return button

    def show_names(self, robots, marks=()):
        """Set the robots and marks offered by the fields."""
        self._names = {LEADER: tuple(robots), MARK: tuple(marks)}
        self._offer()

    def _offer(self):
        for name, field in self._fields.items():
            if isinstance(field, NameField):
                field.show_names(self._names.get(name, ()))

    def given(self, all_needed=True):
        """Return ({name: value}, problem as text) of the entries.

        :param all_needed: whether a required one that is missing is a problem
        """
        values = {}
        for row in self._kind.fields if self._kind else ():
            field = self._fields[row.name]
            try:
                value = field.given()
            except ValueError as error:
                return {}, '{}: {}'.format(row.name.replace('_', ' '), error)
            if value is None and all_needed and not field.may_be_left_out:
                return {}, '{} is missing: {}'.format(row.name.replace('_', ' '), row.text)
            if value is not None:
                values[row.name] = value
        return values, ''

    def let_go(self):
        """Release the keyboard focus, so that the keys drive again."""
        focus = self.focusWidget()
        if focus is not None and focus.hasFocus():
            focus.clearFocus()
