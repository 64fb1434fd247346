# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Small pieces of every view: a line of text that never asks for room, a state shape, a pill."""
from html import escape

from python_qt_binding.QtCore import QRect, QRectF, QSize, Qt
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QLabel, QSizePolicy, QWidget

from mhri.base import battery
from mhri.base.gui import theme, words

# Of a text that may be wrapped.
MOST_LINES = 3
# What the two round ends of a pill need beside its word, at the least.
_PILL_EDGE_PX = 2


def plain_tip(text):
    """Return a tool tip that shows a text as it is.

    Qt takes one that looks like HTML for HTML, and then opens the files that it names.
    """
    if not Qt.mightBeRichText(text):
        return text
    return '<span style="white-space:pre-wrap">{}</span>'.format(escape(text))


class TextLine(QLabel):
    """One line of text; what does not fit is told whole by the tool tip.

    In its place there are fewer words, where the caller has some that fit, or it ends in "...".

    It is as wide as it is given, never wider because of its text: nothing beside it jumps.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._tone = theme.TEXT
        self._shorter = ()
        self._wrapped = False
        self.setTextFormat(Qt.PlainText)
        self.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Fixed)

    def set_wrapped(self, wrapped):
        """Have up to :data:`MOST_LINES` lines, or one; the room of all of them is kept."""
        self._wrapped = wrapped
        self.updateGeometry()
        self.update()

    def show_text(self, text, tone=theme.TEXT, shorter=()):
        """Show a text in one of the colours of the theme; the same again costs nothing.

        :param shorter: what to say where there is no room for the text, the longest first
        """
        if text != self.text():
            self.setText(text)
        if tuple(shorter) != self._shorter:
            self._shorter = tuple(shorter)
            self.update()
        if tone != self._tone:
            self._tone = tone
            self.update()

    @property
    def tone(self):
        """The colour on show, one of the theme's."""
        return self._tone

    def set_tone(self, tone):
        """Choose one of the colours of the theme."""
        self.show_text(self.text(), tone)

    @property
    def texts(self):
        """The text, and what may be said in its place where there is no room, the longest first."""
        return (self.text(), *self._shorter)

    def shown_text(self):
        """Return what can be read in the room there is."""
        if self._wrapped:
            room = QRect(0, 0, max(1, self.width()), MOST_LINES * self.fontMetrics().height())
            for text in (self.text(), *self._shorter):
                if self.fontMetrics().boundingRect(room, int(Qt.TextWordWrap), text).height() \
                        <= room.height():
                    return text
            return (self._shorter or (self.text(),))[-1]
        return theme.fitting_text(self.fontMetrics(), (self.text(), *self._shorter), self.width())

    def fix_width(self, *samples):
        """Be exactly as wide as the widest of the samples."""
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)
        self.setFixedWidth(theme.text_width(self.font(), *samples))

    def minimumSizeHint(self):  # noqa: N802
        """Return the height of its lines and hardly any width."""
        lines = MOST_LINES if self._wrapped else 1
        return QSize(self.fontMetrics().averageCharWidth() * 4,
                     lines * self.fontMetrics().height())

    def sizeHint(self):  # noqa: N802
        """Return the height of its lines and the width of the text."""
        return QSize(self.fontMetrics().horizontalAdvance(self.text()) + 2,
                     self.minimumSizeHint().height())

    def _hint(self):
        """Return the tool tip of a text that is told whole."""
        return ''

    def paintEvent(self, event):  # noqa: N802
        """Paint the text, shortened to the width there is."""
        shown = self.shown_text()
        whole = self._hint() if shown == self.text() else plain_tip(self.text())
        if whole != self.toolTip():
            self.setToolTip(whole)
        painter = QPainter(self)
        group = QPalette.Active if self.isEnabled() else QPalette.Disabled
        painter.setPen(theme.colour(self._tone, self.palette()) if self.isEnabled()
                       else self.palette().color(group, QPalette.WindowText))
        painter.drawText(self.rect(), int(self.alignment() | (
            Qt.TextWordWrap if self._wrapped else Qt.TextSingleLine)), shown)


class BatteryLine(TextLine):
    """A battery's charge as percent with a battery in front; nothing where there is none.

    Of a low one the battery has a colour, of a flat one the number is bold as well
    (:mod:`mhri.base.battery`).
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._fraction = None
        self._level = battery.FINE
        self.setAlignment(Qt.AlignRight | Qt.AlignVCenter)

    @property
    def level(self):
        """The level of the charge on show, of :mod:`mhri.base.battery`."""
        return self._level

    def show_charge(self, fraction, old=False):
        """Show a charge in [0, 1]; None and NaN show nothing.

        :param old: whether it is not from now: it is dimmed
        """
        if fraction != self._fraction:
            self._fraction = fraction
            self._level = battery.battery_level(fraction, self._level)
            text = words.battery_text(fraction)
            state = '' if self._level == battery.FINE else ', ' + self._level
            self.setAccessibleName('battery {}{}'.format(text, state) if text else '')
            font = self.font()
            font.setBold(self._level == battery.FLAT)
            self.setFont(font)
            self.setText(text)
        self.set_tone(theme.MUTED if old else theme.TEXT)

    def fix_width(self, *samples):
        """Be exactly as wide as the battery and the widest of the samples."""
        super().fix_width(*samples)
        self.setFixedWidth(self.width() + self._mark_width())

    def _mark_width(self):
        """Return the width of the battery and the gap beside it [px]."""
        return round(0.7 * self.fontMetrics().height())

    def _hint(self):
        """Return what the number is."""
        return 'battery' if self.text() else ''

    def paintEvent(self, event):  # noqa: N802
        """Paint text and battery."""
        super().paintEvent(event)
        if not self.text():
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.Antialiasing)
        unit = self.fontMetrics().height()
        mark = QRectF(1.0, (self.height() - 0.68 * unit) / 2.0, 0.42 * unit, 0.68 * unit)
        tone = self._tone if self._level == battery.FINE else theme.BATTERY_TONES[self._level]
        theme.paint_battery(painter, mark, self._fraction, theme.colour(tone, self.palette()))


class Sign(QWidget):
    """The shape of a state, as high as a line of text; empty while there is nothing to say."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._sign = None
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)

    @property
    def sign(self):
        """(shape, colour name) on show, or None."""
        return self._sign

    def show_sign(self, sign):
        """Show a pair (shape, colour name) of the theme, or None for nothing."""
        if sign != self._sign:
            self._sign = sign
            self.update()

    def sizeHint(self):  # noqa: N802
        """Return a square of one line's height."""
        side = self.fontMetrics().height()
        return QSize(side, side)

    def paintEvent(self, event):  # noqa: N802
        """Paint the shape."""
        if self._sign is None:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.Antialiasing)
        shape, colour = self._sign
        theme.paint_sign(painter, QRectF(self.rect()).adjusted(1, 1, -1, -1), shape,
                         theme.colour(colour, self.palette()),
                         self.palette().color(QPalette.Base))


class Pill(QWidget):
    """A word on a coloured ground, e.g. DRIVING; keeps its room while it says nothing."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._words = ('',)
        self._word = ''
        self._colour = theme.DRIVE
        self._filled = True
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)

    def set_words(self, words):
        """Name every word it may ever say, so that its width never changes."""
        self._words = tuple(words)
        self.updateGeometry()

    @property
    def word(self):
        """The word on show, '' for none."""
        return self._word

    def say(self, word, colour=theme.DRIVE, filled=True):
        """Show a word on a ground of one of the theme's colours, or within an outline of it."""
        if (word, colour, filled) != (self._word, self._colour, self._filled):
            self._word, self._colour, self._filled = word, colour, filled
            self.update()

    def sizeHint(self):  # noqa: N802
        """Return the room of the widest word."""
        height = self.fontMetrics().height()
        return QSize(theme.text_width(self._bold(), *self._words) + height, height + 2)

    minimumSizeHint = sizeHint

    def spare_px(self):
        """Return by how much it may be narrower than it asks for [px], its word still whole."""
        return self.sizeHint().width() - theme.text_width(self._bold(), self._word) - _PILL_EDGE_PX

    def _bold(self):
        """Return the font of the word."""
        return theme.larger(self.font(), 0.92, bold=True)

    def paintEvent(self, event):  # noqa: N802
        """Paint the word, and its ground."""
        if not self._word:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.Antialiasing)
        ink = theme.colour(self._colour, self.palette())
        radius = self.height() / 2.0 - 1.0
        painter.setPen(QPen(ink, 1.5))
        painter.setBrush(ink if self._filled else Qt.NoBrush)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), radius, radius)
        painter.setFont(self._bold())
        painter.setPen(theme.readable_on(ink) if self._filled
                       else theme.colour(theme.TEXT, self.palette()))
        painter.drawText(self.rect(), int(Qt.AlignCenter), self._word)
