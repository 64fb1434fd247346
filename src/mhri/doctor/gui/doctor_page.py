# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the doctor found, each with the command that mends it."""
from html import escape

from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtGui import QGuiApplication
from python_qt_binding.QtWidgets import (
    QHBoxLayout, QPushButton, QTextBrowser, QVBoxLayout, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.labels import TextLine
from mhri.doctor.facts import FAULT, FINE, WARNING
from mhri.doctor.judgement import as_lines

# Shapes as well as colours, those of the states of a robot.
_MARKS = {FAULT: ('\u2612', theme.STOP), WARNING: ('\u25b2', theme.ATTENTION),
          FINE: ('\u25cf', theme.LIVE)}
EXAMINE, EXAMINE_AGAIN = 'Examine', 'Examine again'
NOT_YET = 'Examines network, master and robots in 3 s at most, while everything goes on.'


class DoctorPage(QWidget):
    """A page beside the pictures: robots may move while it is read."""

    #: "Examine again"
    examine_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._findings = None
        self._took_s = 0.0
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('doctor_page')
        self.setFont(theme.base_font(self.font()))
        self.summary = TextLine(self)
        self.summary.setFont(theme.larger(self.font(), 1.2, bold=True))
        self.again_button = QPushButton(EXAMINE, self)
        self.again_button.setMinimumWidth(theme.touch_size(self) // 2 + theme.text_width(
            self.font(), EXAMINE_AGAIN))
        self.copy_button = QPushButton('Copy', self)
        for button in (self.again_button, self.copy_button):
            button.setMinimumHeight(theme.touch_size(self))
            button.setFocusPolicy(Qt.TabFocus)
        self.text = QTextBrowser(self)
        self.text.setOpenLinks(False)
        self.text.setPlaceholderText(NOT_YET)
        head = self._head = QHBoxLayout()
        head.addWidget(self.again_button)
        head.addWidget(self.copy_button)
        head.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.summary)
        column.addLayout(head)
        column.addWidget(self.text, 1)

    def _connect(self):
        """Wire the buttons."""
        self.again_button.clicked.connect(self.examine_requested)
        self.copy_button.clicked.connect(self._copy)

    def add_part(self, title, part):
        """Give the page a further part, in the place of what was found; return its button.

        :param title: of the button that shows it, and hides it again
        """
        button = QPushButton(title, self)
        button.setCheckable(True)
        button.setMinimumHeight(theme.touch_size(self))
        button.setFocusPolicy(Qt.TabFocus)
        self._head.insertWidget(self._head.count() - 1, button)
        self.layout().addWidget(part, 1)
        part.hide()
        button.toggled.connect(part.setVisible)
        for own in (self.text, self.summary):
            button.toggled.connect(own.setHidden)
        return button

    def show_busy(self):
        """Say that the examination is under way; what was found before stays to be read."""
        self.summary.show_text('examining, 3 s at most ...', theme.MUTED)
        self.again_button.setEnabled(False)
        self.copy_button.setEnabled(self._findings is not None)

    def show_findings(self, findings, took_s):
        """Show what was found.

        :param findings: list of :class:`mhri.doctor.facts.Finding`, the worst first
        :param took_s: how long it took [s]
        """
        self._findings, self._took_s = findings, took_s
        self.again_button.setText(EXAMINE_AGAIN)
        bad = [item for item in findings if item.severity != FINE]
        faults = sum(item.severity == FAULT for item in bad)
        self.summary.show_text(
            '{}, {}'.format(_count(faults, 'fault'), _count(len(bad) - faults, 'warning'))
            if bad else 'nothing is wrong')
        fine = [item for item in findings if item.severity == FINE]
        self.text.setHtml(''.join(self._entry(item) for item in bad) + ''.join(
            '<p>{} {}: {}</p>'.format(self._mark(FINE), escape(item.about), escape(item.problem))
            for item in fine))
        self._allow()

    def show_failure(self, sentence):
        """Say why nothing could be examined."""
        self.summary.show_text(sentence)
        self._allow()

    def _allow(self):
        """Let the operator ask again."""
        self.again_button.setEnabled(True)
        self.copy_button.setEnabled(self._findings is not None)

    def _entry(self, item):
        """Return one finding as HTML."""
        rows = ''.join('<br>{}: {}'.format(key, text) for key, text in (
            ('shows as', escape(item.shows)),
            ('mend', '<b>{}</b>'.format(escape(item.remedy)) if item.remedy else ''),
            ('sure', escape(item.sure))) if text)
        return '<p>{} <b>{}</b>: {}{}</p>'.format(
            self._mark(item.severity), escape(item.about), escape(item.problem), rows)

    def _mark(self, severity):
        """Return the shape of a severity in its colour."""
        shape, tone = _MARKS[severity]
        return '<span style="color:{}">{}</span>'.format(
            theme.colour(tone, self.palette()).name(), shape)

    def _copy(self):
        """Put the report on the clipboard, as ``mhri_doctor`` prints it."""
        QGuiApplication.clipboard().setText('\n'.join(as_lines(self._findings, self._took_s)))


def _count(number, word):
    """Return a number with its word, e.g. "1 fault", "no warnings"."""
    return '{} {}{}'.format(number or 'no', word, '' if number == 1 else 's')
