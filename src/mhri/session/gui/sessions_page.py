# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drawer's list of recorded sessions: replay one, or make its report."""
from python_qt_binding.QtCore import QRect, QSize, Qt, Signal
from python_qt_binding.QtGui import QPalette
from python_qt_binding.QtWidgets import (
    QListWidget, QListWidgetItem, QStyle, QStyledItemDelegate)

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.controls import Progress
from mhri.base.gui.labels import plain_tip, TextLine
from mhri.base.gui.layouts import add_parts, in_row
from mhri.base.gui.page import Page, WideScrollBar

TITLE = 'Recorded sessions'
NONE_YET = 'nothing recorded yet: R records a session'
READING = 'reading ...'


class _Painter(QStyledItemDelegate):
    """Paints a session on two lines: time, length and size; then robots and marks."""

    def sizeHint(self, option, index):  # noqa: N802
        """Return a row height suitable for touch."""
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
        painter.setFont(theme.larger(theme.number_font(font), theme.BODY, bold=True))
        painter.drawText(first, Qt.AlignLeft | Qt.AlignVCenter, painter.fontMetrics().elidedText(
            row.title, Qt.ElideRight, max(1, first.width() - figures - unit)))
        painter.setFont(font)
        painter.setPen(ink if selected else theme.colour(theme.MUTED, palette))
        painter.drawText(second, Qt.AlignLeft | Qt.AlignVCenter, painter.fontMetrics().elidedText(
            row.words, Qt.ElideRight, second.width()))
        painter.setPen(theme.line_colour(palette))
        painter.drawLine(option.rect.bottomLeft(), option.rect.bottomRight())
        painter.restore()


class SessionsPage(Page):
    """Shows rows and emits requests; a presenter carries them out.

    Child widgets: ``sessions_list``, ``replay_button``, ``report_button``, ``cancel_button``,
    ``report_progress``.
    """

    #: name of a session
    replay_requested = Signal(str)
    report_requested = Signal(str)
    cancel_requested = Signal()

    def __init__(self, parent=None):
        super().__init__('sessions_page', parent)
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.list = QListWidget(self, objectName='sessions_list',
                                accessibleName='recorded sessions')
        self.list.setItemDelegate(_Painter(self.list))
        self.list.setVerticalScrollBar(WideScrollBar(self.list))
        self.list.setUniformItemSizes(True)
        keep_arrows(self.list)
        self.note = TextLine(self)
        self.note.setObjectName('sessions_note')
        self.note.set_wrapped(True)
        self.progress = Progress(self, objectName='report_progress')
        self.progress.setFormat('report %p %')
        self.replay_button = theme.finger_button(
            self, 'replay_button', 'Replay', 'on a screen of its own').set_icon('play')
        self.report_button = theme.finger_button(
            self, 'report_button', 'Report', 'a page to print or send, and a map').set_icon(
                'file-text')
        self.cancel_button = theme.finger_button(self, 'cancel_button', 'Cancel report')
        self.column.setContentsMargins(0, 0, 0, self.fontMetrics().height() // 2)
        self.list.setMinimumHeight(9 * self.fontMetrics().height())
        buttons = in_row(self.replay_button, self.report_button, self.cancel_button, 1)
        add_parts(self.column, (self.list, 1), self.progress, self.note, buttons)

    def _connect(self):
        """Connect buttons and list."""
        self.replay_button.clicked.connect(lambda: self.replay_requested.emit(self.chosen))
        self.report_button.clicked.connect(self._ask_report)
        self.cancel_button.clicked.connect(self.cancel_requested)
        self.list.doubleClicked.connect(lambda _: self._replay_chosen())
        self.list.selectionModel().selectionChanged.connect(lambda *_: self._show_buttons())

    def _restore(self):
        """Start with no sessions."""
        self._reporting = False
        self.show_note(READING)
        self.show_progress(None)

    @property
    def chosen(self):
        """The name of the selected session, '' if none."""
        index = self.list.currentIndex()
        return index.data(Qt.UserRole).name if index.isValid() else ''

    def _replay_chosen(self):
        """Replay the double-clicked session if it can be replayed."""
        if self.replay_button.isEnabled():
            self.replay_requested.emit(self.chosen)

    def _ask_report(self):
        """Request a report, and show progress at once."""
        self.show_progress(0)
        self.show_note('reading the session ...')
        self.report_requested.emit(self.chosen)

    def show_rows(self, rows):
        """Show the sessions; keep the selection."""
        chosen = self.chosen
        self.list.clear()
        for row in rows:
            # Its text is for screen readers.
            item = QListWidgetItem(', '.join((row.title, row.figures, row.words)), self.list)
            item.setData(Qt.UserRole, row)
            item.setToolTip(plain_tip('{}\n{}'.format(row.name, row.words)))
        names = [row.name for row in rows]
        self.list.setCurrentRow(names.index(chosen) if chosen in names else 0)
        if self.note.text() in (READING, NONE_YET):
            self.show_note('' if rows else NONE_YET)
        self._show_buttons()

    def show_note(self, text):
        """Show the outcome of a request; hide the note if the text is empty."""
        self.note.show_text(text, theme.MUTED)
        self.note.setVisible(bool(text))

    def show_progress(self, percent):
        """Show the progress of a report [%]; None if no report is being made."""
        self._reporting = percent is not None
        self.progress.setVisible(self._reporting)
        self.progress.setValue(percent or 0)
        self._show_buttons()

    def _show_buttons(self):
        """Enable the buttons that apply."""
        index = self.list.currentIndex()
        row = index.data(Qt.UserRole) if index.isValid() else None
        usable = row is not None and not row.problem
        self.replay_button.setEnabled(usable)
        self.report_button.setEnabled(usable)
        self.report_button.setVisible(not self._reporting)
        self.cancel_button.setVisible(self._reporting)
