# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What lies over a window that is not drawn any more: nobody shall take an old picture for now."""
import time

from python_qt_binding.QtCore import QEvent, QRectF, Qt, QTimer
from python_qt_binding.QtGui import QFontMetricsF, QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme, words
from mhri.base.text import tidy_text

# It looks so often, and shows after so long: within 1 s.
LOOK_MS = 200
OLD_AFTER_S = 0.6
# A part that could not be painted is told for so long after the last time.
SLIP_SHOWN_S = 2.0
_HATCH_UNITS = 3.0
# Of the size of the words; the first line is larger. A small tile takes a smaller size.
_SCALES = (1.0, 0.85, 0.7, 0.55)
_WRAPPED = int(Qt.AlignLeft | Qt.AlignTop | Qt.TextWordWrap)
_MOST_PX = 10000.0


class StaleCover(QWidget):
    """Lies over a whole window and lets every click through: STOP ALL stays in reach.

    It begins with the first :meth:`drawn`; a window that is hidden is not old.

    :param over: the window or widget
    :param clock: seconds, monotonic
    """

    def __init__(self, over, clock=time.monotonic):
        super().__init__(over)
        self._clock = clock
        self._drawn_at = None
        self._slipped_at = None
        self._reason = ''
        self._build()

    def _build(self):
        """Make the timer, and follow the size of what is below."""
        self.setObjectName('stale_cover')
        # STOP ALL below it can be pressed all the same.
        self.setAttribute(Qt.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.NoFocus)
        self.hide()
        self._timer = QTimer(self)
        self._timer.setInterval(LOOK_MS)
        self._timer.timeout.connect(self.look)
        self.parentWidget().installEventFilter(self)

    def drawn(self):
        """Take note that the window was drawn whole."""
        self._drawn_at = self._clock()
        if not self._timer.isActive():
            self._timer.start()
        if self.isVisible():
            self.look()

    def failed(self, reason):
        """Keep why the window could not be drawn."""
        self._reason = tidy_text(reason)
        if self._drawn_at is None:
            self._drawn_at = self._clock() - OLD_AFTER_S
            self._timer.start()

    def slipped(self, reason):
        """Take note that a part of it could not be painted, though the rest is."""
        self._slipped_at = self._clock()
        self.failed(reason)

    def end(self):
        """Look no more: nothing will be drawn from now on."""
        self._timer.stop()
        self.hide()

    def look(self):
        """Show or hide, as it has to be now."""
        now = self._clock()
        old = self._drawn_at is not None and now - self._drawn_at >= OLD_AFTER_S
        slipped = self._slipped_at is not None and now - self._slipped_at < SLIP_SHOWN_S
        if old or slipped:
            self.setGeometry(self.parentWidget().rect())
            self.raise_()
            self.show()
            self.update()
        else:
            self._reason = ''
            self.hide()

    def texts(self):
        """Return the lines that it shows."""
        age_s = 0.0 if self._drawn_at is None else self._clock() - self._drawn_at
        lines = ['THIS SCREEN STANDS STILL',
                 'What it shows is {} old. STOP ALL works all the same.'.format(
                     words.age_text(age_s))] if age_s >= OLD_AFTER_S else \
            ['A PART OF THIS SCREEN IS NOT DRAWN', 'What is seen there may be old.']
        return lines + [self._reason] if self._reason else lines

    def eventFilter(self, watched, event):  # noqa: N802
        """Stay as large as what is below."""
        if event.type() == QEvent.Resize and self.isVisible():
            self.setGeometry(self.parentWidget().rect())
        return False

    def paintEvent(self, event):  # noqa: N802
        """Paint stripes over everything, and the words on a ground of their own at the top."""
        painter = QPainter(self)
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
        return theme.larger(self.font(), scale * (1.3 if row == 0 else 1.0), bold=row == 0)

    def _rows(self, unit):
        """Return (font, where, text) of each line, below each other, broken where it is narrow."""
        found, top, width = [], 0.6 * unit, self.width() - 5.0 * unit
        texts = self.texts()
        scale = next((scale for scale in _SCALES if theme.text_width(
            self._font(0, scale), *texts[0].split()) <= width), _SCALES[-1])
        for row, line in enumerate(texts):
            font = self._font(row, scale)
            metrics = QFontMetricsF(font)
            if row > 1:
                # Why it failed is for whoever mends it: it is in the log, too.
                line = metrics.elidedText(line, Qt.ElideRight, width)
            room = metrics.boundingRect(QRectF(4 * unit, top, width, _MOST_PX), _WRAPPED, line)
            found.append((font, QRectF(4 * unit, top, width, room.height() + 1.0), line))
            top += room.height() + 0.2 * unit
        return found
