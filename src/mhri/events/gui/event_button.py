# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The button of unseen events in the bottom line: a click opens the list, or looks at the robot."""
from python_qt_binding.QtCore import QRectF, QSize, Qt, Signal
from python_qt_binding.QtWidgets import QSizePolicy

from mhri.base.gui import theme
from mhri.base.gui.controls import Button, paint_control
from mhri.base.gui.labels import plain_tip
from mhri.events.events import ALARM, ATTENTION, CALM

EVENTS, LOOK = 'Events', 'Look'
# Width from which on there is room for the robot's button beside the text [line heights].
_ROOMY_UNITS = 18.0

SEVERITY_SIGNS = {
    CALM: (theme.RING, theme.MUTED),
    ATTENTION: theme.WARNING,
    ALARM: (theme.OCTAGON, theme.STOP),
}


class EventButton(Button):
    """A button with the worst unseen event, shortened to fit, and one that looks at its robot."""

    #: the robot of the event
    look_requested = Signal(str)

    def __init__(self, parent=None):
        super().__init__(EVENTS, parent)
        self._texts = (EVENTS,)
        #: the displayed severity
        self.severity = CALM
        self._robot = ''
        self._build()

    def _build(self):
        """Set the properties; it expands to the available width."""
        theme.for_fingers(self, self.objectName())
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self.look_button = theme.finger_button(self, 'look_event_button', LOOK)
        self.look_button.clicked.connect(lambda: self.look_requested.emit(self._robot))
        self.look_button.hide()

    def resizeEvent(self, event):  # noqa: N802
        """Place the button of the robot at the right end, where it moves nothing."""
        super().resizeEvent(event)
        self._place_look()

    def _place_look(self):
        width = self.look_button.sizeHint().width()
        width = max(width, self.look_button.minimumWidth())
        self.look_button.setGeometry(self.width() - width, 0, width, self.height())
        self.look_button.setVisible(bool(self._robot) and self.width() >
                                    _ROOMY_UNITS * self.fontMetrics().height())

    def shown_text(self):
        """Return the text that fits the width."""
        return theme.fitting_text(self.fontMetrics(), self._texts, self._room().width())

    def show_headline(self, headline, count):
        """Show a :class:`mhri.events.events.Headline` and the number of unseen events."""
        text = headline.text or EVENTS
        if headline.robot != self._robot:
            self._robot = headline.robot
            self.look_button.setToolTip(plain_tip('look at ' + headline.robot))
            self._place_look()
        if (text, headline.severity) == (self.text(), self.severity):
            return
        self.severity = headline.severity
        number = '{} event{}'.format(count, '' if count == 1 else 's')
        self._texts = (text, text.partition(' (')[0], number, str(count)) \
            if headline.severity != CALM else (text, str(count)) if count else (text,)
        self.setText(text)
        self.setToolTip(plain_tip(text))

    def sizeHint(self):  # noqa: N802
        """Return the size for a short headline."""
        return QSize(theme.text_width(self.font(), '88 events') + 2 * theme.touch_size(self),
                     theme.touch_size(self))

    def minimumSizeHint(self):  # noqa: N802
        """Return the size for the sign and a number."""
        return QSize(theme.text_width(self.font(), '88') + 2 * theme.touch_size(self),
                     theme.touch_size(self))

    def _room(self):
        """Return the :class:`QRect` of the text."""
        unit = self.fontMetrics().height()
        left = unit // 2 if self.severity == CALM else 2 * unit
        right = 0 if self.look_button.isHidden() else self.look_button.width()
        return self.rect().adjusted(left, 0, -unit // 2 - right, 0)

    def paintEvent(self, event):  # noqa: N802
        """Paint the button, the shape of the severity and the text."""
        painter = theme.smooth_painter(self)
        paint_control(painter, self, self.isDown())
        palette, unit = self.palette(), self.fontMetrics().height()
        if self.severity != CALM:
            shape, tone = SEVERITY_SIGNS[self.severity]
            theme.paint_sign(painter, QRectF(unit // 2, (self.height() - unit) / 2, unit, unit),
                             shape, theme.colour(tone, palette), palette.color(palette.Button))
        painter.setPen(palette.color(palette.ButtonText))
        align = Qt.AlignHCenter if self.severity == CALM else Qt.AlignLeft
        painter.drawText(self._room(), int(align | Qt.AlignVCenter), self.shown_text())
