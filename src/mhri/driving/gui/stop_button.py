# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The stop buttons: they act on the press, not on the release, by mouse and by any finger."""
import weakref

from python_qt_binding.QtCore import QEvent, QRectF, QSize, Qt, Signal
from python_qt_binding.QtGui import QColor, QPalette, QPen
from python_qt_binding.QtWidgets import QAbstractButton, QApplication, QSizePolicy

from mhri.base.gui import theme
from mhri.base.gui.labels import plain_tip

_ENDS = frozenset((QEvent.MouseButtonRelease, QEvent.TouchEnd, QEvent.TouchCancel,
                   QEvent.ApplicationDeactivate))
# How much darker the button gets [%].
_AT_REST, _UNDER_POINTER, _DOWN = 100, 108, 125
_BUTTONS = weakref.WeakSet()


def stop_places():
    """Return the areas of all stop buttons of this program, in the X server's coordinates.

    Those of single robots, too: while the screen hangs, a press on any of them stops everything.

    :returns: {id of each visible window: [:meth:`StopButton.place` of each button in it]}
    """
    places = {int(widget.winId()): [] for widget in QApplication.topLevelWidgets()
              if widget.isVisible() and widget.windowHandle()}
    for button in _visible_buttons():
        places.setdefault(int(button.window().winId()), []).append(button.place())
    return places


def stop_buttons():
    """Return the visible buttons of this program that stop all robots; nothing may cover them."""
    return [button for button in _visible_buttons() if button.stops_all]


def _visible_buttons():
    shown = []
    for button in list(_BUTTONS):
        try:
            if button.isVisible():
                shown.append(button)
        except RuntimeError:  # Qt has deleted it
            _BUTTONS.discard(button)
    return shown


class StopButton(QAbstractButton):
    """A large vermilion button; connect to ``pressed``, and to ``let_go`` for its end.

    It may be hidden while it is held, when the page of the stop replaces it. So it detects the end
    of a press with an event filter on the application.

    It handles touch events itself: while one finger holds the virtual joystick, Qt turns no other
    finger into a mouse, and stopping has to work just then.
    """

    let_go = Signal()
    #: whether it stops all robots
    stops_all = True

    def __init__(self, parent=None):
        super().__init__(parent)
        self._hint = self._shorter = ''
        self._lines = 2.0
        self._engaged = False
        self._idle = ''
        _BUTTONS.add(self)
        self.pressed.connect(self._watch)
        self.setAttribute(Qt.WA_AcceptTouchEvents)
        # Even a disabled button must not pass presses to the widget below it.
        self.setAttribute(Qt.WA_NoMousePropagation)
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)

    def set_look(self, hint='', lines=2.0):
        """Set the small text at the right end, and the height in lines of text."""
        self._hint, self._lines = hint, lines
        self.updateGeometry()

    def show_words(self, words, shorter=''):
        """Set the text; ``shorter`` replaces it if there is no room."""
        self._shorter = shorter
        self.setText(words)

    def show_engaged(self, engaged):
        """Show whether everything is stopped already; a press still stops again."""
        if engaged != self._engaged:
            self._engaged = engaged
            self.update()

    def show_idle(self, words):
        """Show from now on why there is nothing to stop, and accept no press."""
        self._idle = words
        self.setEnabled(False)

    @property
    def is_idle(self):
        """Whether there is nothing to stop."""
        return bool(self._idle)

    def place(self):
        """Return (left, top, width, height) of its visible part in its window [device px].

        The area is empty if the button is scrolled out of view.
        """
        seen, scale = self.visibleRegion().boundingRect(), self.devicePixelRatioF()
        corner = self.mapTo(self.window(), seen.topLeft())
        return tuple(round(scale * length) for length in (
            corner.x(), corner.y(), seen.width(), seen.height()))

    def shown_words(self):
        """Return the text that fits."""
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
        """Handle a press that another widget received, e.g. an open menu."""
        if self.isEnabled():
            self.setDown(True)
            self.pressed.emit()

    def _watch(self):
        """Watch for the end of this press."""
        QApplication.instance().installEventFilter(self)

    def eventFilter(self, watched, event):  # noqa: N802
        """Emit the end of a press, wherever it arrives."""
        if event.type() in _ENDS:
            QApplication.instance().removeEventFilter(self)
            self.setDown(False)
            self.let_go.emit()
        return False

    def paintEvent(self, event):  # noqa: N802
        """Paint the button; darker under the pointer, and more so while it is down."""
        painter = theme.smooth_painter(self)
        unit = self.fontMetrics().height()
        text = Qt.white
        if self._engaged:
            # Equally readable when disabled: then the text is the reason.
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
            theme.set_ink(painter, QPen(text, 2, Qt.DashLine))
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(7, 7, -7, -7), 4, 4)
        painter.setPen(text)
        if self._idle:
            painter.setFont(theme.base_font(self.window().font()))
            painter.drawText(self.rect(), int(Qt.AlignCenter | Qt.TextWordWrap), self._idle)
            return
        words = self.shown_words()
        needed = theme.text_width(self.font(), words) + 2 * theme.GRID
        painter.setFont(theme.larger(self.font(), min(1.0, self.width() / needed),
                                     self.font().bold()))
        painter.drawText(self.rect(), int(Qt.AlignCenter), words)
        beside = (self.width() - painter.fontMetrics().horizontalAdvance(words)) / 2
        painter.setFont(theme.larger(theme.base_font(self.window().font()), theme.BODY))
        if self._hint and not self._engaged and \
                painter.fontMetrics().horizontalAdvance(self._hint) + 1.5 * unit < beside:
            painter.drawText(self.rect().adjusted(0, 0, -unit, 0),
                             int(Qt.AlignRight | Qt.AlignVCenter), self._hint)


class RobotStopButton(StopButton):
    """Stops one robot; in the header of its tile with a word, in a small tile without.

    It is filled while the robot may move, and else an outline, which also stops again.
    """

    stops_all = False

    def __init__(self, name, parent=None):
        super().__init__(parent)
        self._with_word = self._in_header = False
        self._moves = False
        self.setText('Stop')
        self.setObjectName('robot_stop_button')
        # The keyboard has Shift+Enter; as a stop of the focus it would be in the way.
        self.setFocusPolicy(Qt.NoFocus)
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)
        self.setAccessibleName('Stop {}'.format(name))
        self.setPalette(theme.over_picture(self.palette()))

    def show_keys(self, keys):
        """Show in the tool tip which keys do the same."""
        self.setToolTip(plain_tip('{} alone ({})'.format(self.accessibleName(), keys)))

    def show_place(self, in_header, with_word):
        """Set whether it is part of a header, and whether the word is beside the sign."""
        if (in_header, with_word) == (self._in_header, self._with_word):
            # The request for a new layout would call this again, for ever.
            return
        self._in_header, self._with_word = in_header, with_word
        self.updateGeometry()
        self.update()

    def show_moves(self, moves):
        """Show whether the robot may move."""
        if moves != self._moves:
            self._moves = moves
            self.update()

    def sizeHint(self):  # noqa: N802
        """Return room for a gloved finger, and for the word."""
        side = theme.touch_size(self)
        word = theme.text_width(self._bold(), self.text()) + side // 3 if self._with_word else 0
        return QSize(side + word, side)

    minimumSizeHint = sizeHint

    def _bold(self):
        return theme.larger(theme.base_font(self.font()), theme.BODY, bold=True)

    def paintEvent(self, event):  # noqa: N802
        """Paint the sign, on a ground that is filled while the robot may move."""
        painter = theme.smooth_painter(self)
        if self._in_header:
            painter.fillRect(self.rect(), theme.OVER_PICTURE)
        red = theme.colour(theme.STOP, self.palette())
        down = self.isDown() or self.underMouse()
        filled = self._moves or down
        ground = theme.STOP_GROUND.darker(_DOWN if self.isDown() else _AT_REST) if filled \
            else theme.OVER_PICTURE
        theme.set_ink(painter, QPen(ground if filled else theme.line_colour(self.palette()), 1.5),
                      ground)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(3, 3, -3, -3), 6, 6)
        ink, side = QColor(Qt.white) if filled else red, self.height()
        theme.paint_sign(painter, QRectF(0.26 * side, 0.26 * side, 0.48 * side, 0.48 * side),
                         theme.STOP_SIGN, ink, ground)
        if self._with_word:
            painter.setFont(self._bold())
            painter.setPen(Qt.white)
            painter.drawText(self.rect().adjusted(round(0.8 * side), 0, 0, 0),
                             int(Qt.AlignLeft | Qt.AlignVCenter), self.text())
