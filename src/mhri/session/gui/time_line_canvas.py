# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drawing of a time line: driven robots, stops, marks and events; a click seeks there."""
import math

from python_qt_binding.QtCore import QPointF, QRectF, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter, QPalette, QPen, QPolygonF
from python_qt_binding.QtWidgets import QSizePolicy, QToolTip, QWidget

from mhri.base.gui import theme
from mhri.recording.folder import ERROR
from mhri.recording.recording import duration_text
from mhri.session.timeline import MARK, STOP, TimeLine

# Margin at both ends, so that the first and the last moment can be clicked [line heights].
_MARGIN_UNITS = 0.8
# Room for ticks above the lanes and for times below them [line heights].
_TICKS_UNITS, _TIMES_UNITS = 1.0, 1.1
_LANES_UNITS = 1.5
# Maximum distance of the pointer from a tick to show its text [px].
_NEAR_PX = 8
# Steps between labelled times [s]; the smallest that fits is used.
_STEPS_S = (5, 10, 30, 60, 300, 600, 1800, 3600, 7200, 21600)


class TimeLineCanvas(QWidget):
    """Shows a :class:`mhri.session.timeline.TimeLine` and the current position."""

    #: clicked or dragged position [s from the start]
    seek_requested = Signal(float)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._line = TimeLine(0.0, 0.0)
        self._numbers = {}
        self._position_s = 0.0
        self._asked = 0.0
        self._dragged = False
        self._build()

    def _build(self):
        """Set the fixed properties."""
        self.setObjectName('time_line_canvas')
        self.setAccessibleName('Time line')
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)

    def sizeHint(self):  # noqa: N802
        """Return the required size."""
        unit = self.fontMetrics().height()
        return QSize(20 * unit, round((_TICKS_UNITS + _LANES_UNITS + _TIMES_UNITS) * unit) + 4)

    minimumSizeHint = sizeHint

    def show_time_line(self, line, numbers):
        """Show a session; ``numbers`` is {robot: number}."""
        self._line, self._numbers = line, dict(numbers)
        self.update()

    def show_position(self, position_s):
        """Show the position, unless it is being dragged."""
        if not self._dragged and position_s != self._position_s:
            self._position_s = position_s
            self.update()

    def x_of(self, position_s):
        """Return the x coordinate of a position [px]."""
        left, width = self._room()
        return left + width * position_s / max(self._line.length_s, 1e-3)

    def _room(self):
        left = _MARGIN_UNITS * self.fontMetrics().height()
        return left, max(1.0, self.width() - 2 * left)

    def _position_of(self, x):
        left, width = self._room()
        return min(max(0.0, (x - left) / width), 1.0) * self._line.length_s

    def mousePressEvent(self, event):  # noqa: N802
        """Seek to the clicked position."""
        if event.button() == Qt.LeftButton:
            self._dragged = True
            self._go(event.pos().x())

    def mouseMoveEvent(self, event):  # noqa: N802
        """Follow a drag; otherwise show the texts of the ticks near the pointer."""
        if self._dragged:
            self._position_s = self._position_of(event.pos().x())
            self.update()
            return
        near = [tick for tick in self._line.ticks
                if abs(self.x_of(tick.at_s) - event.pos().x()) <= _NEAR_PX]
        QToolTip.showText(event.globalPos(), '\n'.join(
            ' '.join(filter(None, (duration_text(tick.at_s), tick.robot, tick.text)))
            for tick in near[:5]), self)

    def mouseReleaseEvent(self, event):  # noqa: N802
        """Seek to the position where a drag ends."""
        if event.button() == Qt.LeftButton and self._dragged:
            self._dragged = False
            if abs(self._position_of(event.pos().x()) - self._asked) > 1e-6:
                self._go(event.pos().x())

    def _go(self, x):
        self._asked = self._position_s = self._position_of(x)
        self.update()
        self.seek_requested.emit(self._asked)

    def paintEvent(self, event):  # noqa: N802
        """Paint lanes, stops, ticks, times and the position."""
        painter, unit = QPainter(self), self.fontMetrics().height()
        painter.setRenderHint(QPainter.Antialiasing)
        top = _TICKS_UNITS * unit
        lanes = QRectF(self._room()[0], top, self._room()[1], _LANES_UNITS * unit)
        painter.fillRect(lanes, self.palette().color(QPalette.Base))
        self._paint_driven(painter, lanes)
        self._paint_stops(painter, lanes)
        for tick in self._line.ticks:
            self._paint_tick(painter, tick, top, unit)
        self._paint_times(painter, lanes, unit)
        x = self.x_of(self._position_s)
        painter.setPen(QPen(theme.colour(theme.TEXT, self.palette()), 3))
        painter.drawLine(QPointF(x, 2), QPointF(x, lanes.bottom() + 3))

    def _paint_driven(self, painter, lanes):
        """Paint a lane for each robot that was driven, with its number."""
        names = sorted({span.robot for span in self._line.driven},
                       key=lambda name: self._numbers.get(name, 0))
        ink = theme.colour(theme.DRIVE, self.palette())
        high = lanes.height() / max(1, len(names))
        font = theme.number_font(self.font())
        font.setPixelSize(max(6, min(round(high) - 1, self.fontMetrics().height())))
        painter.setFont(font)
        for row, name in enumerate(names):
            top = lanes.top() + row * high
            for span in (one for one in self._line.driven if one.robot == name):
                part = QRectF(self.x_of(span.begin_s), top + 1,
                              max(2.0, self.x_of(span.end_s) - self.x_of(span.begin_s)), high - 2)
                painter.fillRect(part, ink)
                painter.setPen(theme.readable_on(ink))
                if part.width() > 2 * font.pixelSize():
                    painter.drawText(part.adjusted(3, 0, 0, 0), int(Qt.AlignVCenter | Qt.AlignLeft),
                                     str(self._numbers.get(name) or name))

    def _paint_stops(self, painter, lanes):
        """Hatch the spans in which STOP ALL was in force."""
        ink = theme.colour(theme.STOP, self.palette())
        for span in self._line.stopped:
            part = QRectF(self.x_of(span.begin_s), lanes.top(),
                          max(3.0, self.x_of(span.end_s) - self.x_of(span.begin_s)), lanes.height())
            theme.set_ink(painter, QPen(ink, 2))
            painter.drawRect(part)
            painter.save()
            painter.setClipRect(part)
            step = 8
            for number in range(math.ceil((part.width() + part.height()) / step) + 1):
                x = part.left() + number * step
                painter.drawLine(QPointF(x, part.top()),
                                 QPointF(x - part.height(), part.bottom()))
            painter.restore()

    def _paint_tick(self, painter, tick, bottom, unit):
        """Paint a flag for a mark, an octagon for a stop, a triangle for another event."""
        x, palette = self.x_of(tick.at_s), self.palette()
        side = 0.8 * unit
        if tick.kind == MARK:
            ink = theme.colour(theme.TEXT, palette)
            theme.set_ink(painter, QPen(ink, 2), ink)
            painter.drawLine(QPointF(x, bottom), QPointF(x, bottom - side))
            painter.drawPolygon(QPolygonF([
                QPointF(x, bottom - side), QPointF(x + 0.7 * side, bottom - 0.7 * side),
                QPointF(x, bottom - 0.4 * side)]))
            return
        shape, tone = (theme.OCTAGON, theme.STOP) if tick.kind == STOP else (
            theme.TRIANGLE, theme.STOP if tick.severity == ERROR else theme.ATTENTION)
        theme.paint_sign(painter, QRectF(x - side / 2, bottom - side - 2, side, side), shape,
                         theme.colour(tone, palette), palette.color(QPalette.Window))

    def _paint_times(self, painter, lanes, unit):
        """Label the times below, as densely as fits."""
        painter.setFont(theme.number_font(self.font()))
        painter.setPen(theme.colour(theme.MUTED, self.palette()))
        room = theme.text_width(painter.font(), '0:00:00') + unit
        length_s = max(self._line.length_s, 1e-3)
        step_s = next((step for step in _STEPS_S if lanes.width() * step / length_s > room),
                      _STEPS_S[-1])
        for number in range(int(length_s // step_s) + 1):
            x = self.x_of(number * step_s)
            where = QRectF(x - room / 2, lanes.bottom() + 2, room, _TIMES_UNITS * unit)
            where.moveLeft(min(max(0.0, where.left()), self.width() - room))
            painter.drawText(where, int(Qt.AlignCenter), duration_text(number * step_s))
