# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The lines below a tile's header: link, motion capture, and ages of streams."""
from typing import NamedTuple

from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.flow import FlowLayout, let_height_follow
from mhri.base.gui.labels import plain_tip, Sign, TextLine
from mhri.base.gui.pending import Pace

# Older streams are highlighted [s].
OLD_S = 1.0
_AGE_PLACES = 6
_FIGURE_SPACE = '\u2007'
# Gap between two phrases [line heights].
_GAP = 0.9


def age_phrase(name, age_s):
    """Return a stream's name and age, with the age padded to its maximum width.

    :param age_s: age [s], None before the first message
    """
    return '{} {}'.format(
        name, (words.age_text(age_s) or words.UNKNOWN).rjust(_AGE_PLACES, _FIGURE_SPACE))


def capture_phrases(captured, drift):
    """Return a robot's odometry error and its pose by motion capture; () for None."""
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
    """A phrase: subject, text, colour, and whether it ends the line."""

    about: str
    text: str
    tone: str = theme.MUTED
    at_end: bool = False


class StateLine(QWidget):
    """Phrases, updated at most four times a second, and a sign while a stream is old.

    They share one line if there is room, link and motion capture on the left, ages on the right;
    otherwise they wrap, so that none is ever cut off.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._numbers = Pace()
        self._old = ()
        self._labels = {}
        self._phrases = self._order = ()
        self._build()

    def _build(self):
        """Create the sign and the two parts; labels are created on demand."""
        gap = round(_GAP * self.fontMetrics().height())
        parts, line = (QWidget(self), QWidget(self)), FlowLayout(self, gap, 0)
        for widget in (self, *parts):
            let_height_follow(widget)
        policy = parts[0].sizePolicy()
        policy.setHorizontalPolicy(QSizePolicy.Expanding)
        parts[0].setSizePolicy(policy)
        for part in parts:
            line.addWidget(part)
        self._left, self._right = (FlowLayout(part, gap, 0) for part in parts)
        # Reserve its space, so that nothing moves when a stream gets old.
        self.ages_sign = Sign(self)
        self._right.addWidget(self.ages_sign)
        self.setMinimumHeight(self.fontMetrics().height())

    def texts(self):
        """Return the displayed phrases, in reading order."""
        return tuple(phrase.text for phrase in self._phrases)

    def labels(self):
        """Return the displayed labels, in reading order."""
        return tuple(self._labels[phrase.about] for phrase in self._phrases)

    def changeEvent(self, event):  # noqa: N802
        """Apply the font of the window, with digits of equal width."""
        super().changeEvent(event)
        if event.type() == event.FontChange:
            for label in self.findChildren(TextLine):
                label.setFont(theme.number_font(self.font()))
                label.fix_width(label.text())

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
        self.ages_sign.show_sign(theme.WARNING if old else None)
        self.ages_sign.setToolTip(
            plain_tip('nothing new from: {}'.format(', '.join(old))) if old else '')
        self._show_phrases()

    def _show_phrases(self):
        """Show each phrase in the label of its subject."""
        for phrase in self._phrases:
            if phrase.about not in self._labels:
                label = self._labels[phrase.about] = TextLine(self)
                label.setFont(theme.number_font(self.font()))
            label = self._labels[phrase.about]
            label.show_text(phrase.text, phrase.tone)
            # Never shrink, so that an additional digit moves nothing.
            if theme.text_width(label.font(), phrase.text) > label.minimumWidth():
                label.fix_width(phrase.text)
        order = tuple(phrase.about for phrase in self._phrases)
        if order != self._order:
            self._order = order
            for about, label in self._labels.items():
                label.setVisible(about in order)
            for phrase, label in zip(self._phrases, self.labels()):
                part = self._right if phrase.at_end else self._left
                part.removeWidget(label)
                part.addWidget(label)
