# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stop all, across the whole panel: one press to stop, two steps to release.

Held for 2 s (the button, or Shift+Space), or by a second step on the page that says what is
stopped, it cuts the power of the motors of those robots that offer it.
"""
from python_qt_binding.QtCore import QElapsedTimer, Qt, QTimer, Signal
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import (
    QBoxLayout, QHBoxLayout, QSizePolicy, QStackedLayout, QVBoxLayout, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.labels import Sign, TextLine
from mhri.base.gui.pending import Pending
from mhri.driving.gui.stop_button import StopButton
from mhri.driving.stop_words import NOBODY_HEARD

CONFIRM_WITHIN_S = 5.0
ANSWER_WITHIN_S = 2.0
# Held for so long, the stop button cuts the power of the motors as well.
CUT_AFTER_S = 2.0
# What is pressed sooner after the page of the stop appeared was meant for what was there before.
SETTLED_S = 0.5
# From this width on the buttons never make the words shorter [heights of a line].
_ROOMY_UNITS = 38.0
CUT_OFF = 'This screen is cut off: STOP ALL here reaches nothing'
CUT_OFF_NOTE = ('another program has taken its name, or it was ended from elsewhere: stop the '
                'robots by hand or from another screen; restart this one')
CUT_OFF_SHORTEST = 'CUT OFF'
CUT_OFF_SHORTER = ('stop the robots from elsewhere; restart this screen', 'restart this screen')


class StopBar(QWidget):
    """The stop button or, once stopped, what is stopped and how to release it.

    "Release..." asks for a second step beside it; where it was, there is "Cancel" then, so that a
    double click never releases. What is on show follows the view, not the clicks.
    """

    stop_requested = Signal()
    release_requested = Signal()
    #: the power of the motors is to be cut: the stop was held, or the second step taken
    power_cut_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._stopped = False
        self._cut_off = False
        self._offered = False
        self._column = False
        self._note = self._idle = ''
        self._words = NOBODY_HEARD
        self._asked = Pending(ANSWER_WITHIN_S)
        self._appeared = QElapsedTimer()
        self._meant = False
        self._build()
        self._connect()

    def _build(self):
        """Make the two pages."""
        font = theme.base_font(self.font())
        self.stop_button = StopButton(self)
        self.stop_button.setObjectName('stop_button')
        self.stop_button.setFont(theme.larger(font, 1.9, bold=True))
        self.stop_button.set_look('Shift+Space', 2.4)
        self.stop_button.setAccessibleName('Stop all robots')
        self._stopped_page = QWidget(self)
        self._sign = Sign(self._stopped_page)
        self._headline = TextLine(self._stopped_page)
        self._headline.setObjectName('stopped_label')
        self._note_line = TextLine(self._stopped_page)
        self._note_line.setObjectName('stop_note_label')
        for widget, factor, bold in ((self._sign, 2.0, True), (self._headline, 1.5, True),
                                     (self._note_line, 1.0, False)):
            widget.setFont(theme.larger(font, factor, bold))
        self._sign.show_sign((theme.OCTAGON, theme.STOP))
        self.release_button = self._button('release_button', 'Release...')
        self.confirm_button = self._button('confirm_button', 'Confirm release')
        self.power_button = self._button('power_button', 'Cut motor power')
        self.cancel_button = self._button('cancel_button', 'Cancel')
        self._pages = QStackedLayout(self)
        self._pages.addWidget(self.stop_button)
        self._pages.addWidget(self._stopped_page)
        self._lay_out_stopped()
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self._held = QTimer(self)
        self._held.setSingleShot(True)
        self._held.setInterval(round(CUT_AFTER_S * 1000))
        self._countdown = QTimer(self)
        self._countdown.setSingleShot(True)
        self._countdown.setInterval(round(CONFIRM_WITHIN_S * 1000))
        self._answer = QTimer(self)
        self._answer.setSingleShot(True)
        # A coarse one may come too early to find the request too old.
        self._answer.setTimerType(Qt.PreciseTimer)
        self._answer.setInterval(round(ANSWER_WITHIN_S * 1000) + 20)
        self._show()

    def _lay_out_stopped(self):
        """Place the parts of the second page."""
        words = QVBoxLayout()
        words.setSpacing(0)
        words.addStretch()
        words.addWidget(self._headline)
        words.addWidget(self._note_line)
        words.addStretch()
        second = self._second_place = QWidget(self._stopped_page)
        second.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)
        self._second = QStackedLayout(second)
        self._second.addWidget(self.release_button)
        self._second.addWidget(self.cancel_button)
        row = self._row = QBoxLayout(QBoxLayout.LeftToRight, self._stopped_page)
        unit = self.fontMetrics().height()
        row.setContentsMargins(unit, 6, unit, 6)
        row.setSpacing(unit // 2)
        told, buttons = QHBoxLayout(), QBoxLayout(QBoxLayout.LeftToRight)
        self._buttons = buttons
        for part in (told, buttons):
            part.setSpacing(unit // 2)
            row.addLayout(part)
        told.addWidget(self._sign)
        told.addLayout(words, 1)
        buttons.addWidget(self.power_button)
        buttons.addWidget(self.confirm_button)
        buttons.addWidget(second)
        row.setStretch(0, 1)

    def show_narrow(self, narrow, column=False):
        """Have the buttons of the second page below its words, where there is little width.

        :param column: whether there is so little that they are above each other as well
        """
        self._column = column
        self._row.setDirection(QBoxLayout.TopToBottom if narrow else QBoxLayout.LeftToRight)
        self._buttons.setDirection(QBoxLayout.TopToBottom if column else QBoxLayout.LeftToRight)
        self._note_line.set_wrapped(column)
        self._second_place.setSizePolicy(
            QSizePolicy.Preferred if column else QSizePolicy.Fixed, QSizePolicy.Fixed)
        self.stop_button.set_look('' if narrow else 'Shift+Space', 3.4 if narrow else 2.4)
        self._keep_room()

    def resizeEvent(self, event):  # noqa: N802
        """Keep the room of the second step where there is enough of it, so that nothing jumps."""
        super().resizeEvent(event)
        self._keep_room()

    def _keep_room(self):
        keep = self.confirm_button.sizePolicy()
        keep.setRetainSizeWhenHidden(
            self._column or self.width() > _ROOMY_UNITS * self.fontMetrics().height())
        self.confirm_button.setSizePolicy(keep)

    def _button(self, name, text):
        """Make one of the buttons of the second page, wide enough for any of its words."""
        button = theme.finger_button(self._stopped_page, name, text)
        button.setMinimumSize(round(1.3 * theme.text_width(button.font(), text)) + 16,
                              theme.touch_size(self) + 8)
        return button

    def _connect(self):
        """Wire buttons and timers."""
        self.stop_button.pressed.connect(self.request_stop)
        self.stop_button.pressed.connect(self._held.start)
        self.stop_button.let_go.connect(self._held.stop)
        self._held.timeout.connect(self.power_cut_requested)
        self.power_button.pressed.connect(self._note_press)
        self.power_button.clicked.connect(self._cut_power)
        self.release_button.clicked.connect(self._ask)
        self.cancel_button.clicked.connect(self._cancel)
        self.confirm_button.clicked.connect(self._confirm)
        self._countdown.timeout.connect(self._cancel)
        self._answer.timeout.connect(self._show)

    def show_stop(self, stopped, note='', said=NOBODY_HEARD):
        """Show whether stop-all is in force, and what is worth saying about it.

        :param note: e.g. why a release was refused; '' for nothing
        :param said: :class:`mhri.driving.stop_words.StopWords`, how far it is proved
        """
        if not stopped or not self._stopped:
            self._countdown.stop()
        if stopped and note != self._note:
            # Why it stays stopped is an answer, too.
            self._asked.drop()
        changed = (stopped, note, said) != (self._stopped, self._note, self._words)
        self._stopped, self._note, self._words = stopped, note, said
        if changed:
            self._show()

    def show_power(self, offered):
        """Show whether the power of any motors can be cut from here."""
        if offered != self._offered:
            self._offered = offered
            self._show()

    def show_cut_off(self, cut_off):
        """Show that nothing that is pressed on this screen reaches anything any more."""
        if cut_off != self._cut_off:
            self._cut_off = cut_off
            self._show()

    def show_idle(self, words):
        """Say from now on why there is nothing to stop; what was stopped then still shows."""
        self._idle = words
        self.stop_button.show_idle(words)
        self._show()

    def request_stop(self):
        """Ask for stop-all, as the button does; may be repeated."""
        if self._idle:
            return
        self._countdown.stop()
        self._asked.ask(True)
        self._answer.start()
        self._show()
        self.stop_requested.emit()

    def _note_press(self):
        """Take note whether the page was there for long enough to be what was pressed."""
        self._meant = self._appeared.isValid() and self._appeared.elapsed() >= 1000 * SETTLED_S

    def _cut_power(self):
        """Cut the power, unless the click was one of those that followed the stop."""
        if self._meant:
            self.power_cut_requested.emit()

    def _ask(self):
        """First step of a release."""
        self._countdown.start()
        self._show()
        if self.release_button.hasFocus():
            self.cancel_button.setFocus()

    def _cancel(self):
        """Back to the first step."""
        self._countdown.stop()
        self._show()

    def _confirm(self):
        """Second step of a release."""
        self._countdown.stop()
        self._asked.ask(False)
        self._answer.start()
        self._show()
        self.release_requested.emit()

    def _show(self):
        """Show the state as it is known."""
        asked = self._asked.settle(self._stopped)
        self._show_page(1 if self._stopped or self._cut_off else 0)
        stopping = asked and not self._stopped
        self.stop_button.setText('STOPPING ...' if stopping else 'STOP ALL')
        releasing = self._stopped and not asked
        headline, *shorter = ('RELEASING ...',) if releasing else self._words.headlines
        self._headline.show_text(headline, shorter=shorter)
        self._note_line.show_text(self._idle or self._note or self._words.note)
        if self._cut_off:
            self._headline.show_text(CUT_OFF, shorter=(CUT_OFF_SHORTEST,))
            self._note_line.show_text(CUT_OFF_NOTE, shorter=CUT_OFF_SHORTER)
        confirming = self._countdown.isActive()
        self.confirm_button.setVisible(confirming)
        self._second.setCurrentIndex(1 if confirming else 0)
        self.release_button.setEnabled(not releasing and not self._cut_off)
        self.power_button.setVisible(self._offered and not (
            confirming or self._cut_off or self._idle))
        self._second_place.setVisible(not self._idle)
        self.update()

    def _show_page(self, index):
        """Show a page; one that has just come counts as seen once it is painted."""
        if index != self._pages.currentIndex():
            self._appeared.invalidate()
            self._pages.setCurrentIndex(index)

    def paintEvent(self, event):  # noqa: N802
        """Paint the frame of the stopped state."""
        if not self._stopped and not self._cut_off:
            return
        if not self._appeared.isValid():
            self._appeared.start()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.Antialiasing)
        theme.paint_stopped_frame(painter, self.rect(), self.palette())
