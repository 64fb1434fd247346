# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The event list: what happened, when, to which robot; the newest at the bottom."""
from python_qt_binding.QtCore import (
    QAbstractTableModel, QModelIndex, QRectF, QSize, QSortFilterProxyModel, Qt, Signal)
from python_qt_binding.QtGui import QPainter, QPalette, QPixmap
from python_qt_binding.QtWidgets import (
    QAbstractItemView, QComboBox, QHBoxLayout, QHeaderView, QPushButton, QSizePolicy, QTableView,
    QVBoxLayout, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.labels import plain_tip
from mhri.base.gui.switches import SwitchBox
from mhri.base.gui.wide_scroll_bar import WideScrollBar
from mhri.events.events import ALARM, ATTENTION, CALM, clock_text, MOST, SEVERITIES
from mhri.events.gui.event_button import SEVERITY_SIGNS

TIME, SEVERITY, ROBOT, WHAT = range(4)
_HEADS = ('Time', 'State', 'Robot', 'What')
SEVERITY_WORDS = {CALM: 'note', ATTENTION: 'attention', ALARM: 'alarm'}
# What the second drop-down lets through: label, the least severity.
_LEAST = (('All events', CALM), ('Attention', ATTENTION), ('Alarms', ALARM))
ALL_ROBOTS = 'All robots'
NEWEST = 'Newest'
_EVENT = Qt.UserRole
# The column of names has room for the longest name, up to so many characters.
_MOST_CHARACTERS = 12
# Narrower than this [line heights], the shape of a severity goes without its word; and lines are
# three lines high.
_NARROW, _NARROWEST = 32, 24


class EventModel(QAbstractTableModel):
    """Events as rows, the oldest first; a row is made once and never drawn into again."""

    def __init__(self, parent):
        super().__init__(parent)
        self._widget = parent
        #: whether a severity is said by its word, too
        self.with_words = True
        self._events = []
        self._signs = {}

    def rowCount(self, parent=QModelIndex()):  # noqa: N802, B008
        """Return how many events there are."""
        return 0 if parent.isValid() else len(self._events)

    def columnCount(self, parent=QModelIndex()):  # noqa: N802, B008
        """Return how many columns there are."""
        return 0 if parent.isValid() else len(_HEADS)

    def headerData(self, section, orientation, role=Qt.DisplayRole):  # noqa: N802
        """Return the name of a column."""
        if role != Qt.DisplayRole or section == SEVERITY and not self.with_words:
            return None
        return _HEADS[section]

    def data(self, index, role=Qt.DisplayRole):
        """Return what a cell shows."""
        event, column = self._events[index.row()], index.column()
        if role == _EVENT:
            return event
        if role == Qt.DisplayRole:
            return self._text(event, column) if column != SEVERITY or self.with_words else ''
        if role in (Qt.ToolTipRole, Qt.AccessibleTextRole):
            words = self._text(event, column)
            return plain_tip(words) if role == Qt.ToolTipRole else words
        return self._looks(event, column, role)

    @staticmethod
    def _text(event, column):
        """Return what a cell says."""
        return (clock_text(event.time_s), SEVERITY_WORDS[event.severity], event.robot,
                event.words)[column]

    def _looks(self, event, column, role):
        """Return the shape of a severity, and that what is calm steps back."""
        if role == Qt.DecorationRole and column == SEVERITY:
            return self._sign(event.severity)
        if role == Qt.ForegroundRole and event.severity == CALM and column != WHAT:
            return theme.colour(theme.MUTED, self._widget.palette())
        return None

    def _sign(self, severity):
        """Return the shape of a severity, painted once for each look of the desktop."""
        palette, side = self._widget.palette(), self._widget.fontMetrics().height()
        scale = self._widget.devicePixelRatioF()
        shape, tone = SEVERITY_SIGNS[severity]
        ink, ground = theme.colour(tone, palette), palette.color(QPalette.Base)
        key = (severity, side, scale, ink.rgb(), ground.rgb())
        if key not in self._signs:
            picture = QPixmap(round(side * scale), round(side * scale))
            picture.setDevicePixelRatio(scale)
            picture.fill(Qt.transparent)
            painter = QPainter(picture)
            painter.setRenderHint(QPainter.Antialiasing)
            theme.paint_sign(painter, QRectF(1, 1, side - 2, side - 2), shape, ink, ground)
            painter.end()
            self._signs[key] = picture
        return self._signs[key]

    def add(self, events):
        """Append events; each takes away the row that it stands for, and the oldest go."""
        for replaced in [event.replaces for event in events if event.replaces]:
            self._drop(replaced)
        gone = {event.replaces for event in events}
        events = [event for event in events if event.number not in gone]
        first = len(self._events)
        self.beginInsertRows(QModelIndex(), first, first + len(events) - 1)
        self._events += events
        self.endInsertRows()
        surplus = len(self._events) - MOST
        if surplus > 0:
            self.beginRemoveRows(QModelIndex(), 0, surplus - 1)
            del self._events[:surplus]
            self.endRemoveRows()

    def clear(self):
        """Forget all events."""
        self.beginResetModel()
        self._events = []
        self.endResetModel()

    def _drop(self, number):
        """Take away the row of an event: one of the newest, so it is looked for from the end."""
        for row in range(len(self._events) - 1, -1, -1):
            if self._events[row].number == number:
                self.beginRemoveRows(QModelIndex(), row, row)
                del self._events[row]
                self.endRemoveRows()
                return


class EventFilter(QSortFilterProxyModel):
    """Lets through the events of one robot, or of all, from a severity on.

    What is about everything (stop all, the mode) passes for every robot.
    """

    def __init__(self, parent):
        super().__init__(parent)
        self._robot = ''
        self._severities = frozenset(SEVERITIES)

    def choose(self, robot, least):
        """Let through a robot's events ('' for all) that are at least so severe."""
        self._robot = robot
        self._severities = frozenset(SEVERITIES[SEVERITIES.index(least):])
        self.invalidateFilter()

    def filterAcceptsRow(self, row, parent):  # noqa: N802
        """Tell whether an event is let through."""
        event = self.sourceModel().index(row, 0, parent).data(_EVENT)
        return event.severity in self._severities and (
            not self._robot or event.robot in ('', self._robot))


class EventList(QWidget):
    """Filters and a switch above, lines below; follows the newest while it is in sight.

    Tab reaches the drop-downs, the switch and the lines; there arrow keys move, and Return looks at
    the robot of a line, as a click does.
    """

    #: a line of this robot was clicked: it is to be looked at
    robot_requested = Signal(str)
    #: the operator has turned to the list: opened it, pointed at it, or used it
    seen = Signal()
    #: whether tones are to be heard
    sounds_switched = Signal(bool)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._robots = ()
        self._follows = True
        self._unread = 0
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('event_list')
        self.setFont(theme.base_font(self.font()))
        self.robot_combo = self._combo('events of', [(ALL_ROBOTS, '')])
        self.severity_combo = self._combo('events that are at least', _LEAST)
        self.sounds = SwitchBox('Sounds', self)
        self.sounds.setChecked(True)
        self.sounds.setToolTip('off: only a robot that is lost while it is driven is heard')
        head = QHBoxLayout()
        head.setSpacing(round(0.5 * self.fontMetrics().height()))
        for widget, stretch in ((self.robot_combo, 1), (self.severity_combo, 1), (self.sounds, 0)):
            head.addWidget(widget, stretch)
        head.addStretch(1)
        self.model = EventModel(self)
        self.filter = EventFilter(self)
        self.filter.setSourceModel(self.model)
        self.lines = self._make_lines()
        # Over the lines, where there is something below them.
        self.newest_button = QPushButton(NEWEST, self.lines)
        self.newest_button.setFocusPolicy(Qt.TabFocus)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(head)
        column.addWidget(self.lines, 1)
        self._show_newest_button()

    def _combo(self, name, rows):
        """Make a drop-down of rows (label, value) that fingers hit."""
        combo = QComboBox(self)
        combo.setAccessibleName(name)
        combo.setToolTip(name)
        combo.setFocusPolicy(Qt.TabFocus)
        combo.setMinimumHeight(theme.touch_size(self))
        combo.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        arrow = round(1.6 * self.fontMetrics().height())
        combo.setMinimumContentsLength(0)
        combo.setMinimumWidth(theme.text_width(self.font(), rows[0][0]) + arrow)
        combo.setMaximumWidth(theme.text_width(self.font(), 'm' * _MOST_CHARACTERS) + arrow)
        combo.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        for label, value in rows:
            self._add_row(combo, label, value)
        return combo

    def _add_row(self, combo, label, value):
        """Add a row to a drop-down."""
        combo.addItem(label, value)
        combo.setItemData(combo.count() - 1, QSize(0, theme.touch_size(self)), Qt.SizeHintRole)
        # The list may be wider than its button.
        view = combo.view()
        view.setMinimumWidth(max(view.minimumWidth(), theme.text_width(self.font(), label)
                                 + theme.touch_size(self)))

    def _make_lines(self):
        """Make the list of lines."""
        lines = QTableView(self)
        lines.setModel(self.filter)
        lines.setObjectName('event_lines')
        lines.setAccessibleName('Events')
        lines.setFont(theme.number_font(self.font()))
        lines.setShowGrid(False)
        lines.setTabKeyNavigation(False)
        lines.setSelectionBehavior(QAbstractItemView.SelectRows)
        lines.setSelectionMode(QAbstractItemView.SingleSelection)
        lines.setEditTriggers(QAbstractItemView.NoEditTriggers)
        lines.setHorizontalScrollBarPolicy(Qt.ScrollBarAlwaysOff)
        lines.setVerticalScrollMode(QAbstractItemView.ScrollPerPixel)
        lines.setFocusPolicy(Qt.TabFocus)
        keep_arrows(lines)
        lines.setVerticalScrollBar(WideScrollBar(lines))
        # Of one height, which no row is asked for: a tree would ask all of them each time.
        lines.verticalHeader().setSectionResizeMode(QHeaderView.Fixed)
        lines.verticalHeader().hide()
        header = lines.horizontalHeader()
        header.setDefaultAlignment(Qt.AlignLeft | Qt.AlignVCenter)
        header.setHighlightSections(False)
        header.setSectionsClickable(False)
        header.setMinimumSectionSize(self.fontMetrics().height())
        header.setSectionResizeMode(QHeaderView.Fixed)
        header.setSectionResizeMode(WHAT, QHeaderView.Stretch)
        return lines

    def _size_columns(self):
        """Give the columns the room they need, and what is left to the text."""
        header, font = self.lines.horizontalHeader(), self.lines.font()
        unit = self.fontMetrics().height()
        names = [name[:_MOST_CHARACTERS] for name in (*self._robots, _HEADS[ROBOT])]
        self.model.with_words = self.width() >= _NARROW * unit
        rows = 2 if self.width() >= _NARROWEST * unit else 3
        self.lines.verticalHeader().setDefaultSectionSize(max(
            theme.touch_size(self), rows * self.fontMetrics().lineSpacing() + 2))
        words = SEVERITY_WORDS.values() if self.model.with_words else ('',)
        for column, needed in ((TIME, theme.text_width(font, '00:00:00') + unit // 2),
                               (SEVERITY, theme.text_width(font, *words) + 2 * unit),
                               (ROBOT, theme.text_width(font, *names) + unit)):
            header.resizeSection(column, needed)

    def _connect(self):
        """Wire the parts."""
        for combo in (self.robot_combo, self.severity_combo):
            combo.activated[int].connect(lambda *_: self._filter())
        self.sounds.clicked.connect(self.sounds_switched)
        self.newest_button.clicked.connect(self.show_newest)
        self.lines.clicked.connect(self._on_line)
        self.lines.activated.connect(self._on_line)
        self.lines.verticalScrollBar().valueChanged.connect(lambda *_: self._on_scroll())

    def add(self, events):
        """Append new events, the oldest first; costs nothing where there are none."""
        if not events:
            return
        follows = self._follows
        self.model.add(list(events))
        if follows:
            self._go_down()
        else:
            self._unread += len(events)
        self._show_newest_button()

    def show_robots(self, names):
        """Offer these robots in the filter; one that is chosen stays, though it has left."""
        chosen = self.robot_combo.currentData()
        names = tuple(names)
        if chosen and chosen not in names:
            names += (chosen,)
        if names == self._robots:
            return
        before, self._robots = self._robots, names
        rows = [(name, name) for name in names]
        if before and names[:len(before)] == before:
            rows = rows[len(before):]
        else:
            self.robot_combo.clear()
            rows.insert(0, (ALL_ROBOTS, ''))
        for label, value in rows:
            self._add_row(self.robot_combo, label, value)
        self.robot_combo.setCurrentIndex(max(0, self.robot_combo.findData(chosen)))
        self._size_columns()

    def show_sounds(self, on):
        """Show whether tones are heard."""
        self.sounds.setChecked(on)

    def show_newest(self):
        """Go to the newest line and stay with it."""
        self._go_down()
        self._show_newest_button()
        self.seen.emit()

    def _go_down(self):
        """Scroll to the end."""
        self._follows = True
        self._unread = 0
        self.lines.scrollToBottom()

    def _filter(self):
        """Show what the drop-downs choose."""
        self.filter.choose(self.robot_combo.currentData(), self.severity_combo.currentData())
        self.show_newest()

    def _on_scroll(self):
        """Follow the newest where it is in sight, and no longer where somebody has scrolled up."""
        bar = self.lines.verticalScrollBar()
        follows = bar.value() >= bar.maximum() - theme.touch_size(self) // 2
        if follows != self._follows:
            self._follows = follows
            if follows:
                self._unread = 0
            self._show_newest_button()

    def _show_newest_button(self):
        """Say how many lines have come below those in sight."""
        button, room = self.newest_button, self.lines.viewport().geometry()
        button.setText('{} ({})'.format(NEWEST, self._unread) if self._unread else NEWEST)
        touch = theme.touch_size(self)
        button.setGeometry(0, 0, theme.text_width(self.font(), button.text()) + touch, touch)
        button.move(room.right() - button.width() - 4, room.bottom() - button.height() - 4)
        button.setVisible(not self._follows)

    def _on_line(self, index):
        """Ask for the robot of a line."""
        self.seen.emit()
        robot = index.data(_EVENT).robot
        if robot:
            self.robot_requested.emit(robot)

    def showEvent(self, event):  # noqa: N802
        """Go to the newest where it was followed: rows that came unseen moved nothing."""
        super().showEvent(event)
        if self._follows:
            self.lines.scrollToBottom()
        self.seen.emit()

    def enterEvent(self, event):  # noqa: N802
        """Take note that somebody points at the list."""
        super().enterEvent(event)
        self.seen.emit()

    def resizeEvent(self, event):  # noqa: N802
        """Fill the room there is, and stay with the newest."""
        super().resizeEvent(event)
        self._size_columns()
        if self._follows:
            self.lines.scrollToBottom()
        self._show_newest_button()
