# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What has happened that nobody has looked at yet, in the bottom line: a click opens the list."""
from python_qt_binding.QtCore import QRectF, QSize, Qt
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QPushButton, QSizePolicy, QStyle, QStyleOptionButton

from mhri.base.gui import theme
from mhri.base.gui.labels import plain_tip
from mhri.events.events import ALARM, ATTENTION, CALM

EVENTS = 'Events'

SEVERITY_SIGNS = {
    CALM: (theme.RING, theme.MUTED),
    ATTENTION: (theme.TRIANGLE, theme.ATTENTION),
    ALARM: (theme.OCTAGON, theme.STOP),
}


class EventButton(QPushButton):
    """A button with the worst unseen event; its words give way, the longest first."""

    def __init__(self, parent=None):
        super().__init__(EVENTS, parent)
        self._texts = (EVENTS,)
        self._severity = CALM
        self._build()

    def _build(self):
        """Take the room there is."""
        self.setFocusPolicy(Qt.TabFocus)
        self.setAutoDefault(False)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self.setMinimumHeight(theme.touch_size(self))

    @property
    def severity(self):
        """The severity on show."""
        return self._severity

    def shown_text(self):
        """Return what can be read in the width there is."""
        return theme.fitting_text(self.fontMetrics(), self._texts, self._room().width())

    def show_headline(self, headline, count):
        """Show a :class:`mhri.events.events.Headline` of so many unseen events."""
        text = headline.text or EVENTS
        if (text, headline.severity) == (self.text(), self._severity):
            return
        self._severity = headline.severity
        number = '{} event{}'.format(count, '' if count == 1 else 's')
        self._texts = (text, text.partition(' (')[0], number, str(count)) \
            if headline.severity != CALM else (text, str(count)) if count else (text,)
        self.setText(text)
        self.setToolTip(plain_tip(text))

    def sizeHint(self):  # noqa: N802
        """Return the room for a short headline."""
        return QSize(theme.text_width(self.font(), '88 events') + 2 * theme.touch_size(self),
                     theme.touch_size(self))

    def minimumSizeHint(self):  # noqa: N802
        """Return the room for a number of events."""
        return QSize(theme.text_width(self.font(), '888 events') + theme.touch_size(self),
                     theme.touch_size(self))

    def _room(self):
        """Return where the words are, a :class:`QRect`."""
        unit = self.fontMetrics().height()
        left = unit // 2 if self._severity == CALM else 2 * unit
        return self.rect().adjusted(left, 0, -unit // 2, 0)

    def paintEvent(self, event):  # noqa: N802
        """Paint the button, the shape of the severity and the words."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.Antialiasing)
        option = QStyleOptionButton()
        self.initStyleOption(option)
        option.text = ''
        self.style().drawControl(QStyle.CE_PushButton, option, painter, self)
        palette, unit = self.palette(), self.fontMetrics().height()
        if self._severity != CALM:
            shape, tone = SEVERITY_SIGNS[self._severity]
            theme.paint_sign(painter, QRectF(unit // 2, (self.height() - unit) / 2, unit, unit),
                             shape, theme.colour(tone, palette), palette.color(palette.Button))
        painter.setPen(palette.color(palette.ButtonText))
        align = Qt.AlignHCenter if self._severity == CALM else Qt.AlignLeft
        painter.drawText(self._room(), int(align | Qt.AlignVCenter), self.shown_text())
