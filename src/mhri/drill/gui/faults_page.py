# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The section to inject faults into simulated robots, for practice."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QGridLayout, QLabel

from mhri.base.gui import theme
from mhri.base.gui.choices import offer
from mhri.base.gui.controls import Button, Combo, NumberField
from mhri.base.gui.labels import plain_label, SignedText
from mhri.base.gui.layouts import add_parts, in_row
from mhri.base.gui.page import Page
from mhri.sim.faults import ALL, failing_in, FAULTS

TITLE = 'Faults'
# Default and maximum duration of a fault [s]; 0 means until ended.
FOR_S, MAX_S = 30.0, 3600.0
END_NOW = -1.0
START, END = 'Start', 'End'


def _number(name, spoken, low, high, value, unit, empty, parent):
    """Return a :class:`NumberField`."""
    field = theme.for_fingers(NumberField(unit, low, high, 0.1 if high <= 10.0 else 5.0,
                                          2 if high <= 10.0 else 0, empty, parent), name, spoken)
    field.set_value(value)
    field.setFocusPolicy(Qt.StrongFocus)
    return field


class FaultsPage(Page):
    """Values in (:meth:`show_robots`, :meth:`show_answer`), a signal out.

    Child widgets: ``fault_robot``, ``fault_duration``, a ``fault_value_<key>`` and a
    ``fault_button_<key>`` for each fault, ``fault_end_all``.
    """

    #: robot, key of a fault, value, duration [s], as in ``SetFault.srv``
    asked = Signal(str, str, float, float)

    def __init__(self):
        super().__init__('faults_page')
        self._rows = {}
        self._answers = {}
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.robot_combo = theme.for_fingers(
            Combo(self), 'fault_robot', 'Robot that fails')
        self.duration = _number('fault_duration', 'How long it fails', 0.0, MAX_S, FOR_S, 's',
                                'until ended', self)
        self.end_all_button = theme.for_fingers(Button('End all', self), 'fault_end_all')
        self.answer = SignedText(self)
        head = in_row((self.robot_combo, 1), QLabel('for', self), self.duration)
        foot = in_row((self.answer, 1), (self.end_all_button, 0, Qt.AlignTop))
        grid = QGridLayout()
        grid.setColumnStretch(0, 1)
        for place, fault in enumerate(FAULTS):
            self._add_row(grid, place, fault)
        add_parts(self.column, plain_label(self, 'Inject a fault into a simulated robot.'), head,
                  grid, foot)

    def _add_row(self, grid, place, fault):
        """Create label, value and button of a fault."""
        grid.addWidget(plain_label(self, fault.label), place, 0)
        value = None
        if fault.unit:
            value = _number('fault_value_' + fault.key, fault.label, fault.low, fault.high,
                            fault.default, fault.unit, '{:g}'.format(fault.default), self)
            grid.addWidget(value, place, 1)
        button = theme.for_fingers(Button(START, self), 'fault_button_' + fault.key)
        grid.addWidget(button, place, 2)
        self._rows[fault.key] = fault, value, button

    def _connect(self):
        """Connect the parts."""
        self.robot_combo.currentTextChanged.connect(lambda _: self._show())
        self.end_all_button.clicked.connect(lambda: self._ask(ALL, 0.0, END_NOW))
        for key, (_, _, button) in self._rows.items():
            button.clicked.connect(lambda _, key=key: self._press(key))

    def _restore(self):
        """Start without a robot."""
        self.show_robots(())

    def _press(self, key):
        """Request to start a fault, or to end it."""
        fault, value, button = self._rows[key]
        if button.text() == END:
            self._ask(key, 0.0, END_NOW)
            return
        try:
            # A dead driver must restart by itself, so the fault needs a duration.
            for_s = self.duration.value() or (FOR_S if fault.timed else 0.0)
            strength = value.value() if value else 0.0
        except ValueError as error:
            self.answer.show_text(str(error), True)
            return
        self._ask(key, fault.default if strength is None else strength, for_s)

    def _ask(self, key, value, for_s):
        if self.robot_combo.currentText():
            self.asked.emit(self.robot_combo.currentText(), key, value, for_s)

    def show_robots(self, names):
        """Offer simulated robots; keep the selection if possible."""
        offer(self.robot_combo, [(name, name) for name in names], self.robot_combo.currentData())
        self._show()

    def show_answer(self, robot, good, text):
        """Show a robot's active faults, or the reason for a refusal."""
        self._answers[robot] = good, text
        self._show()

    def _show(self):
        """Show the faults of the selected robot."""
        robot = self.robot_combo.currentText()
        good, text = self._answers.get(robot, (True, ''))
        failing = failing_in(text) if good else ()
        self.answer.show_text(text if robot else 'no simulated robot is there',
                              bool(failing) or not good)
        self.end_all_button.setEnabled(bool(robot))
        for key, (fault, _, button) in self._rows.items():
            button.setText(END if key in failing else START)
            button.setAccessibleName('{} {}'.format(button.text().lower(), fault.label))
            button.setEnabled(bool(robot))
