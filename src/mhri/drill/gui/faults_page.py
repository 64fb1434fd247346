# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where simulated robots are asked to fail, for practice: a part of the doctor's page."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import (
    QComboBox, QDoubleSpinBox, QFrame, QGridLayout, QHBoxLayout, QLabel, QPushButton, QScrollArea,
    QVBoxLayout, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.labels import Sign
from mhri.base.gui.wide_scroll_bar import WideScrollBar
from mhri.sim.faults import ALL, failing_in, FAULTS

TITLE = 'Faults'
# How long a fault lasts where nothing else is said [s]; 0 stands for "until it is ended".
FOR_S, MOST_S = 30.0, 3600.0
END_NOW = -1.0
START, END = 'Start', 'End'


class _Number(QDoubleSpinBox):
    """A number with its unit that leaves the wheel to whatever scrolls."""

    def __init__(self, low, high, value, unit, parent):
        super().__init__(parent)
        self.setDecimals(2 if high <= 10.0 else 0)
        self.setRange(low, high)
        self.setSingleStep(0.1 if high <= 10.0 else 5.0)
        self.setSuffix(' ' + unit)
        self.setValue(value)
        self.setFocusPolicy(Qt.StrongFocus)
        self.setMinimumHeight(theme.touch_size(parent))

    def wheelEvent(self, event):  # noqa: N802
        """Leave the wheel to the page."""
        event.ignore()


class FaultsPage(QWidget):
    """Values in (:meth:`show_robots`, :meth:`show_answer`), a signal out.

    Child widgets: ``fault_robot``, ``fault_duration``, a ``fault_value_<key>`` and a
    ``fault_button_<key>`` for each fault, ``fault_end_all``.
    """

    #: robot, key of a fault, value, duration [s], as in ``SetFault.srv``
    asked = Signal(str, str, float, float)
    #: whether the page can be seen now
    shown = Signal(bool)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._rows = {}
        self._answers = {}
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('faults_page')
        self.setFont(theme.base_font(self.font()))
        touch = theme.touch_size(self)
        about = self._text('Let a simulated robot fail, to practise.')
        self.robot_combo = QComboBox(self)
        self.robot_combo.setObjectName('fault_robot')
        self.robot_combo.setAccessibleName('Robot that fails')
        self.robot_combo.setFocusPolicy(Qt.TabFocus)
        self.duration = _Number(0.0, MOST_S, FOR_S, 's', self)
        self.duration.setObjectName('fault_duration')
        self.duration.setAccessibleName('How long it fails')
        self.duration.setSpecialValueText('until ended')
        self.end_all_button = QPushButton('End all', self)
        self.end_all_button.setObjectName('fault_end_all')
        self.answer_sign, self.answer_label = Sign(self), self._text('')
        for part in (self.robot_combo, self.end_all_button):
            part.setMinimumHeight(touch)
        head, foot = QHBoxLayout(), QHBoxLayout()
        head.addWidget(self.robot_combo, 1)
        head.addWidget(QLabel('for', self))
        head.addWidget(self.duration)
        foot.addWidget(self.answer_sign, 0, Qt.AlignTop)
        foot.addWidget(self.answer_label, 1)
        foot.addWidget(self.end_all_button, 0, Qt.AlignTop)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(about)
        column.addLayout(head)
        column.addWidget(self._list(), 1)
        column.addLayout(foot)

    def _list(self):
        """Make the list of faults, which scrolls."""
        area = QScrollArea(self)
        area.setFrameShape(QFrame.NoFrame)
        area.setFocusPolicy(Qt.NoFocus)
        area.setWidgetResizable(True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarAlwaysOff)
        area.setVerticalScrollBar(WideScrollBar(area))
        area.setWidget(QWidget(area))
        grid = QGridLayout(area.widget())
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setColumnStretch(0, 1)
        for place, fault in enumerate(FAULTS):
            self._add_row(grid, place, fault)
        grid.setRowStretch(len(FAULTS), 1)
        return area

    def _add_row(self, grid, place, fault):
        """Make label, value and button of a fault."""
        grid.addWidget(self._text(fault.label), place, 0)
        value = None
        if fault.unit:
            value = _Number(fault.low, fault.high, fault.default, fault.unit, self)
            value.setObjectName('fault_value_' + fault.key)
            value.setAccessibleName(fault.label)
            grid.addWidget(value, place, 1)
        button = QPushButton(START, self)
        button.setObjectName('fault_button_' + fault.key)
        button.setFocusPolicy(Qt.TabFocus)
        button.setMinimumHeight(theme.touch_size(self))
        grid.addWidget(button, place, 2)
        self._rows[fault.key] = fault, value, button

    def _text(self, text):
        label = QLabel(text, self)
        label.setTextFormat(Qt.PlainText)
        label.setWordWrap(True)
        return label

    def _connect(self):
        """Wire the parts."""
        self.robot_combo.currentTextChanged.connect(lambda _: self._show())
        self.end_all_button.clicked.connect(lambda: self._ask(ALL, 0.0, END_NOW))
        for key, (_, _, button) in self._rows.items():
            button.clicked.connect(lambda _, key=key: self._press(key))

    def _restore(self):
        """Begin without a robot."""
        self.show_robots(())

    def _press(self, key):
        """Begin a fault, or end it."""
        fault, value, button = self._rows[key]
        if button.text() == END:
            self._ask(key, 0.0, END_NOW)
            return
        # A dead driver has to come back by itself.
        for_s = self.duration.value() or (FOR_S if fault.timed else 0.0)
        self._ask(key, value.value() if value else 0.0, for_s)

    def _ask(self, key, value, for_s):
        if self.robot_combo.currentText():
            self.asked.emit(self.robot_combo.currentText(), key, value, for_s)

    def show_robots(self, names):
        """Offer simulated robots; the one that is chosen stays, where it is still there."""
        there = [self.robot_combo.itemText(place) for place in range(self.robot_combo.count())]
        if there != list(names):
            chosen = self.robot_combo.currentText()
            self.robot_combo.clear()
            self.robot_combo.addItems(names)
            self.robot_combo.setCurrentIndex(max(0, self.robot_combo.findText(chosen)))
        self._show()

    def show_answer(self, robot, good, text):
        """Show what a robot says of its faults, or why it refuses one."""
        self._answers[robot] = good, text
        self._show()

    def _show(self):
        """Show what is known of the robot that is chosen."""
        robot = self.robot_combo.currentText()
        good, text = self._answers.get(robot, (True, ''))
        failing = failing_in(text) if good else ()
        self.answer_label.setText(text if robot else 'no simulated robot is there')
        self.answer_sign.show_sign((theme.TRIANGLE, theme.ATTENTION) if failing or not good
                                   else None)
        self.end_all_button.setEnabled(bool(robot))
        for key, (fault, _, button) in self._rows.items():
            button.setText(END if key in failing else START)
            button.setAccessibleName('{} {}'.format(button.text().lower(), fault.label))
            button.setEnabled(bool(robot))

    def showEvent(self, event):  # noqa: N802
        """Tell that the page is in sight."""
        super().showEvent(event)
        self.shown.emit(True)

    def hideEvent(self, event):  # noqa: N802
        """Tell that the page is out of sight."""
        super().hideEvent(event)
        self.shown.emit(False)
