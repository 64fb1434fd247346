# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of robots: check to drive, click to bring a tile to the front."""
from python_qt_binding.QtCore import QEvent, QPoint, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QFrame, QLabel, QScrollArea, QWidget

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.page import WideScrollBar
from mhri.base.gui.pending import Pending
from mhri.robots.gui.robot_row import RobotRow

_ANSWER_WITHIN_S = 1.0
_EMPTY = ('No robots yet.\n\nPress "Look for Connected Bots",\n'
          'or type the name of one and press "Add Bot".')
_STEPS = {int(Qt.Key_Up): -1, int(Qt.Key_Down): 1}
# Rows for which there is always room; below that, the page around the list scrolls.
_MIN_ROWS = 3
# Rows kept above and below the visible ones, as targets of Tab and the wheel.
_SPARE_ROWS = 12


class _Inside(QWidget):
    """The scrolled content: rows of one height, or a sentence while the list is empty.

    The rows are placed without a layout, which would visit all of them whenever one changes.
    """

    def __init__(self, parent=None):
        super().__init__(parent, autoFillBackground=True)
        self._count = 0
        self._rows = {}
        self.setBackgroundRole(QPalette.Base)
        self.empty = QLabel(_EMPTY, self, alignment=Qt.AlignCenter, wordWrap=True)

    @property
    def row_height(self):
        """Height of a row [px], 0 without rows."""
        return next(iter(self._rows.values())).minimumHeight() if self._rows else 0

    def place(self, rows, count):
        """Place rows.

        :param rows: {place, from 0: :class:`RobotRow`}
        :param count: number of robots, with and without a row
        """
        self._rows, self._count = rows, count
        self.empty.setVisible(not count)
        self._fit()

    def _fit(self):
        """Follow the size of the rows."""
        self.setMinimumSize(max((row.minimumSizeHint().width() for row in self._rows.values()),
                                default=0), self._count * self.row_height)
        self._place()

    def event(self, event):
        """Follow another size of text, with which all rows become higher."""
        if event.type() == QEvent.LayoutRequest and any(
                (row.y(), row.height()) != (place * self.row_height, self.row_height)
                for place, row in self._rows.items()):
            self._fit()
            self.parentWidget().parentWidget().updateGeometry()
        return super().event(event)

    def _place(self):
        """Place the rows in the available width."""
        self.empty.setGeometry(self.rect())
        for place, row in self._rows.items():
            row.setGeometry(0, place * self.row_height, self.width(), self.row_height)

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
    """Rows of fixed height in the order of the view; only this part of the drawer ever scrolls.

    Only visible robots and some around them have a row, so that invisible robots cost nothing.

    Tab reaches the list (arrow keys highlight, Return opens, Escape removes the highlight) and
    then each check box. A second click on a row removes its highlight, too.
    """

    #: all names to be selected, in the order of the list
    selection_requested = Signal(list)
    #: the highlight moved to this robot
    activated = Signal(str)
    #: no robot is highlighted any more
    cleared = Signal()
    #: the tile of this robot is requested, without selecting it
    open_requested = Signal(str)
    #: this robot is to continue its interrupted task
    carry_on_requested = Signal(str)
    ask_requested = Signal(str)
    #: the menu of this robot, at a place on the desktop
    menu_requested = Signal(str, QPoint)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._rows = {}
        self._robots = ()
        self._wanted = ()
        #: name of the highlighted robot, or None
        self.current = None
        self._in_force = True
        self._asked = Pending(_ANSWER_WITHIN_S, self._show_again)
        self._build()

    def _build(self):
        """Make the list, empty."""
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

    def checked(self):
        """Return the names of the ticked robots, in order."""
        return [robot.name for robot in self._robots if robot.name in self._wanted]

    def row(self, name):
        """Return the :class:`RobotRow` of a robot.

        :raises KeyError: the robot has no row
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
        """Update the visible rows and those around them."""
        first, end = self._in_sight()
        for robot in self._robots[first:end]:
            if robot.name in self._rows:
                self._rows[robot.name].show_view(robot, robot.name in self._wanted, numbers)

    def _in_sight(self):
        """Return (first, end) of the places that need a row."""
        height = self._inside.row_height
        if not height:
            return 0, 1
        top, room = self.verticalScrollBar().value(), self.viewport().height()
        return (max(0, top // height - _SPARE_ROWS),
                min(len(self._robots), (top + room) // height + 1 + _SPARE_ROWS))

    def _arrange(self):
        """Drop the rows of robots that are no longer in the list; place the others."""
        names = [robot.name for robot in self._robots]
        for name in set(self._rows) - set(names):
            row = self._rows.pop(name)
            row.hide()
            row.deleteLater()
        self._place()
        # The height of the first row determines how many fit.
        self._fill()
        self._fill()
        self.updateGeometry()
        if self.current not in names:
            self._highlight(None)

    def _fill(self):
        """Make the missing rows in the visible part."""
        first, end = self._in_sight()
        missing = {place: self._robots[place].name for place in range(first, min(
            end, len(self._robots))) if self._robots[place].name not in self._rows}
        if missing:
            self._make(missing)

    def _on_scroll(self):
        """Update the rows that have come into view."""
        self._fill()
        self._show()

    def _make(self, missing):
        """Make rows: {place: name}."""
        for place, name in missing.items():
            row = self._new_row(name)
            row.show_view(self._robots[place], name in self._wanted)
            row.show_current(name == self.current)
        self._place()
        for name in missing.values():
            self._rows[name].show()

    def _place(self):
        """Place the existing rows, and chain them for Tab."""
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
        row.menu_requested.connect(self.menu_requested)
        return row

    def _show_again(self):
        """Show the confirmed selection again, once a request has been unanswered for too long."""
        self.show_robots(self._robots)

    def _on_checked(self, name, on):
        """Request the selection that the boxes show now."""
        if on != (name in self._wanted):
            self._flip(name)

    def _flip(self, name):
        """Request the selection with one robot added or removed."""
        self._select([robot.name for robot in self._robots
                      if (robot.name == name) != (robot.name in self._wanted)])

    def select_all(self):
        """Request to select every robot."""
        self._select([robot.name for robot in self._robots])

    def select_none(self):
        """Request to deselect every robot."""
        self._select([])

    def toggle(self, number):
        """Check or uncheck the robot with this number, if any."""
        for robot in self._robots:
            if robot.number == number > 0:
                self._flip(robot.name)

    def toggle_all(self):
        """Check every robot or, if all are checked, none."""
        every = [robot.name for robot in self._robots]
        self._select([] if self.checked() == every else every)

    def show_in_force(self, in_force):
        """Enable the boxes only while selections made here are accepted."""
        if in_force != self._in_force:
            self._in_force = in_force
            self._asked.drop()
            for row in self._rows.values():
                row.box.setEnabled(in_force)

    def _select(self, names):
        """Request a selection, and show it at once while the answer is pending."""
        if not self._in_force:
            return
        self._asked.ask(tuple(names))
        self.show_robots(self._robots, numbers=False)
        self.selection_requested.emit(names)

    def _on_click(self, name):
        """Highlight a robot; remove the highlight if it has it already."""
        if name == self.current:
            self.clear()
        else:
            self.activate(name)

    def clear(self):
        """Remove the highlight."""
        if self.current is not None:
            self._highlight(None)
            self.cleared.emit()

    def activate(self, name):
        """Highlight a robot, and emit :attr:`activated`."""
        self._highlight(name)
        self.activated.emit(name)

    def _highlight(self, name):
        """Move the highlight."""
        self.current = name
        for row in self._rows.values():
            row.show_current(row.name == name)
        height = self._inside.row_height
        for place, robot in enumerate(self._robots):
            if robot.name == name:
                self.ensureVisible(0, place * height + height // 2, 0, height // 2 + 1)

    def minimumSizeHint(self):  # noqa: N802
        """Return room for a few rows."""
        rows = min(len(self._robots), _MIN_ROWS) * self._inside.row_height
        return QSize(super().minimumSizeHint().width(),
                     rows + 2 * self.frameWidth() if rows else 6 * self.fontMetrics().height())

    def resizeEvent(self, event):  # noqa: N802
        """Add rows for the new height."""
        super().resizeEvent(event)
        self._fill()

    def keyPressEvent(self, event):  # noqa: N802
        """Move the highlight, or open the tile of the highlighted robot."""
        names = [robot.name for robot in self._robots]
        key = event.key()
        if key in _STEPS and names:
            place = names.index(self.current) + _STEPS[key] if self.current else 0
            self.activate(names[min(len(names) - 1, max(0, place))])
        elif key in (Qt.Key_Return, Qt.Key_Enter) and self.current:
            self.open_requested.emit(self.current)
        elif key == Qt.Key_Escape and self.current:
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
