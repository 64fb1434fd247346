# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The stop button: acts when it is pressed, not when it is let go, by mouse and by any finger."""
import weakref

from python_qt_binding.QtCore import QEvent, QRectF, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QAbstractButton, QApplication, QSizePolicy

from mhri.base.gui import theme

_ENDS = frozenset((QEvent.MouseButtonRelease, QEvent.TouchEnd, QEvent.TouchCancel,
                   QEvent.ApplicationDeactivate))
# How much darker than its ground the button is [%].
_AT_REST, _UNDER_POINTER, _DOWN = 100, 108, 125
_BUTTONS = weakref.WeakSet()


def stop_places():
    """Return where this program can be stopped by hand, as the X server counts.

    :returns: {id of each window that is shown: [:meth:`StopButton.place` of each button in it]}
    """
    places = {int(widget.winId()): [] for widget in QApplication.topLevelWidgets()
              if widget.isVisible() and widget.windowHandle()}
    for button in stop_buttons():
        places.setdefault(int(button.window().winId()), []).append(button.place())
    return places


def stop_buttons():
    """Return the stop buttons of this program that are shown."""
    shown = []
    for button in list(_BUTTONS):
        try:
            if button.isVisible():
                shown.append(button)
        except RuntimeError:  # Qt has deleted it
            _BUTTONS.discard(button)
    return shown


class StopButton(QAbstractButton):
    """A large vermillion button; connect to ``pressed``, and to ``let_go`` for its end.

    It may be hidden while it is held: the page that says what is stopped takes its place. So the
    end of a press is looked for in the application, not awaited here.

    It takes touches itself: while one finger holds the virtual joystick, Qt turns no other finger
    into a mouse, and stopping has to work just then.
    """

    let_go = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._hint = self._shorter = ''
        self._lines = 2.0
        self._engaged = False
        self._idle = ''
        _BUTTONS.add(self)
        self.pressed.connect(self._watch)
        self.setAttribute(Qt.WA_AcceptTouchEvents)
        # Even one that takes no press is no part of what lies below it.
        self.setAttribute(Qt.WA_NoMousePropagation)
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)

    def set_look(self, hint='', lines=2.0):
        """Choose the small text at the right end, and the height in lines of text."""
        self._hint, self._lines = hint, lines
        self.updateGeometry()

    def show_words(self, words, shorter=''):
        """Say what it does; ``shorter`` where there is no room for the words."""
        self._shorter = shorter
        self.setText(words)

    def show_engaged(self, engaged):
        """Show whether everything is stopped already; pressing still stops once more."""
        if engaged != self._engaged:
            self._engaged = engaged
            self.update()

    def show_idle(self, words):
        """Say from now on why there is nothing to stop, and take no press."""
        self._idle = words
        self.setEnabled(False)

    def place(self):
        """Return (left, top, width, height) of what is to be seen of it in its window [device px].

        An area of nothing where all of it is scrolled away.
        """
        seen, scale = self.visibleRegion().boundingRect(), self.devicePixelRatioF()
        corner = self.mapTo(self.window(), seen.topLeft())
        return tuple(round(scale * length) for length in (
            corner.x(), corner.y(), seen.width(), seen.height()))

    def shown_words(self):
        """Return the words for which there is room."""
        fits = self.fontMetrics().horizontalAdvance(self.text()) <= self.width()
        return self.text() if fits else self._shorter or self.text()

    def sizeHint(self):  # noqa: N802
        """Return room for the text and for a gloved finger."""
        metrics = self.fontMetrics()
        return QSize(metrics.horizontalAdvance(self.text()) + (
            4 if self._hint else 1) * metrics.height(),
                     max(theme.touch_size(self), round(self._lines * metrics.height())))

    minimumSizeHint = sizeHint

    def event(self, event):
        """Act on the first contact of a finger."""
        kind = event.type()
        if kind == QEvent.TouchBegin and self.isEnabled():
            self.press()
        elif kind in (QEvent.TouchEnd, QEvent.TouchCancel):
            self.setDown(False)
        elif kind != QEvent.TouchUpdate:
            return super().event(event)
        event.accept()
        return True

    def press(self):
        """Act on a press that somebody else received, as an open menu does."""
        if self.isEnabled():
            self.setDown(True)
            self.pressed.emit()

    def _watch(self):
        """Look for the end of this press."""
        QApplication.instance().installEventFilter(self)

    def eventFilter(self, watched, event):  # noqa: N802
        """Tell of the end of a press, wherever it arrives."""
        if event.type() in _ENDS:
            QApplication.instance().removeEventFilter(self)
            self.setDown(False)
            self.let_go.emit()
        return False

    def paintEvent(self, event):  # noqa: N802
        """Paint the button; darker under the pointer, and more so while it is down."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.Antialiasing)
        unit = self.fontMetrics().height()
        text = Qt.white
        if self._engaged:
            # As readable where it takes no press: then it says why.
            text = self.palette().color(QPalette.Active, QPalette.WindowText)
            theme.paint_stopped_frame(painter, self.rect(), self.palette())
        else:
            ground = self.palette().color(QPalette.Window) if self._idle else \
                theme.STOP_GROUND.darker(
                    _DOWN if self.isDown() else _UNDER_POINTER if self.underMouse() else _AT_REST)
            text = theme.readable_on(ground) if self._idle else text
            painter.setPen(QPen(ground.darker(125), 2))
            painter.setBrush(ground)
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), 6, 6)
        if self.hasFocus():
            painter.setPen(QPen(text, 2, Qt.DashLine))
            painter.setBrush(Qt.NoBrush)
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(7, 7, -7, -7), 4, 4)
        painter.setPen(text)
        if self._idle:
            painter.setFont(theme.base_font(self.window().font()))
            painter.drawText(self.rect(), int(Qt.AlignCenter | Qt.TextWordWrap), self._idle)
            return
        words = self.shown_words()
        painter.drawText(self.rect(), int(Qt.AlignCenter), words)
        beside = (self.width() - painter.fontMetrics().horizontalAdvance(words)) / 2
        painter.setFont(theme.larger(theme.base_font(self.window().font()), 1.0))
        if self._hint and not self._engaged and \
                painter.fontMetrics().horizontalAdvance(self._hint) + 1.5 * unit < beside:
            painter.drawText(self.rect().adjusted(0, 0, -unit, 0),
                             int(Qt.AlignRight | Qt.AlignVCenter), self._hint)
