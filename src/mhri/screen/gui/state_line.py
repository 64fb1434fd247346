# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The lines below a bot window's header: link, motion capture, and how old what is shown is."""
from typing import NamedTuple

from python_qt_binding.QtCore import QSize
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.labels import plain_tip, Sign, TextLine
from mhri.base.gui.pending import Pace

NUMBERS_PERIOD_S = 0.25
# A stream that is older than this is pointed at.
OLD_S = 1.0
_AGE_PLACES = 6
_FIGURE_SPACE = '\u2007'
# Between two phrases, in heights of a line.
_GAP = 0.9


def age_phrase(name, age_s):
    """Return a stream's name and age with as much room for the age as the longest needs.

    :param age_s: [s], None where nothing has come yet
    """
    return '{} {}'.format(
        name, (words.age_text(age_s) or words.UNKNOWN).rjust(_AGE_PLACES, _FIGURE_SPACE))


def capture_phrases(captured, drift):
    """Return how far a robot's odometry is off and where motion capture sees it; () for None."""
    if captured is None:
        return ()
    place = 'captured x {}  y {}  {}'.format(
        words.metres_text(captured.x_m), words.metres_text(captured.y_m),
        words.heading_text(captured.heading_rad))
    if drift is None:
        return (place,)
    return ('odometry off {}, {}'.format(
        words.metres_text(drift.distance_m), words.heading_text(abs(drift.heading_rad))), place)


class _Phrase(NamedTuple):
    """One thing to say: what it is about, the words, their colour, and whether it ends the line."""

    about: str
    text: str
    tone: str = theme.MUTED
    at_end: bool = False


class StateLine(QWidget):
    """Phrases that change four times a second at the most, and a sign while a stream is old.

    They stand on one line where there is room, link and motion capture on the left, ages on the
    right; else on as many lines as they need: none is ever cut off.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._numbers = Pace(NUMBERS_PERIOD_S)
        self._old = ()
        self._labels = {}
        self._widest = {}
        self._phrases = ()
        self._build()

    def _build(self):
        """Make the sign; labels are made as they are needed."""
        self.ages_sign = Sign(self)
        self.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)
        self._arrange()

    def texts(self):
        """Return the phrases on show, in reading order."""
        return tuple(phrase.text for phrase in self._phrases)

    def labels(self):
        """Return the labels on show, in reading order."""
        return tuple(self._labels[phrase.about] for phrase in self._phrases)

    def changeEvent(self, event):  # noqa: N802
        """Follow the font of the window, with digits of one width."""
        super().changeEvent(event)
        if event.type() == event.FontChange and hasattr(self, 'ages_sign'):
            for label in self._labels.values():
                label.setFont(theme.number_font(self.font()))
            self._widest.clear()
            self._arrange()

    def resizeEvent(self, event):  # noqa: N802
        """Place the phrases anew."""
        super().resizeEvent(event)
        self._arrange()

    def show_state(self, state):
        """Show a :class:`mhri.base.views.StateView`."""
        old = tuple(name for name, age in state.ages if age is not None and age > OLD_S)
        due = self._numbers.due()
        if not due and old == self._old:
            return
        self._old = old
        link = filter(None, words.figures_text(state.figures).split(words.BETWEEN_FIGURES))
        self._phrases = (
            *(_Phrase(text.partition(' ')[0], text) for text in link),
            *(_Phrase(text.partition(' ')[0], text)
              for text in capture_phrases(state.captured, state.drift)),
            *(_Phrase('age of ' + name, age_phrase(name, age),
                      theme.TEXT if name in old else theme.MUTED, True)
              for name, age in state.ages))
        self.ages_sign.show_sign((theme.TRIANGLE, theme.ATTENTION) if old else None)
        self.ages_sign.setToolTip(
            plain_tip('nothing new from: {}'.format(', '.join(old))) if old else '')
        self._show_phrases()
        self._arrange()

    def _show_phrases(self):
        """Put each phrase on the label of what it is about."""
        for phrase in self._phrases:
            if phrase.about not in self._labels:
                label = self._labels[phrase.about] = TextLine(self)
                label.setFont(theme.number_font(self.font()))
            self._labels[phrase.about].show_text(phrase.text, phrase.tone)
        shown = {phrase.about for phrase in self._phrases}
        for about, label in self._labels.items():
            label.setVisible(about in shown)

    def _width_of(self, phrase):
        """Return the width [px] that a phrase ever needed, so that a digit more moves nothing."""
        label = self._labels[phrase.about]
        needed = label.fontMetrics().horizontalAdvance(phrase.text) + 2
        self._widest[phrase.about] = max(needed, self._widest.get(phrase.about, 0))
        return self._widest[phrase.about]

    def _arrange(self):
        """Place sign and phrases on as many lines as they need."""
        unit = self.fontMetrics().height()
        gap = round(_GAP * unit)
        left = [(self._labels[phrase.about], self._width_of(phrase))
                for phrase in self._phrases if not phrase.at_end]
        right = [(self._labels[phrase.about], self._width_of(phrase))
                 for phrase in self._phrases if phrase.at_end]
        if right:
            # Its room is kept, so that nothing moves when something is old.
            right.insert(0, (self.ages_sign, unit))
        whole = sum(width + gap for _, width in left + right) - gap
        if whole <= self.width():
            bottom = self._flow(left, 0, 0, gap)
            self._flow(right, self.width() - sum(width + gap for _, width in right) + gap, 0, gap)
        else:
            bottom = self._flow(left, 0, 0, gap)
            bottom = self._flow(right, 0, bottom if left else 0, gap)
        if self.height() != max(bottom, self._line_height()):
            self.setFixedHeight(max(bottom, self._line_height()))
        self.updateGeometry()

    def _line_height(self):
        """Return the height of one line [px]."""
        return max(self.fontMetrics().height(), *(
            label.fontMetrics().height() for label in self._labels.values()), 0)

    def _flow(self, parts, x, y, gap):
        """Place widgets beside each other and on further lines; return where the last one ends."""
        height, begin = self._line_height(), x
        for widget, width in parts:
            if x > begin and x + width > self.width():
                x, y = begin, y + height
            widget.setGeometry(x, y, min(width, max(1, self.width())), height)
            x += width + gap
        return y + height

    def minimumSizeHint(self):  # noqa: N802
        """Return room for the longest phrase."""
        widest = max([self._width_of(phrase) for phrase in self._phrases], default=0)
        return QSize(max(widest, self._line_height()), self.height())

    def sizeHint(self):  # noqa: N802
        """Return the same: it takes the width there is."""
        return self.minimumSizeHint()
