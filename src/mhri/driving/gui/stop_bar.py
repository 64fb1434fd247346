# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The foot of the screen: stop all at its left end, one press to stop, two steps to release.

Holding it for 2 s (the button, or Shift+Space), or a second step on the page of the stop, cuts the
motor power of the robots that support it.
"""
from python_qt_binding.QtCore import QElapsedTimer, QEvent, QTimer, Signal
from python_qt_binding.QtGui import QFontMetrics
from python_qt_binding.QtWidgets import QSizePolicy, QStackedLayout, QWidget

from mhri.base.gui import theme
from mhri.base.gui.labels import Sign, TextLine
from mhri.base.gui.layouts import in_column, in_row, TIGHT
from mhri.base.gui.pending import Pending
from mhri.driving.gui.hold_ring import HoldRing
from mhri.driving.gui.stop_button import StopButton
from mhri.driving.stop_words import NOBODY_HEARD

CONFIRM_WITHIN_S = 5.0
ANSWER_WITHIN_S = 2.0
# Held for this long [s], the stop button also cuts the power of the motors.
CUT_AFTER_S = 2.0
# A press within this time [s] after the page of the stop appeared was meant for the page before.
SETTLED_S = 0.5
# Share of the width for the stop button, at every size.
STOP_SHARE = 0.3
# Sizes of the headline; a longer text in a smaller size says more than a shorter one in a larger.
_HEADLINE_SIZES = (theme.LARGE, theme.TITLE, theme.BODY)
STOP, STOPPING = 'STOP ALL', 'STOPPING ...'
# Height of the upper row beside the button, for the two lines on a stop [line heights].
_ROW_UNITS = 2.7
# Width of the box of the button with room for a sign beside the release [line heights].
_SIGN_UNITS = 9.0
_GAP_PX = 4
CUT_OFF = 'This screen is cut off: STOP ALL here reaches nothing'
CUT_OFF_NOTE = ('another program has taken its name, or it was ended from elsewhere: stop the '
                'robots by hand or from another screen; restart this one')
CUT_OFF_SHORTEST = 'CUT OFF'
CUT_OFF_SHORTER = ('stop the robots from elsewhere; restart this screen', 'restart this screen')


class _Headline(TextLine):
    """A text in the largest size in which all of it fits, before it is replaced by a shorter one.

    Its height is that of the largest size, so that nothing moves.
    """

    def show_text(self, text, tone=theme.TEXT, shorter=()):
        """Show a text as :class:`TextLine` does, in a size that fits."""
        super().show_text(text, tone, shorter)
        self._fit()

    def resizeEvent(self, event):  # noqa: N802
        """Fit the new width."""
        super().resizeEvent(event)
        self._fit()

    def changeEvent(self, event):  # noqa: N802
        """Follow the size of text."""
        super().changeEvent(event)
        if event.type() == QEvent.FontChange:
            self._fit()

    def _fit(self):
        """Choose the font."""
        base = theme.base_font(self.parentWidget().font())
        fonts = [theme.larger(base, size, bold=True) for size in _HEADLINE_SIZES]
        self.setFixedHeight(QFontMetrics(fonts[0]).height())
        font = next((font for text in self.texts for font in fonts
                     if theme.text_width(font, text) <= self.width()), fonts[-1])
        if font != self.font():
            self.setFont(font)


class StopBar(QWidget):
    """The stop button or, once stopped, its release; beside it the state of the stop.

    It has the same height and the button the same place in every state; :meth:`place_beside` adds
    what else is at the foot of a screen.

    "Release..." shows a confirmation button beside it and turns into "Cancel" itself, so that a
    double click never releases. The bar shows the state of the view, not of the clicks.
    """

    stop_requested = Signal()
    release_requested = Signal()
    #: cut the power of the motors: the stop was held, or the second step taken
    power_cut_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._stopped = False
        self._cut_off = False
        self._offered = False
        self._note = self._idle = ''
        self._words = NOBODY_HEARD
        self._asked = Pending(ANSWER_WITHIN_S, self._show)
        self._appeared = QElapsedTimer()
        self._meant = False
        self._build()
        self._connect()

    def _build(self):
        """Make the two pages."""
        font = theme.base_font(self.font())
        self.stop_button = StopButton(self)
        self.stop_button.setObjectName('stop_button')
        self.stop_button.setFont(theme.larger(font, theme.HUGE, bold=True))
        self.stop_button.set_look('Shift+Space')
        self.stop_button.setAccessibleName('Stop all robots')
        self._sign = Sign(self)
        self._headline = _Headline(self)
        self._headline.setObjectName('stopped_label')
        self._note_line = TextLine(self)
        self._note_line.setObjectName('stop_note_label')
        for widget, factor, bold in ((self._sign, 2.0, True), (self._note_line, 1.0, False)):
            widget.setFont(theme.larger(font, factor, bold))
        self._sign.show_sign((theme.OCTAGON, theme.STOP))
        self.release_button = self._button('release_button', 'Release...')
        self.confirm_button = self._button('confirm_button', 'Confirm release')
        self.power_button = self._button('power_button', 'Cut motor power')
        self.cancel_button = self._button('cancel_button', 'Cancel')
        self._lay_out()
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self._held = QTimer(self, singleShot=True, interval=round(CUT_AFTER_S * 1000))
        self._countdown = QTimer(self, singleShot=True, interval=round(CONFIRM_WITHIN_S * 1000))
        self._show()

    def _lay_out(self):
        """Place the parts: the stop or its release at the left, the words and buttons beside."""
        unit = self.fontMetrics().height()
        self._second_place = QWidget(self)
        self._second = QStackedLayout(self._second_place)
        self._second.addWidget(self.release_button)
        self._second.addWidget(self.cancel_button)
        stopped, self._box = QWidget(self), QWidget(self)
        in_row(self._sign, (self._second_place, 1), of=stopped, gap=unit // 2,
               margins=(unit // 2, unit // 2, unit // 2, unit // 2))
        self._ring = HoldRing(self._box, CUT_AFTER_S)
        self._pages = QStackedLayout(self._box)
        self._pages.addWidget(self.stop_button)
        self._pages.addWidget(stopped)
        state = QWidget(self)
        in_row((in_column(1, self._headline, self._note_line, 1, gap=0), 1), self.power_button,
               self.confirm_button, of=state, margins=TIGHT, gap=unit // 2)
        place = QWidget(self)
        place.setFixedHeight(round(_ROW_UNITS * unit))
        self._beside = QStackedLayout(place)
        self._beside.addWidget(QWidget(place))
        self._beside.addWidget(state)
        self._upper = in_row((place, 1), margins=TIGHT, gap=unit // 2)
        beside = QWidget(self)
        self._rows = in_column(self._upper, of=beside, gap=_GAP_PX, margins=TIGHT)
        for part in (self._box, beside):
            # What is in them does not change their shares.
            part.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Preferred)
        share = round(100 * STOP_SHARE)
        in_row((self._box, share), (beside, 100 - share), of=self, margins=TIGHT, gap=unit // 2)

    def place_beside(self, words, control, lower):
        """Place the other parts of a foot at the right of the button.

        :param words: widget in the upper row while nothing is stopped
        :param control: widget at the right end of the upper row
        :param lower: widget of the lower row
        """
        self._beside.widget(0).deleteLater()
        self._beside.removeWidget(self._beside.widget(0))
        self._beside.insertWidget(0, words)
        self._upper.addWidget(control, 4)
        self._rows.addWidget(lower)
        self._show()

    def resizeEvent(self, event):  # noqa: N802
        """Show the sign beside the release if there is room."""
        super().resizeEvent(event)
        self._show_sign()

    def changeEvent(self, event):  # noqa: N802
        """Show the sign if there is room, with letters of another size."""
        super().changeEvent(event)
        if event.type() == event.FontChange:
            self._show_sign()

    def _show_sign(self):
        """Show the sign if its box is wide enough."""
        unit = self.fontMetrics().height()
        self._sign.setVisible(STOP_SHARE * self.width() >= _SIGN_UNITS * unit)

    def _button(self, name, text):
        """Make a button of the second page, wide enough for any of its texts."""
        button = theme.finger_button(self, name, text)
        button.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Preferred)
        return button

    def _connect(self):
        """Connect buttons and timers."""
        self.stop_button.pressed.connect(self.request_stop)
        self.stop_button.pressed.connect(self._held.start)
        self.stop_button.pressed.connect(self.begin_hold)
        self.stop_button.let_go.connect(self._held.stop)
        self.stop_button.let_go.connect(self.end_hold)
        self._held.timeout.connect(self.power_cut_requested)
        self.power_button.pressed.connect(self._note_press)
        self.power_button.clicked.connect(self._cut_power)
        self.release_button.clicked.connect(self._ask)
        self.cancel_button.clicked.connect(self._cancel)
        self.confirm_button.clicked.connect(self._confirm)
        self._countdown.timeout.connect(self._cancel)

    def show_stop(self, stopped, note='', said=NOBODY_HEARD):
        """Show whether stop-all is in force, with its texts.

        :param note: e.g. why a release was refused; '' for none
        :param said: :class:`mhri.driving.stop_words.StopWords`, how far the stop is proved
        """
        if not stopped or not self._stopped:
            self._countdown.stop()
        if stopped and note != self._note:
            # The reason for a refused release is an answer, too.
            self._asked.drop()
        changed = (stopped, note, said) != (self._stopped, self._note, self._words)
        self._stopped, self._note, self._words = stopped, note, said
        if changed:
            self._show()

    def show_power(self, offered):
        """Show whether any robot supports cutting its motor power."""
        if offered != self._offered:
            self._offered = offered
            self._show()

    def show_cut_off(self, cut_off):
        """Show whether the screen is cut off, so that its buttons have no effect any more."""
        if cut_off != self._cut_off:
            self._cut_off = cut_off
            self._show()

    def show_idle(self, words):
        """Show from now on why there is nothing to stop; a recorded stop is still shown."""
        self._idle = words
        self.stop_button.show_idle(words)
        self._show()

    def request_stop(self):
        """Request stop-all, as the button does; may be repeated."""
        if self._idle:
            return
        self._countdown.stop()
        self._asked.ask(True)
        self._show()
        self.stop_requested.emit()

    def begin_hold(self):
        """Show how long the stop has been held, if that cuts the power of any robot."""
        if self._offered and not self._idle:
            self._ring.begin()

    def end_hold(self):
        """Handle the end of holding the stop."""
        self._ring.end()

    def _note_press(self):
        """Store whether the page was visible long enough for this press to be meant for it."""
        self._meant = self._appeared.isValid() and self._appeared.elapsed() >= 1000 * SETTLED_S

    def _cut_power(self):
        """Cut the power, unless the click was one of a series that began with the stop."""
        if self._meant:
            self.power_cut_requested.emit()

    def _ask(self):
        """Handle the first step of a release."""
        self._countdown.start()
        self._show()
        if self.release_button.hasFocus():
            self.cancel_button.setFocus()

    def _cancel(self):
        """Return to the first step."""
        self._countdown.stop()
        self._show()

    def _confirm(self):
        """Handle the second step of a release."""
        self._countdown.stop()
        self._asked.ask(False)
        self._show()
        self.release_requested.emit()

    def _show(self):
        """Show the current state."""
        asked = self._asked.settle(self._stopped)
        self._show_page(1 if self._stopped or self._cut_off else 0)
        stopping = asked and not self._stopped
        self.stop_button.setText(STOPPING if stopping else STOP)
        releasing = self._stopped and not asked
        headline, *shorter = ('RELEASING ...',) if releasing else self._words.headlines
        self._headline.show_text(headline, shorter=shorter)
        # A consequence is left out where not even its shortest form fits, a reason is not.
        self._note_line.show_text(
            self._idle or self._note or self._words.note,
            shorter=() if self._idle or self._note else (*self._words.shorter, ''))
        if self._cut_off:
            self._headline.show_text(CUT_OFF, shorter=(CUT_OFF_SHORTEST,))
            self._note_line.show_text(CUT_OFF_NOTE, shorter=CUT_OFF_SHORTER)
        confirming = self._countdown.isActive()
        if self.confirm_button.isVisibleTo(self) and not confirming:
            # A late click on it is not meant for the button that takes its place.
            self._appeared.invalidate()
        self.confirm_button.setVisible(confirming)
        self._second.setCurrentIndex(1 if confirming else 0)
        self.release_button.setEnabled(not releasing and not self._cut_off)
        self.power_button.setVisible(self._offered and not (
            confirming or self._cut_off or self._idle))
        self._second_place.setVisible(not self._idle)
        self.update()

    def _show_page(self, index):
        """Show a page; a new page counts as seen once it is painted."""
        if index != self._pages.currentIndex():
            self._appeared.invalidate()
        self._pages.setCurrentIndex(index)
        self._beside.setCurrentIndex(index)

    def paintEvent(self, event):  # noqa: N802
        """Paint the frame of the stopped state."""
        if not self._stopped and not self._cut_off:
            return
        if not self._appeared.isValid():
            self._appeared.start()
        painter = theme.smooth_painter(self)
        theme.paint_stopped_frame(painter, self._box.geometry(), self.palette())
