# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A part of the drawer with what was recorded: replay a session, or make its report."""
from python_qt_binding.QtCore import QAbstractListModel, QModelIndex, QRect, QSize, Qt, Signal
from python_qt_binding.QtGui import QPalette
from python_qt_binding.QtWidgets import (
    QHBoxLayout, QListView, QProgressBar, QStyledItemDelegate, QStyle, QVBoxLayout, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.labels import plain_tip, TextLine
from mhri.base.gui.wide_scroll_bar import WideScrollBar

TITLE = 'Recorded sessions'
NONE_YET = 'nothing recorded yet: R records a session'
READING = 'reading ...'


class SessionsModel(QAbstractListModel):
    """The rows of a list of sessions, :class:`mhri.session.catalogue.SessionRow` values."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._rows = ()

    def rowCount(self, parent=QModelIndex()):  # noqa: N802
        """Return how many sessions there are."""
        return 0 if parent.isValid() else len(self._rows)

    def data(self, index, role=Qt.DisplayRole):
        """Return the words of a row, for whoever cannot see it painted, or the row."""
        row = self._rows[index.row()]
        if role == Qt.UserRole:
            return row
        if role in (Qt.DisplayRole, Qt.AccessibleTextRole):
            return ', '.join((row.title, row.figures, row.words))
        return plain_tip('{}\n{}'.format(row.name, row.words)) if role == Qt.ToolTipRole else None

    def show_rows(self, rows):
        """Have these rows."""
        self.beginResetModel()
        self._rows = tuple(rows)
        self.endResetModel()

    def place_of(self, name):
        """Return the index of a session, an invalid one where it is not there."""
        for place, row in enumerate(self._rows):
            if row.name == name:
                return self.index(place)
        return QModelIndex()


class _Painter(QStyledItemDelegate):
    """Paints a session on two lines: when, how long, how large; who was there."""

    def sizeHint(self, option, index):  # noqa: N802
        """Return a height that a finger hits."""
        height = option.fontMetrics.height()
        return QSize(10 * height, max(round(2.9 * height), theme.touch_size(option.widget)))

    def paint(self, painter, option, index):
        """Paint a row."""
        row, palette, font = index.data(Qt.UserRole), option.palette, option.font
        selected = option.state & QStyle.State_Selected
        painter.save()
        if selected:
            painter.fillRect(option.rect, palette.color(QPalette.Highlight))
        ink = palette.color(QPalette.HighlightedText if selected else QPalette.WindowText)
        unit = option.fontMetrics.height()
        room = option.rect.adjusted(unit // 2, unit // 3, -unit // 2, -unit // 3)
        first = QRect(room.left(), room.top(), room.width(), unit)
        second = first.translated(0, room.height() - unit)
        painter.setPen(ink)
        painter.setFont(theme.number_font(font))
        figures = painter.fontMetrics().horizontalAdvance(row.figures)
        painter.drawText(first, Qt.AlignRight | Qt.AlignVCenter, row.figures)
        painter.setFont(theme.larger(theme.number_font(font), 1.0, bold=True))
        painter.drawText(first, Qt.AlignLeft | Qt.AlignVCenter, painter.fontMetrics().elidedText(
            row.title, Qt.ElideRight, max(1, first.width() - figures - unit)))
        painter.setFont(font)
        painter.setPen(ink if selected else theme.colour(theme.MUTED, palette))
        painter.drawText(second, Qt.AlignLeft | Qt.AlignVCenter, painter.fontMetrics().elidedText(
            row.words, Qt.ElideRight, second.width()))
        painter.setPen(theme.line_colour(palette))
        painter.drawLine(option.rect.bottomLeft(), option.rect.bottomRight())
        painter.restore()


class SessionsPage(QWidget):
    """Shows rows and says what is asked for; a host does it.

    Child widgets: ``sessions_list``, ``replay_button``, ``report_button``, ``cancel_button``,
    ``report_progress``.
    """

    #: the page has come to be seen: read again what there is
    shown = Signal()
    #: name of a session
    replay_requested = Signal(str)
    report_requested = Signal(str)
    cancel_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('sessions_page')
        self.setFont(theme.base_font(self.font()))
        self.model = SessionsModel(self)
        self.list = QListView(self)
        self.list.setObjectName('sessions_list')
        self.list.setAccessibleName('recorded sessions')
        self.list.setModel(self.model)
        self.list.setItemDelegate(_Painter(self.list))
        self.list.setVerticalScrollBar(WideScrollBar(self.list))
        self.list.setUniformItemSizes(True)
        keep_arrows(self.list)
        self.note = TextLine(self)
        self.note.setObjectName('sessions_note')
        self.note.set_wrapped(True)
        self.progress = QProgressBar(self)
        self.progress.setObjectName('report_progress')
        self.progress.setFormat('report %p %')
        self.replay_button = theme.finger_button(
            self, 'replay_button', 'Replay', 'on a screen of its own')
        self.report_button = theme.finger_button(
            self, 'report_button', 'Report', 'a page to print or send, and a map')
        self.cancel_button = theme.finger_button(self, 'cancel_button', 'Cancel report')
        buttons = QHBoxLayout()
        for button in (self.replay_button, self.report_button, self.cancel_button):
            buttons.addWidget(button)
        buttons.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, self.fontMetrics().height() // 2)
        column.addWidget(self.list, 1)
        self.list.setMinimumHeight(9 * self.fontMetrics().height())
        column.addWidget(self.progress)
        column.addWidget(self.note)
        column.addLayout(buttons)

    def _connect(self):
        """Wire buttons and list."""
        self.replay_button.clicked.connect(lambda: self.replay_requested.emit(self.chosen))
        self.report_button.clicked.connect(self._ask_report)
        self.cancel_button.clicked.connect(self.cancel_requested)
        self.list.doubleClicked.connect(lambda _: self._replay_chosen())
        self.list.selectionModel().selectionChanged.connect(lambda *_: self._show_buttons())

    def _restore(self):
        """Begin with nothing read."""
        self._reporting = False
        self.show_note(READING)
        self.show_progress(None)

    @property
    def chosen(self):
        """The name of the session that is chosen, '' for none."""
        index = self.list.currentIndex()
        return index.data(Qt.UserRole).name if index.isValid() else ''

    def _replay_chosen(self):
        """Replay by a double click what can be."""
        if self.replay_button.isEnabled():
            self.replay_requested.emit(self.chosen)

    def _ask_report(self):
        """Ask for a report, and show at once that it is under way."""
        self.show_progress(0)
        self.show_note('reading the session ...')
        self.report_requested.emit(self.chosen)

    def show_rows(self, rows):
        """Show what there is; the one that was chosen stays so."""
        chosen = self.chosen
        self.model.show_rows(rows)
        place = self.model.place_of(chosen)
        self.list.setCurrentIndex(place if place.isValid() else self.model.index(0))
        if self.note.text() in (READING, NONE_YET):
            self.show_note('' if rows else NONE_YET)
        self._show_buttons()

    def show_note(self, text):
        """Say what has come of something; where there is nothing to say, no line is kept for it."""
        self.note.show_text(text, theme.MUTED)
        self.note.setVisible(bool(text))

    def show_progress(self, percent):
        """Show how far a report is, None while none is made."""
        self._reporting = percent is not None
        self.progress.setVisible(self._reporting)
        self.progress.setValue(percent or 0)
        self._show_buttons()

    def _show_buttons(self):
        """Offer what can be done."""
        index = self.list.currentIndex()
        row = index.data(Qt.UserRole) if index.isValid() else None
        usable = row is not None and not row.problem
        self.replay_button.setEnabled(usable)
        self.report_button.setEnabled(usable)
        self.report_button.setVisible(not self._reporting)
        self.cancel_button.setVisible(self._reporting)

    def showEvent(self, event):  # noqa: N802
        """Say that somebody looks."""
        super().showEvent(event)
        self.shown.emit()
