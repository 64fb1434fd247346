# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The event list: time, severity, robot and text, with the newest at the bottom."""
from python_qt_binding.QtCore import (
    QAbstractTableModel, QModelIndex, QRectF, QSize, QSortFilterProxyModel, Qt, Signal)
from python_qt_binding.QtGui import QPalette, QPixmap
from python_qt_binding.QtWidgets import (
    QAbstractItemView, QComboBox, QHeaderView, QSizePolicy, QTableView, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.controls import Button, Combo, Head
from mhri.base.gui.labels import plain_tip, TextLine
from mhri.base.gui.layouts import in_column, in_row, TIGHT
from mhri.base.gui.page import WideScrollBar
from mhri.base.gui.switches import SwitchBox
from mhri.events.events import ALARM, ATTENTION, CALM, clock_text, MARKED, MOST, SEVERITIES
from mhri.events.gui.event_button import SEVERITY_SIGNS

TIME, SEVERITY, ROBOT, WHAT = range(4)
_HEADS = ('Time', 'State', 'Robot', 'What')
SEVERITY_WORDS = {CALM: 'note', ATTENTION: 'attention', ALARM: 'alarm'}
# Rows of the second drop-down: (label, minimum severity, or the kind of a mark).
_LEAST = (('All events', CALM), ('Attention', ATTENTION), ('Alarms', ALARM), ('Marks', MARKED))
ALL_ROBOTS = 'All robots'
NEWEST = 'Newest'
_EVENT = Qt.UserRole
# Maximum width of the column of names [characters].
_MAX_CHARACTERS = 12
# Below this width [line heights], severities are shown without words.
_NARROW = 32
# Height of a row [px], as long as a line of text fits; number of rows that are always in sight.
ROW_PX, _MIN_ROWS = 28, 6


class EventModel(QAbstractTableModel):
    """Events as rows, the oldest first; a row never changes."""

    def __init__(self, parent):
        super().__init__(parent)
        self._widget = parent
        #: whether severities are shown with words
        self.with_words = True
        self._events = []
        self._signs = {}

    def rowCount(self, parent=QModelIndex()):  # noqa: N802, B008
        """Return the number of events."""
        return 0 if parent.isValid() else len(self._events)

    def columnCount(self, parent=QModelIndex()):  # noqa: N802, B008
        """Return the number of columns."""
        return 0 if parent.isValid() else len(_HEADS)

    def headerData(self, section, orientation, role=Qt.DisplayRole):  # noqa: N802
        """Return the name of a column."""
        if role != Qt.DisplayRole or section == SEVERITY and not self.with_words:
            return None
        return _HEADS[section]

    def data(self, index, role=Qt.DisplayRole):
        """Return the data of a cell for a role."""
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
        """Return the text of a cell."""
        return (clock_text(event.time_s), SEVERITY_WORDS[event.severity], event.robot,
                event.words)[column]

    def _looks(self, event, column, role):
        """Return the shape of a severity, and a muted colour for calm events."""
        if role == Qt.DecorationRole and column == SEVERITY:
            return self._sign(event.severity)
        if role == Qt.ForegroundRole and event.severity == CALM and column != WHAT:
            return theme.colour(theme.MUTED, self._widget.palette())
        return None

    def _sign(self, severity):
        """Return the shape of a severity, painted once per combination of colours and size."""
        palette, side = self._widget.palette(), self._widget.fontMetrics().height()
        scale = self._widget.devicePixelRatioF()
        shape, tone = SEVERITY_SIGNS[severity]
        ink, ground = theme.colour(tone, palette), palette.color(QPalette.Base)
        key = (severity, side, scale, ink.rgb(), ground.rgb())
        if key not in self._signs:
            picture = QPixmap(round(side * scale), round(side * scale))
            picture.setDevicePixelRatio(scale)
            picture.fill(Qt.transparent)
            painter = theme.smooth_painter(picture)
            theme.paint_sign(painter, QRectF(1, 1, side - 2, side - 2), shape, ink, ground)
            painter.end()
            self._signs[key] = picture
        return self._signs[key]

    def add(self, events):
        """Append events; remove the rows that they repeat, and the oldest beyond the maximum."""
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
        """Remove all events."""
        self.beginResetModel()
        self._events = []
        self.endResetModel()

    def _drop(self, number):
        """Remove the row of an event, searching from the end, as it is a recent one."""
        for row in range(len(self._events) - 1, -1, -1):
            if self._events[row].number == number:
                self.beginRemoveRows(QModelIndex(), row, row)
                del self._events[row]
                self.endRemoveRows()
                return


class EventFilter(QSortFilterProxyModel):
    """Filters by robot and by severity, or to the marks alone.

    Events of the whole screen (STOP ALL, the mode) pass for every robot.
    """

    def __init__(self, parent):
        super().__init__(parent)
        self._robot = ''
        self._severities = frozenset(SEVERITIES)
        self._marks = False

    def choose(self, robot, least):
        """Show a robot's events ('' for all) of at least this severity; MARKED: the marks."""
        self._robot = robot
        self._marks = least == MARKED
        self._severities = frozenset(
            SEVERITIES if self._marks else SEVERITIES[SEVERITIES.index(least):])
        self.invalidateFilter()

    def filterAcceptsRow(self, row, parent):  # noqa: N802
        """Return whether an event is shown."""
        event = self.sourceModel().index(row, 0, parent).data(_EVENT)
        return event.severity in self._severities and (
            not self._marks or event.kind == MARKED) and (
            not self._robot or event.robot in ('', self._robot))


class EventList(QWidget):
    """Filters and a switch above, lines below; follows the newest line while it is visible.

    Below the lines is the whole text of the current one.

    Tab reaches the drop-downs, the switch and the lines. In the lines, arrow keys move, and Return
    or a click requests the robot of a line.
    """

    #: a line was clicked or activated: name of its robot, to be shown large
    robot_requested = Signal(str)
    #: the operator opened, pointed at or used the list
    seen = Signal()
    #: tones were switched on or off
    sounds_switched = Signal(bool)

    def __init__(self):
        super().__init__()
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
        self.sounds.setToolTip('off: the only sound is for a robot lost while you drive it')
        head = in_row((self.robot_combo, 1), (self.severity_combo, 1), self.sounds, 1,
                      gap=round(0.5 * self.fontMetrics().height()))
        self.model = EventModel(self)
        self.filter = EventFilter(self)
        self.filter.setSourceModel(self.model)
        self.lines = self._make_lines()
        # Shown over the lines if there are more below.
        self.newest_button = Button(NEWEST, self.lines, focusPolicy=Qt.TabFocus)
        # Its place is reserved, so that no line moves below the pointer.
        self.whole_line = TextLine(self)
        self.whole_line.setObjectName('whole_line')
        self.whole_line.setAlignment(Qt.AlignLeft | Qt.AlignTop)
        self.whole_line.set_wrapped(True)
        in_column(head, (self.lines, 1), self.whole_line, of=self, margins=TIGHT, gap=theme.GRID)
        self._show_newest_button()

    def _combo(self, name, rows):
        """Create a drop-down of rows (label, value) suitable for touch."""
        combo = theme.for_fingers(Combo(self), '', name, name)
        combo.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        arrow = 2 * self.fontMetrics().height()
        combo.setMinimumContentsLength(0)
        combo.setMinimumWidth(theme.text_width(self.font(), rows[0][0]) + arrow)
        combo.setMaximumWidth(theme.text_width(self.font(), 'm' * _MAX_CHARACTERS) + arrow)
        combo.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        for label, value in rows:
            self._add_row(combo, label, value)
        return combo

    def _add_row(self, combo, label, value):
        """Add a row to a drop-down."""
        combo.addItem(label, value)
        combo.setItemData(combo.count() - 1, QSize(0, theme.touch_size(self)), Qt.SizeHintRole)
        # The opened list may be wider than the button.
        view = combo.view()
        view.setMinimumWidth(max(view.minimumWidth(), theme.text_width(self.font(), label)
                                 + theme.touch_size(self)))

    def _make_lines(self):
        """Create the table of lines."""
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
        # A table with fixed row height; a tree would compute the height of each row every time.
        lines.verticalHeader().setSectionResizeMode(QHeaderView.Fixed)
        lines.verticalHeader().hide()
        header = Head(Qt.Horizontal, lines)
        lines.setHorizontalHeader(header)
        header.setDefaultAlignment(Qt.AlignLeft | Qt.AlignVCenter)
        header.setHighlightSections(False)
        header.setSectionsClickable(False)
        header.setMinimumSectionSize(self.fontMetrics().height())
        header.setSectionResizeMode(QHeaderView.Fixed)
        header.setSectionResizeMode(WHAT, QHeaderView.Stretch)
        return lines

    def _size_columns(self):
        """Set the columns to their required widths, and give the rest to the text."""
        header, font = self.lines.horizontalHeader(), self.lines.font()
        unit = self.fontMetrics().height()
        names = [name[:_MAX_CHARACTERS] for name in (*self._robots, _HEADS[ROBOT])]
        self.model.with_words = self.width() >= _NARROW * unit
        row_px = max(ROW_PX, self.fontMetrics().lineSpacing() + 2 * theme.GRID)
        self.lines.verticalHeader().setDefaultSectionSize(row_px)
        self.lines.setMinimumHeight((_MIN_ROWS + 1) * row_px)
        words = SEVERITY_WORDS.values() if self.model.with_words else ('',)
        for column, needed in ((TIME, theme.text_width(font, '00:00:00') + unit // 2),
                               (SEVERITY, theme.text_width(font, *words) + 2 * unit),
                               (ROBOT, theme.text_width(font, *names) + unit)):
            header.resizeSection(column, needed)

    def _connect(self):
        """Connect the parts."""
        for combo in (self.robot_combo, self.severity_combo):
            combo.activated[int].connect(lambda *_: self._filter())
        self.sounds.clicked.connect(self.sounds_switched)
        self.newest_button.clicked.connect(self.show_newest)
        self.lines.clicked.connect(self._on_line)
        self.lines.activated.connect(self._on_line)
        self.lines.selectionModel().currentRowChanged.connect(self._show_whole)
        self.lines.verticalScrollBar().valueChanged.connect(lambda *_: self._on_scroll())

    def _show_whole(self, index, *_):
        """Show the whole text of the current line below the lines, which cut it off."""
        event = index.data(_EVENT) if index.isValid() else None
        self.whole_line.show_text('' if event is None else ': '.join(filter(None, (
            event.robot, event.words))))

    def add(self, events):
        """Append new events, the oldest first; return early if there are none."""
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
        """Offer these robots in the filter; keep the chosen one, even if it was removed."""
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
        """Show whether tones are on."""
        self.sounds.setChecked(on)

    def show_newest(self):
        """Go to the newest line and follow it."""
        self._go_down()
        self._show_newest_button()
        self.seen.emit()

    def _go_down(self):
        """Scroll to the end."""
        self._follows = True
        self._unread = 0
        self.lines.scrollToBottom()

    def _filter(self):
        """Apply the choices of the drop-downs."""
        self.filter.choose(self.robot_combo.currentData(), self.severity_combo.currentData())
        self.show_newest()

    def _on_scroll(self):
        """Follow the newest line while it is visible, not after scrolling up."""
        bar = self.lines.verticalScrollBar()
        follows = bar.value() >= bar.maximum() - theme.touch_size(self) // 2
        if follows != self._follows:
            self._follows = follows
            if follows:
                self._unread = 0
            self._show_newest_button()

    def _show_newest_button(self):
        """Show the button with the number of new lines below the visible ones."""
        button, room = self.newest_button, self.lines.viewport().geometry()
        button.setText('{} ({})'.format(NEWEST, self._unread) if self._unread else NEWEST)
        touch = theme.touch_size(self)
        button.setGeometry(0, 0, theme.text_width(self.font(), button.text()) + touch, touch)
        button.move(room.right() - button.width() - 4, room.bottom() - button.height() - 4)
        button.setVisible(not self._follows)

    def _on_line(self, index):
        """Request the robot of a line."""
        self.seen.emit()
        robot = index.data(_EVENT).robot
        if robot:
            self.robot_requested.emit(robot)

    def showEvent(self, event):  # noqa: N802
        """Go to the newest line if followed, as rows added while hidden did not scroll."""
        super().showEvent(event)
        if self._follows:
            self.lines.scrollToBottom()
        self.seen.emit()

    def enterEvent(self, event):  # noqa: N802
        """Emit ``seen``, because the pointer is over the list."""
        super().enterEvent(event)
        self.seen.emit()

    def resizeEvent(self, event):  # noqa: N802
        """Fit the columns to the width, and keep following the newest line."""
        super().resizeEvent(event)
        self._size_columns()
        if self._follows:
            self.lines.scrollToBottom()
        self._show_newest_button()
