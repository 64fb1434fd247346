# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Small widgets of every view: a text line of fixed width, a state shape, a pill."""
from html import escape

from python_qt_binding.QtCore import QEvent, QRect, QRectF, QSize, Qt
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QLabel, QSizePolicy, QWidget

from mhri.base import battery
from mhri.base.gui import theme, words
from mhri.base.gui.layouts import in_row, TIGHT

# Maximum number of lines of a wrapped text.
MAX_LINES = 3


def plain_tip(text):
    """Return a tool tip that shows a text literally.

    Qt renders text that looks like HTML as HTML, and then opens the files it refers to.
    """
    if not Qt.mightBeRichText(text):
        return text
    return '<span style="white-space:pre-wrap">{}</span>'.format(escape(text))


class TextLine(QLabel):
    """One line of text; its tool tip has the whole text if that does not fit.

    A text that does not fit is replaced by a shorter form of the caller, or ends in "...".

    Its width never depends on its text, so that its neighbours do not jump.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        #: the displayed colour, one of the theme's
        self.tone = theme.TEXT
        self._shorter = ()
        self._wrapped = 0
        self._samples = None
        self.setTextFormat(Qt.PlainText)
        self.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Fixed)

    def set_wrapped(self, wrapped, lines=MAX_LINES):
        """Allow up to so many lines, or one; the space for all of them is reserved."""
        self._wrapped = lines if wrapped else 0
        self.updateGeometry()
        self.update()

    def show_text(self, text, tone=theme.TEXT, shorter=()):
        """Show a text in one of the colours of the theme; repeating it costs nothing.

        :param shorter: shorter forms for less space, the longest first
        """
        if text != self.text():
            self.setText(text)
        if tuple(shorter) != self._shorter:
            self._shorter = tuple(shorter)
            self.update()
        if tone != self.tone:
            self.tone = tone
            self.update()

    def set_tone(self, tone):
        """Set one of the colours of the theme."""
        self.show_text(self.text(), tone)

    @property
    def texts(self):
        """The text and its shorter forms, the longest first."""
        return (self.text(), *self._shorter)

    def shown_text(self):
        """Return the form of the text that fits."""
        if self._wrapped:
            room = QRect(0, 0, max(1, self.width()), self._wrapped * self.fontMetrics().height())
            for text in (self.text(), *self._shorter):
                if room.contains(self.fontMetrics().boundingRect(
                        room, int(Qt.TextWordWrap), text)):
                    return text
            return (self._shorter or (self.text(),))[-1]
        return theme.fitting_text(self.fontMetrics(), (self.text(), *self._shorter), self.width())

    def fix_width(self, *samples):
        """Set the width to that of the widest sample, also after a change of the text size."""
        self._samples = samples, self.font().pointSizeF()
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)
        self.setFixedWidth(self._width_for(samples))

    def _width_for(self, samples):
        """Return the width of the widest sample [px]."""
        return theme.text_width(self.font(), *samples)

    def changeEvent(self, event):  # noqa: N802
        """Follow the text size; a bold word does not move its neighbours."""
        super().changeEvent(event)
        if event.type() == QEvent.FontChange and self._samples is not None \
                and self.font().pointSizeF() != self._samples[1]:
            samples, fixed = self._samples[0], self.minimumWidth() == self.maximumWidth()
            self._samples = samples, self.font().pointSizeF()
            self.setMaximumWidth(self._width_for(samples))
            # The owner may have allowed it to shrink since.
            if fixed:
                self.setMinimumWidth(self.maximumWidth())

    def minimumSizeHint(self):  # noqa: N802
        """Return the height of its lines and a minimal width."""
        lines = self._wrapped or 1
        return QSize(self.fontMetrics().averageCharWidth() * 4,
                     lines * self.fontMetrics().height())

    def sizeHint(self):  # noqa: N802
        """Return the height of its lines and the width of the text."""
        return QSize(self.fontMetrics().horizontalAdvance(self.text()) + 2,
                     self.minimumSizeHint().height())

    def _hint(self):
        """Return the tool tip if the whole text is displayed."""
        return ''

    def paintEvent(self, event):  # noqa: N802
        """Paint the text, shortened to the available width."""
        shown = self.shown_text()
        whole = self._hint() if shown == self.text() else plain_tip(self.text())
        if whole != self.toolTip():
            self.setToolTip(whole)
        painter = QPainter(self)
        group = QPalette.Active if self.isEnabled() else QPalette.Disabled
        painter.setPen(theme.colour(self.tone, self.palette()) if self.isEnabled()
                       else self.palette().color(group, QPalette.WindowText))
        painter.drawText(self.rect(), int(self.alignment() | (
            Qt.TextWordWrap if self._wrapped else Qt.TextSingleLine)), shown)


class BatteryLine(TextLine):
    """A battery's charge in percent with a battery symbol in front; empty if unknown.

    The symbol of a low battery is coloured, the number of a flat one is also bold
    (:mod:`mhri.base.battery`).
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._fraction = None
        #: the level of the displayed charge, of :mod:`mhri.base.battery`
        self.level = battery.FINE
        self.setAlignment(Qt.AlignRight | Qt.AlignVCenter)

    def show_charge(self, fraction, old=False):
        """Show a charge in [0, 1]; None and NaN show nothing.

        :param old: whether the value is outdated: it is dimmed
        """
        if fraction != self._fraction:
            self._fraction = fraction
            self.level = battery.battery_level(fraction, self.level)
            text = words.battery_text(fraction)
            state = '' if self.level == battery.FINE else ', ' + self.level
            self.setAccessibleName('battery {}{}'.format(text, state) if text else '')
            font = self.font()
            font.setBold(self.level == battery.FLAT)
            self.setFont(font)
            self.setText(text)
        self.set_tone(theme.MUTED if old else theme.TEXT)

    def _width_for(self, samples):
        """Return the width of the battery symbol and the widest sample [px]."""
        return super()._width_for(samples) + self._mark_width()

    def _mark_width(self):
        """Return the width of the battery symbol and the gap beside it [px]."""
        return round(0.7 * self.fontMetrics().height())

    def _hint(self):
        """Return the tool tip of the number."""
        return 'battery' if self.text() else ''

    def paintEvent(self, event):  # noqa: N802
        """Paint text and battery."""
        super().paintEvent(event)
        if not self.text():
            return
        painter = theme.smooth_painter(self)
        unit = self.fontMetrics().height()
        mark = QRectF(1.0, (self.height() - 0.68 * unit) / 2.0, 0.42 * unit, 0.68 * unit)
        tone = self.tone if self.level == battery.FINE else theme.BATTERY_TONES[self.level]
        theme.paint_battery(painter, mark, self._fraction, theme.colour(tone, self.palette()))


class Sign(QWidget):
    """The shape of a state, as high as a line of text; empty without a state."""

    def __init__(self, parent=None):
        super().__init__(parent)
        #: the displayed (shape, colour name), or None
        self.sign = None
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)

    def show_sign(self, sign):
        """Show a pair (shape, colour name) of the theme, or None for nothing."""
        if sign != self.sign:
            self.sign = sign
            self.update()

    def sizeHint(self):  # noqa: N802
        """Return a square of one line's height."""
        side = self.fontMetrics().height()
        return QSize(side, side)

    def paintEvent(self, event):  # noqa: N802
        """Paint the shape."""
        if self.sign is None:
            return
        painter = theme.smooth_painter(self)
        shape, colour = self.sign
        theme.paint_sign(painter, QRectF(self.rect()).adjusted(1, 1, -1, -1), shape,
                         theme.colour(colour, self.palette()),
                         self.palette().color(QPalette.Base))


def plain_label(parent, text='', factor=1.0, bold=False):
    """Return a word-wrapped label that never interprets HTML."""
    label = QLabel(text, parent, textFormat=Qt.PlainText, wordWrap=True)
    if factor != 1.0 or bold:
        label.setFont(theme.larger(parent.font(), factor, bold))
    return label


class SignedText(QWidget):
    """A word-wrapped text with a sign in front: a problem or an answer."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self.sign, self.label = Sign(self), plain_label(self)
        in_row((self.sign, 0, Qt.AlignTop), (self.label, 1), of=self, margins=TIGHT)

    def text(self):
        """Return the displayed text."""
        return self.label.text()

    def show_text(self, text, attention=False):
        """Show a text; ``attention`` highlights it."""
        if text != self.label.text():
            self.label.setText(text)
        self.sign.show_sign(theme.WARNING if attention else None)


class SignLine(QWidget):
    """A line of text with a sign in front of it."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self.sign, self.line = Sign(self), TextLine(self)
        in_row(self.sign, (self.line, 1), of=self, margins=(2, 0, 2, 0))
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)


class Pill(QWidget):
    """A word on a coloured background, e.g. DRIVING; keeps its space while empty."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._words = ('',)
        #: the displayed word, '' for none
        self.word = ''
        self._colour = theme.DRIVE
        self._filled = True
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)

    def set_words(self, words):
        """Set all words it may show, so that its width never changes."""
        self._words = tuple(words)
        self.updateGeometry()

    def show_word(self, word, colour=theme.DRIVE, filled=True):
        """Show a word on a background, or in an outline, of one of the theme's colours."""
        if (word, colour, filled) != (self.word, self._colour, self._filled):
            self.word, self._colour, self._filled = word, colour, filled
            self.update()

    def sizeHint(self):  # noqa: N802
        """Return the size of the widest word."""
        height = self.fontMetrics().height()
        return QSize(theme.text_width(self._bold(), *self._words) + height, height + 2)

    minimumSizeHint = sizeHint

    def is_whole(self):
        """Return whether its whole word has room."""
        return theme.text_width(self._bold(), self.word) <= self.width()

    def _bold(self):
        """Return the font of the word."""
        return theme.larger(self.font(), theme.SMALL, bold=True)

    def paintEvent(self, event):  # noqa: N802
        """Paint the word and its background."""
        if not self.word:
            return
        painter = theme.smooth_painter(self)
        ink = theme.colour(self._colour, self.palette())
        radius = self.height() / 2.0 - 1.0
        theme.set_ink(painter, QPen(ink, 1.5), ink if self._filled else Qt.NoBrush)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), radius, radius)
        painter.setFont(self._bold())
        painter.setPen(theme.readable_on(ink) if self._filled
                       else theme.colour(theme.TEXT, self.palette()))
        painter.drawText(self.rect(), int(Qt.AlignCenter), self.word)
