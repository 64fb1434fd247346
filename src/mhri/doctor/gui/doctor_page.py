# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor's findings, each with the command that fixes it."""
from html import escape

from python_qt_binding.QtCore import Signal
from python_qt_binding.QtGui import QGuiApplication
from python_qt_binding.QtWidgets import QTextBrowser

from mhri.base.gui import theme
from mhri.base.gui.controls import Button
from mhri.base.gui.labels import TextLine
from mhri.base.gui.layouts import add_parts, in_row
from mhri.base.gui.page import Page
from mhri.doctor.facts import FAULT, FINE, WARNING
from mhri.doctor.judgement import as_lines

# Shapes as well as colours, the same as for the states of a robot.
_MARKS = {FAULT: ('\u2612', theme.STOP), WARNING: ('\u25b2', theme.ATTENTION),
          FINE: ('\u25cf', theme.LIVE)}
EXAMINE, EXAMINE_AGAIN = 'Examine', 'Examine again'
# Minimum height of the findings [line heights].
_TEXT_UNITS = 12
NOT_YET = 'Examines network, master and robots in 3 s at most; nothing is interrupted.'


class DoctorPage(Page):
    """A page beside the pictures, which stay visible: robots may move meanwhile."""

    #: "Examine again"
    examine_requested = Signal()

    def __init__(self, parent=None):
        super().__init__('doctor_page', parent)
        self._findings = None
        self._took_s = 0.0
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.summary = TextLine(self)
        self.summary.setFont(theme.larger(self.font(), theme.HEAD, bold=True))
        self.again_button = theme.finger_button(
            self, '', EXAMINE, also=EXAMINE_AGAIN, room=0.5)
        self.copy_button = theme.for_fingers(Button('Copy', self)).set_icon('copy')
        self.text = QTextBrowser(self)
        self.text.setOpenLinks(False)
        self.text.setMinimumHeight(_TEXT_UNITS * self.fontMetrics().height())
        self.text.setPlaceholderText(NOT_YET)
        head = in_row(self.again_button, self.copy_button, 1)
        add_parts(self.column, self.summary, head, (self.text, 1))

    def _connect(self):
        """Wire the buttons."""
        self.again_button.clicked.connect(self.examine_requested)
        self.copy_button.clicked.connect(self._copy)

    def show_busy(self):
        """Show that an examination is in progress; earlier findings stay visible."""
        self.summary.show_text('examining, 3 s at most ...', theme.MUTED)
        self.again_button.setEnabled(False)
        self.copy_button.setEnabled(self._findings is not None)

    def show_findings(self, findings, took_s):
        """Show the findings.

        :param findings: list of :class:`mhri.doctor.facts.Finding`, the worst first
        :param took_s: duration of the examination [s]
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
        """Show why the examination failed."""
        self.summary.show_text(sentence)
        self._allow()

    def _allow(self):
        """Enable the buttons."""
        self.again_button.setEnabled(True)
        self.copy_button.setEnabled(self._findings is not None)

    def _entry(self, item):
        """Return one finding as HTML."""
        rows = ''.join('<br>{}: {}'.format(key, text) for key, text in (
            ('symptom', escape(item.symptom)),
            ('fix', '<b>{}</b>'.format(escape(item.remedy)) if item.remedy else ''),
            ('confidence', escape(item.confidence))) if text)
        return '<p>{} <b>{}</b>: {}{}</p>'.format(
            self._mark(item.severity), escape(item.about), escape(item.problem), rows)

    def _mark(self, severity):
        """Return the symbol of a severity in its colour, as HTML."""
        shape, tone = _MARKS[severity]
        return '<span style="color:{}">{}</span>'.format(
            theme.colour(tone, self.palette()).name(), shape)

    def _copy(self):
        """Copy the report to the clipboard, formatted as by ``mhri_doctor``."""
        QGuiApplication.clipboard().setText('\n'.join(as_lines(self._findings, self._took_s)))


def _count(number, word):
    """Return a number with its word, e.g. "1 fault", "no warnings"."""
    return '{} {}{}'.format(number or 'no', word, '' if number == 1 else 's')
