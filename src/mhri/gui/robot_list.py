# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of robots: check to drive, click to bring a window to the front."""
from python_qt_binding.QtCore import Qt, QTimer, Signal
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QFrame, QLabel, QScrollArea, QVBoxLayout, QWidget

from mhri.gui import theme
from mhri.gui.drive_keys import keep_arrows
from mhri.gui.pending import Pending
from mhri.gui.robot_row import RobotRow

_ANSWER_WITHIN_S = 1.0
_EMPTY = ('No robots yet.\n\nPress "Look for Connected Bots",\n'
          'or type the name of one and press "Add Bot".')
_STEPS = {int(Qt.Key_Up): -1, int(Qt.Key_Down): 1}


class RobotList(QScrollArea):
    """Rows of fixed height in the order of the view; only this part of the panel ever scrolls.

    Tab reaches the list (arrow keys highlight, Return opens) and then each check box.
    """

    #: every name that should be selected now, in the order of the list
    selection_requested = Signal(list)
    #: the highlight moved to this robot
    activated = Signal(str)
    #: the window of this robot was asked for, without selecting it
    open_requested = Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._rows = {}
        self._robots = ()
        self._current = None
        self._asked = Pending(_ANSWER_WITHIN_S)
        self._build()

    def _build(self):
        """Make the empty list."""
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.TabFocus)
        self.setAccessibleName('Robots')
        keep_arrows(self)
        self._inside = QWidget(self)
        self._inside.setBackgroundRole(QPalette.Base)
        self._inside.setAutoFillBackground(True)
        self._column = QVBoxLayout(self._inside)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(0)
        self._empty = QLabel(_EMPTY, self._inside)
        self._empty.setAlignment(Qt.AlignCenter)
        self._empty.setWordWrap(True)
        self._column.addWidget(self._empty, 1)
        self._column.addStretch()
        self.setWidget(self._inside)
        self.setFrameShape(QFrame.StyledPanel)
        self.verticalScrollBar().setStyleSheet('QScrollBar:vertical {{ width: {}px; }}'.format(
            round(0.6 * theme.touch_size(self))))
        self._answer = QTimer(self)
        self._answer.setSingleShot(True)
        # A coarse one may come too early to find the request too old.
        self._answer.setTimerType(Qt.PreciseTimer)
        self._answer.setInterval(round(_ANSWER_WITHIN_S * 1000) + 20)
        self._answer.timeout.connect(self._show_again)

    @property
    def current(self):
        """Name of the highlighted robot, or None."""
        return self._current

    def checked(self):
        """Return the names of the ticked robots, in order."""
        return [robot.name for robot in self._robots if self._rows[robot.name].box.isChecked()]

    def row(self, name):
        """Return the :class:`RobotRow` of a robot."""
        return self._rows[name]

    def show_robots(self, robots, numbers=True):
        """Show :class:`mhri.core.views.RobotView` values; ``numbers`` as for a row."""
        if [robot.name for robot in robots] != [robot.name for robot in self._robots]:
            self._arrange(robots)
        self._robots = tuple(robots)
        wanted = self._asked.settle(tuple(robot.name for robot in robots if robot.selected))
        for place, robot in enumerate(robots, 1):
            self._rows[robot.name].show_view(robot, place, robot.name in wanted, numbers)

    def _arrange(self, robots):
        """Make, drop and order rows."""
        names = [robot.name for robot in robots]
        for name in set(self._rows) - set(names):
            row = self._rows.pop(name)
            self._column.removeWidget(row)
            row.hide()
            row.deleteLater()
        previous = self
        for place, name in enumerate(names):
            row = self._rows.get(name) or self._new_row(name)
            self._column.insertWidget(place, row)
            row.show()
            QWidget.setTabOrder(previous, row.box)
            previous = row.box
        self._empty.setVisible(not names)
        if self._current not in names:
            self._highlight(None)

    def _new_row(self, name):
        """Make a row."""
        row = self._rows[name] = RobotRow(name, self._inside)
        row.checked.connect(self._on_checked)
        row.clicked.connect(self.activate)
        row.opened.connect(self.open_requested)
        return row

    def _show_again(self):
        """Show what is known, once a request has been unanswered for too long."""
        self.show_robots(self._robots)

    def _on_checked(self, name, on):
        """Ask for what is ticked now."""
        self._select(self.checked())

    def select_all(self):
        """Ask for every robot."""
        self._select([robot.name for robot in self._robots])

    def select_none(self):
        """Ask for no robot."""
        self._select([])

    def toggle(self, number):
        """Check or uncheck the robot of a number, from 1; a number without a robot does nothing."""
        if 1 <= number <= len(self._robots):
            name = self._robots[number - 1].name
            self._select([robot.name for robot in self._robots
                          if (robot.name == name) != self._rows[robot.name].box.isChecked()])

    def toggle_all(self):
        """Check every robot or, if all are checked, none."""
        every = [robot.name for robot in self._robots]
        self._select([] if self.checked() == every else every)

    def _select(self, names):
        """Ask for a selection, and show it at once while the answer is on its way."""
        self._asked.ask(tuple(names))
        self._answer.start()
        self.show_robots(self._robots, numbers=False)
        self.selection_requested.emit(names)

    def activate(self, name):
        """Highlight a robot and tell of it."""
        self._highlight(name)
        self.activated.emit(name)

    def _highlight(self, name):
        """Move the highlight."""
        self._current = name
        for row in self._rows.values():
            row.show_current(row.name == name)
        if name is not None:
            self.ensureWidgetVisible(self._rows[name], 0, 0)

    def keyPressEvent(self, event):  # noqa: N802
        """Move the highlight, or open its window."""
        names = [robot.name for robot in self._robots]
        key = event.key()
        if key in _STEPS and names:
            place = names.index(self._current) + _STEPS[key] if self._current else 0
            self.activate(names[min(len(names) - 1, max(0, place))])
        elif key in (Qt.Key_Return, Qt.Key_Enter) and self._current:
            self.open_requested.emit(self._current)
        else:
            super().keyPressEvent(event)

    def paintEvent(self, event):  # noqa: N802
        """Paint the frame of the keyboard focus."""
        super().paintEvent(event)
        if self.hasFocus():
            painter = QPainter(self.viewport())
            painter.setPen(QPen(theme.colour(theme.DRIVE, self.palette()), 2))
            painter.drawRect(self.viewport().rect().adjusted(1, 1, -1, -1))
