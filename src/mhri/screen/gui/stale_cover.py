# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A cover for a window that is no longer drawn, so that an old picture does not look current."""
import time

from python_qt_binding.QtCore import QEvent, QPoint, QRect, QRectF, Qt, QTimer
from python_qt_binding.QtGui import QFontMetricsF, QPainter, QPalette, QPen, QRegion
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme, words
from mhri.base.text import tidy_text

# Interval of the checks, and age at which the cover appears: together less than 1 s.
LOOK_MS = 200
OLD_AFTER_S = 0.6
# A failure to paint a part is shown for this long after its last occurrence.
SLIP_SHOWN_S = 2.0
_HATCH_UNITS = 3.0
# Scales of the text size; the first line is larger. Small tiles use a smaller scale.
_SCALES = (1.0, 0.85, 0.7, 0.55)
_WRAPPED = int(Qt.AlignLeft | Qt.AlignTop | Qt.TextWordWrap)
_MAX_PX = 10000.0


class StaleCover(QWidget):
    """Covers a whole window and passes clicks through, so that STOP ALL stays in reach.

    Of a widget inside a covered window the cover stays hidden: one banner says it for all.
    It becomes active with the first :meth:`drawn`; a hidden window does not count as old.

    :param over: the window or widget to cover
    :param clock: function that returns time [s, monotonic]
    :param clear: a widget in it that still works: nothing is painted over it
    """

    def __init__(self, over, clock=time.monotonic, clear=None):
        super().__init__(over)
        self._clock, self._clear = clock, clear
        self._drawn_at = None
        self._slipped_at = None
        self._reason = ''
        self._build()

    def _build(self):
        """Create the timer, and follow the size of the covered widget."""
        self.setObjectName('stale_cover')
        # STOP ALL below the cover stays usable.
        self.setAttribute(Qt.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.NoFocus)
        self.hide()
        self._timer = QTimer(self, interval=LOOK_MS, timeout=self.refresh)
        self.parentWidget().installEventFilter(self)

    def drawn(self):
        """Handle a complete drawing of the window."""
        self._drawn_at = self._clock()
        if not self._timer.isActive():
            self._timer.start()
        if self.isVisible():
            self.refresh()

    def failed(self, reason):
        """Handle a failure to draw the window."""
        self._reason = tidy_text(reason)
        if self._drawn_at is None:
            self._drawn_at = self._clock() - OLD_AFTER_S
            self._timer.start()

    def slipped(self, reason):
        """Handle a failure to paint a part of the window."""
        self._slipped_at = self._clock()
        self.failed(reason)

    def end(self):
        """Stop checking, when nothing will be drawn any more."""
        self._timer.stop()
        self.hide()

    def refresh(self):
        """Show or hide the cover, depending on the time of the last drawing."""
        if self.is_due() and not self._is_covered():
            self.setGeometry(self.parentWidget().rect())
            self.raise_()
            self.show()
            self.update()
        elif self.isVisible() or not self.is_due():
            self._reason = ''
            self.hide()

    def is_due(self):
        """Return whether the widget shows something old, or a part of it was not painted."""
        now = self._clock()
        return self._drawn_at is not None and now - self._drawn_at >= OLD_AFTER_S or \
            self._slipped_at is not None and now - self._slipped_at < SLIP_SHOWN_S

    def _is_covered(self):
        """Return whether a widget around the covered one is covered, too, in the same window."""
        widget = self.parentWidget()
        while widget is not None and not widget.isWindow():
            widget = widget.parentWidget()
            cover = widget and widget.findChild(
                StaleCover, options=Qt.FindDirectChildrenOnly)
            if cover and cover.is_due():
                return True
        return False

    def texts(self):
        """Return the displayed lines."""
        age_s = 0.0 if self._drawn_at is None else self._clock() - self._drawn_at
        lines = ['SCREEN FROZEN',
                 'What it shows is {} old. STOP ALL still works.'.format(
                     words.age_text(age_s))] if age_s >= OLD_AFTER_S else \
            ['A PART OF THIS SCREEN IS NOT DRAWN', 'It may show old data.']
        return lines + [self._reason] if self._reason else lines

    def eventFilter(self, watched, event):  # noqa: N802
        """Follow the size of the covered widget."""
        if event.type() == QEvent.Resize and self.isVisible():
            self.setGeometry(self.parentWidget().rect())
        return False

    def paintEvent(self, event):  # noqa: N802
        """Paint stripes over everything, and the text on its own background at the top."""
        painter = QPainter(self)
        if self._clear is not None:
            painter.setClipRegion(QRegion(self.rect()) - QRegion(QRect(
                self._clear.mapTo(self.parentWidget(), QPoint()), self._clear.size())))
        ink, unit = theme.colour(theme.STOP, self.palette()), self.fontMetrics().height()
        painter.setPen(QPen(ink, 2))
        step = max(8, round(_HATCH_UNITS * unit))
        for x in range(-self.height(), self.width(), step):
            painter.drawLine(x, self.height(), x + self.height(), 0)
        rows = self._rows(unit)
        band = QRectF(0, 0, self.width(), rows[-1][1].bottom() + 0.5 * unit)
        painter.fillRect(band, self.palette().color(QPalette.Window))
        painter.setPen(QPen(ink, 4))
        painter.drawRect(QRectF(self.rect()).adjusted(2, 2, -2, -2))
        painter.drawLine(band.bottomLeft(), band.bottomRight())
        side = 2.0 * unit
        theme.paint_sign(painter, QRectF(unit, 0.6 * unit, side, side), theme.OCTAGON, ink,
                         self.palette().color(QPalette.Window))
        painter.setPen(theme.colour(theme.TEXT, self.palette()))
        for font, room, line in rows:
            painter.setFont(font)
            painter.drawText(room, _WRAPPED, line)

    def _font(self, row, scale):
        """Return the font of a line."""
        return theme.larger(
            self.font(), scale * (theme.TITLE if row == 0 else theme.BODY), bold=row == 0)

    def _rows(self, unit):
        """Return (font, rectangle, text) of each line, from top to bottom, wrapped if narrow."""
        found, top, width = [], 0.6 * unit, self.width() - 5.0 * unit
        texts = self.texts()
        scale = next((scale for scale in _SCALES if theme.text_width(
            self._font(0, scale), *texts[0].split()) <= width), _SCALES[-1])
        for row, line in enumerate(texts):
            font = self._font(row, scale)
            metrics = QFontMetricsF(font)
            if row > 1:
                # The reason is for developers and also in the log.
                line = metrics.elidedText(line, Qt.ElideRight, width)
            room = metrics.boundingRect(QRectF(4 * unit, top, width, _MAX_PX), _WRAPPED, line)
            found.append((font, QRectF(4 * unit, top, width, room.height() + 1.0), line))
            top += room.height() + 0.2 * unit
        return found
