# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line below a bot window's header: link, motion capture, and how old what is shown is."""
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from mhri.gui.screen import theme, words
from mhri.gui.screen.labels import Sign, TextLine
from mhri.gui.screen.pending import Pace

NUMBERS_PERIOD_S = 0.25
# A stream that is older than this is pointed at.
OLD_S = 1.0
_AGE_PLACES = 6
_FIGURE_SPACE = '\u2007'


def ages_text(ages):
    """Return the ages of streams as one line, each with as much room as the longest needs.

    :param ages: pairs (name, age [s] or None where nothing has come yet)
    """
    return '   '.join('{} {}'.format(
        name, (words.age_text(age) or words.UNKNOWN).rjust(_AGE_PLACES, _FIGURE_SPACE))
        for name, age in ages)


def capture_text(captured, drift):
    """Return where motion capture sees a robot, and how far its odometry is off; '' for None."""
    if captured is None:
        return ''
    text = 'captured x {}  y {}  {}'.format(
        words.metres_text(captured.x_m), words.metres_text(captured.y_m),
        words.heading_text(captured.heading_rad))
    if drift is None:
        return text
    return 'odometry off {}, {}   {}'.format(
        words.metres_text(drift.distance_m), words.heading_text(abs(drift.heading_rad)), text)


class StateLine(QWidget):
    """Two texts that change four times a second at the most, and a sign while a stream is old."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._numbers = Pace(NUMBERS_PERIOD_S)
        self._old = ()
        self._build()

    def _build(self):
        """Make and place the parts."""
        self.capture_label = TextLine(self)
        self.ages_sign = Sign(self)
        self.ages_label = TextLine(self)
        self.ages_label.setAlignment(Qt.AlignRight | Qt.AlignVCenter)
        self.ages_label.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)
        self.capture_label.setObjectName('capture_label')
        self.ages_label.setObjectName('ages_label')
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(6)
        row.addWidget(self.capture_label, 1)
        row.addWidget(self.ages_sign)
        row.addWidget(self.ages_label)
        self.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)

    def changeEvent(self, event):  # noqa: N802
        """Follow the font of the window, with digits of one width."""
        super().changeEvent(event)
        if event.type() == event.FontChange and hasattr(self, 'ages_label'):
            for label in (self.capture_label, self.ages_label):
                label.setFont(theme.number_font(self.font()))

    def show_state(self, state):
        """Show a :class:`mhri.core.screen.views.StateView`."""
        old = tuple(name for name, age in state.ages if age is not None and age > OLD_S)
        due = self._numbers.due()
        if not due and old == self._old:
            return
        self._old = old
        texts = (words.figures_text(state.figures), capture_text(state.captured, state.drift))
        self.capture_label.show_text('   '.join(filter(None, texts)), theme.MUTED)
        self.ages_label.show_text(ages_text(state.ages), theme.TEXT if old else theme.MUTED)
        self.ages_label.updateGeometry()
        self.ages_sign.show_sign((theme.TRIANGLE, theme.ATTENTION) if old else None)
        self.ages_sign.setToolTip('nothing new from: {}'.format(', '.join(old)) if old else '')
