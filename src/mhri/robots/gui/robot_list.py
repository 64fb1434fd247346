# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of robots: check to drive, click to bring a window to the front."""
from python_qt_binding.QtCore import QSize, Qt, QTimer, Signal
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QFrame, QLabel, QScrollArea, QWidget

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.pending import Pending
from mhri.base.gui.wide_scroll_bar import WideScrollBar
from mhri.robots.gui.robot_row import RobotRow

_ANSWER_WITHIN_S = 1.0
_EMPTY = ('No robots yet.\n\nPress "Look for Connected Bots",\n'
          'or type the name of one and press "Add Bot".')
_STEPS = {int(Qt.Key_Up): -1, int(Qt.Key_Down): 1}
# So many rows above and below those in sight are there as well, for Tab and the wheel to go to.
_SPARE_ROWS = 12


class _Inside(QWidget):
    """What scrolls: rows of one height, one below the other, or a sentence where there is none.

    No layout places the rows: it would look at all of them whenever one changes.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._count = 0
        self._rows = {}
        self.setBackgroundRole(QPalette.Base)
        self.setAutoFillBackground(True)
        self.empty = QLabel(_EMPTY, self)
        self.empty.setAlignment(Qt.AlignCenter)
        self.empty.setWordWrap(True)

    @property
    def row_height(self):
        """Height of a row [px], 0 while there is none."""
        return next(iter(self._rows.values())).height() if self._rows else 0

    def place(self, rows, count):
        """Place rows.

        :param rows: {place, from 0: :class:`RobotRow`}
        :param count: how many robots there are, with and without a row
        """
        self._rows, self._count = rows, count
        self.empty.setVisible(not count)
        self.setMinimumSize(max((row.minimumSizeHint().width() for row in rows.values()),
                                default=0), count * self.row_height)
        self._place()

    def _place(self):
        """Place the rows in the width there is."""
        self.empty.setGeometry(self.rect())
        for place, row in self._rows.items():
            row.setGeometry(0, place * row.height(), self.width(), row.height())

    def sizeHint(self):  # noqa: N802
        """Return the size of all rows."""
        hints = [row.sizeHint() for row in self._rows.values()] or [self.empty.sizeHint()]
        return QSize(max(hint.width() for hint in hints),
                     self._count * self.row_height or hints[0].height())

    def resizeEvent(self, event):  # noqa: N802
        """Follow the width."""
        super().resizeEvent(event)
        self._place()


class RobotList(QScrollArea):
    """Rows of fixed height in the order of the view; only this part of the panel ever scrolls.

    With many robots only those in sight and some around them have a row: what a robot costs that
    nobody sees is nothing.

    Tab reaches the list (arrow keys highlight, Return opens, Escape takes the highlight away) and
    then each check box. A second click on a row takes its highlight away, too.
    """

    #: every name that should be selected now, in the order of the list
    selection_requested = Signal(list)
    #: the highlight moved to this robot
    activated = Signal(str)
    #: no robot is highlighted any more
    cleared = Signal()
    #: the window of this robot was asked for, without selecting it
    open_requested = Signal(str)
    #: this robot is to go on with the task that it was taken from
    carry_on_requested = Signal(str)
    ask_requested = Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._rows = {}
        self._robots = ()
        self._wanted = ()
        self._current = None
        self._in_force = True
        self._asked = Pending(_ANSWER_WITHIN_S)
        self._build()

    def _build(self):
        """Make the empty list."""
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.TabFocus)
        self.setAccessibleName('Robots')
        keep_arrows(self)
        self._inside = _Inside(self)
        self.setWidget(self._inside)
        self.setFrameShape(QFrame.StyledPanel)
        self.setVerticalScrollBar(WideScrollBar(self))
        self.verticalScrollBar().valueChanged.connect(lambda *_: self._on_scroll())
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
        return [robot.name for robot in self._robots if robot.name in self._wanted]

    def row(self, name):
        """Return the :class:`RobotRow` of a robot.

        :raises KeyError: there is no such robot
        """
        if name not in self._rows:
            self._make({place: robot.name for place, robot in enumerate(self._robots)
                        if robot.name == name})
        return self._rows[name]

    def show_robots(self, robots, numbers=True):
        """Show :class:`mhri.base.views.RobotView` values; ``numbers`` as for a row."""
        known, self._robots = self._robots, tuple(robots)
        self._wanted = frozenset(self._asked.settle(
            tuple(robot.name for robot in robots if robot.selected)))
        if [robot.name for robot in robots] != [robot.name for robot in known]:
            self._arrange()
        self._show(numbers)

    def _show(self, numbers=True):
        """Show the robots whose rows can be seen, or nearly."""
        first, end = self._in_sight()
        for robot in self._robots[first:end]:
            if robot.name in self._rows:
                self._rows[robot.name].show_view(robot, robot.name in self._wanted, numbers)

    def _in_sight(self):
        """Return (first, end) of the places that are to have a row."""
        height = self._inside.row_height
        if not height:
            return 0, 1
        top, room = self.verticalScrollBar().value(), self.viewport().height()
        return (max(0, top // height - _SPARE_ROWS),
                min(len(self._robots), (top + room) // height + 1 + _SPARE_ROWS))

    def _arrange(self):
        """Drop the rows of robots that are not in the list any more; place the others."""
        names = [robot.name for robot in self._robots]
        for name in set(self._rows) - set(names):
            row = self._rows.pop(name)
            row.hide()
            row.deleteLater()
        self._place()
        # The first row tells how many there is room for.
        self._fill()
        self._fill()
        if self._current not in names:
            self._highlight(None)

    def _fill(self):
        """Make the rows that are missing where the operator looks."""
        first, end = self._in_sight()
        missing = {place: self._robots[place].name for place in range(first, min(
            end, len(self._robots))) if self._robots[place].name not in self._rows}
        if missing:
            self._make(missing)

    def _on_scroll(self):
        """Bring what has come into sight up to date."""
        self._fill()
        self._show()

    def _make(self, missing):
        """Make rows: {place: name}."""
        for place, name in missing.items():
            row = self._new_row(name)
            row.show_view(self._robots[place], name in self._wanted)
            row.show_current(name == self._current)
        self._place()
        for name in missing.values():
            self._rows[name].show()

    def _place(self):
        """Place the rows there are, and let Tab go from each to the next."""
        rows = {place: self._rows[robot.name] for place, robot in enumerate(self._robots)
                if robot.name in self._rows}
        self._inside.place(rows, len(self._robots))
        previous = self
        for row in rows.values():
            QWidget.setTabOrder(previous, row.box)
            previous = row.box

    def _new_row(self, name):
        """Make a row."""
        row = self._rows[name] = RobotRow(name, self._inside)
        row.box.setEnabled(self._in_force)
        row.checked.connect(self._on_checked)
        row.clicked.connect(self._on_click)
        row.opened.connect(self.open_requested)
        row.carry_on_requested.connect(self.carry_on_requested)
        row.ask_requested.connect(self.ask_requested)
        return row

    def _show_again(self):
        """Show what is known, once a request has been unanswered for too long."""
        self.show_robots(self._robots)

    def _on_checked(self, name, on):
        """Ask for what is ticked now."""
        if on != (name in self._wanted):
            self._flip(name)

    def _flip(self, name):
        """Ask for a robot that is not checked, or for all but it."""
        self._select([robot.name for robot in self._robots
                      if (robot.name == name) != (robot.name in self._wanted)])

    def select_all(self):
        """Ask for every robot."""
        self._select([robot.name for robot in self._robots])

    def select_none(self):
        """Ask for no robot."""
        self._select([])

    def toggle(self, number):
        """Check or uncheck the robot that bears a number; one that nobody bears does nothing."""
        for robot in self._robots:
            if robot.number == number > 0:
                self._flip(robot.name)

    def toggle_all(self):
        """Check every robot or, if all are checked, none."""
        every = [robot.name for robot in self._robots]
        self._select([] if self.checked() == every else every)

    def show_in_force(self, in_force):
        """Show whether a selection that is made here counts; otherwise none can be made."""
        if in_force != self._in_force:
            self._in_force = in_force
            self._asked.drop()
            for row in self._rows.values():
                row.box.setEnabled(in_force)

    def _select(self, names):
        """Ask for a selection, and show it at once while the answer is on its way."""
        if not self._in_force:
            return
        self._asked.ask(tuple(names))
        self._answer.start()
        self.show_robots(self._robots, numbers=False)
        self.selection_requested.emit(names)

    def _on_click(self, name):
        """Highlight a robot, or none where it is the one already."""
        if name == self._current:
            self.clear()
        else:
            self.activate(name)

    def clear(self):
        """Take the highlight away."""
        if self._current is not None:
            self._highlight(None)
            self.cleared.emit()

    def activate(self, name):
        """Highlight a robot and tell of it."""
        self._highlight(name)
        self.activated.emit(name)

    def _highlight(self, name):
        """Move the highlight."""
        self._current = name
        for row in self._rows.values():
            row.show_current(row.name == name)
        height = self._inside.row_height
        for place, robot in enumerate(self._robots):
            if robot.name == name:
                self.ensureVisible(0, place * height + height // 2, 0, height // 2 + 1)

    def resizeEvent(self, event):  # noqa: N802
        """Fill the room there is now."""
        super().resizeEvent(event)
        self._fill()

    def keyPressEvent(self, event):  # noqa: N802
        """Move the highlight, or open its window."""
        names = [robot.name for robot in self._robots]
        key = event.key()
        if key in _STEPS and names:
            place = names.index(self._current) + _STEPS[key] if self._current else 0
            self.activate(names[min(len(names) - 1, max(0, place))])
        elif key in (Qt.Key_Return, Qt.Key_Enter) and self._current:
            self.open_requested.emit(self._current)
        elif key == Qt.Key_Escape and self._current:
            self.clear()
        else:
            super().keyPressEvent(event)

    def paintEvent(self, event):  # noqa: N802
        """Paint the frame of the keyboard focus."""
        super().paintEvent(event)
        if self.hasFocus():
            painter = QPainter(self.viewport())
            painter.setPen(QPen(theme.colour(theme.DRIVE, self.palette()), 2))
            painter.drawRect(self.viewport().rect().adjusted(1, 1, -1, -1))
