# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A ring that fills while STOP ALL is held, and says what then happens."""
from python_qt_binding.QtCore import QElapsedTimer, QRectF, Qt, QTimer
from python_qt_binding.QtGui import QFontMetrics, QPen
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme

#: whoever lets go earlier meant the stop alone, and sees no ring [s]
SHOWN_AFTER_S = 0.3
_TEXT, _SHORTER = '{:g} s: motor power', 'motor power'
_FRAME_MS = 33
_PEN, _SIDE = 0.12, 0.72


class HoldRing(QWidget):
    """Lies over a widget and passes all events through.

    :param over: the widget to cover while the stop is held
    :param hold_s: time to hold it for [s]
    """

    def __init__(self, over, hold_s):
        super().__init__(over)
        self._hold_s = hold_s
        self._clock = QElapsedTimer()
        self.setObjectName('hold_ring')
        self.setAttribute(Qt.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.NoFocus)
        self.hide()
        self._timer = QTimer(self, interval=_FRAME_MS, timeout=self._show_share)

    def begin(self):
        """Start filling; a ring that is filling goes on."""
        if not self._timer.isActive():
            self._clock.start()
            self._timer.start()

    def end(self):
        """Hide: the stop was let go."""
        self._timer.stop()
        self.hide()

    def share(self):
        """Return the elapsed share of the time, in [0, 1]; 0 while the stop is not held."""
        return min(1.0, self._clock.elapsed() / (1000.0 * self._hold_s)) \
            if self._timer.isActive() else 0.0

    def text(self):
        """Return the text that fits."""
        texts = _TEXT.format(self._hold_s), _SHORTER
        return theme.fitting_text(QFontMetrics(self._bold()), texts, self._room().width())

    def _bold(self):
        """Return the font of the text, as large as that of the window."""
        return theme.larger(theme.base_font(self.window().font()), theme.BODY, bold=True)

    def _show_share(self):
        """Show how much of the time has passed; hide a full ring, its power cut is under way."""
        share = self.share()
        if share >= 1.0:
            self.end()
        elif share * self._hold_s >= SHOWN_AFTER_S:
            self.setGeometry(self.parentWidget().rect())
            self.show()
            self.raise_()
            self.update()

    def _room(self):
        """Return the rectangle of the text."""
        return self.rect().adjusted(self.height(), 0, -self.height() // 6, 0)

    def paintEvent(self, event):  # noqa: N802
        """Paint the ring at the left, and the text beside it."""
        painter = theme.smooth_painter(self)
        theme.set_ink(painter, brush=theme.STOP_GROUND)
        painter.drawRoundedRect(QRectF(self.rect()), 6, 6)
        side = _SIDE * self.height()
        ring = QRectF(0, 0, side, side)
        ring.moveCenter(QRectF(0, 0, self.height(), self.height()).center())
        for share, ink in ((1.0, theme.STOP_GROUND.darker(150)), (self.share(), Qt.white)):
            painter.setPen(QPen(ink, _PEN * self.height(), Qt.SolidLine, Qt.FlatCap))
            painter.drawArc(ring, 90 * 16, -round(share * 360 * 16))
        painter.setFont(self._bold())
        painter.setPen(Qt.white)
        painter.drawText(self._room(), int(Qt.AlignLeft | Qt.AlignVCenter), self.text())
