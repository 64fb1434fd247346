# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A drawn cloud with its scale, and the hand that turns it."""
import math

from python_qt_binding.QtCore import QPointF, QRectF, QSize, Qt, Signal
from python_qt_binding.QtGui import QColor, QImage, QPainter, QPen
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.sensors.cloud_picture import CEILING_M, GROUND, TABLE
from mhri.sensors.orbit import Orbit

# Larger pictures are drawn smaller and scaled up: a cloud is no sharper for more.
MOST_PIXELS = 1_300_000
_KEY_PX = 20
_ARROWS = {Qt.Key_Left: (-1, 0), Qt.Key_Right: (1, 0), Qt.Key_Up: (0, -1), Qt.Key_Down: (0, 1)}
_ZOOMS = {Qt.Key_Plus: 1.0, Qt.Key_Equal: 1.0, Qt.Key_Minus: -1.0}
# A notch of a usual wheel [eighths of a degree].
_NOTCH = 120.0
_SHADE = QColor(0, 0, 0, 150)
_FRAME_PX = 5


class CloudCanvas(QWidget):
    """Shows a :class:`mhri.sensors.cloud_picture.Picture`, or words where there is none.

    Drag turns, drag with the right or middle button moves, the wheel zooms, a double click asks for
    the view that shows all. With the keyboard on it (by Tab, not by a click, so that the arrows go
    on driving): arrows turn, with Shift they move, plus and minus zoom, Home shows all.
    """

    #: it is looked at from another place: :attr:`orbit`
    moved = Signal()
    #: show all, please
    reset_requested = Signal()
    #: there is another :meth:`drawing_size`
    resized = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self.orbit = Orbit()
        self._picture = None
        self._image = None
        self._unit = ''
        self._upside_down = False
        self._words = 'waiting for the first cloud'
        self._note = ''
        self._warning = ''
        self._grip = None
        self._build()

    def _build(self):
        """Set what never changes."""
        self.setObjectName('cloud_canvas')
        self.setAccessibleName('point cloud; arrows turn it, plus and minus zoom')
        self.setAttribute(Qt.WA_OpaquePaintEvent)
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        keep_arrows(self)
        # From high, on top, to low.
        self._scale = QImage(1, len(TABLE), QImage.Format_RGB32)
        for row, colour in enumerate(TABLE[::-1].tolist()):
            self._scale.setPixel(0, row, colour)

    @property
    def picture(self):
        """The picture on show, or None."""
        return self._picture

    @property
    def warning(self):
        """What is said across the picture, '' while it is live."""
        return self._warning

    @property
    def words(self):
        """What is said where there is no picture."""
        return self._words

    def show_picture(self, picture, unit, upside_down=False, note=''):
        """Show a :class:`Picture`; its pixels are not copied.

        :param unit: of its scale, e.g. 'm'
        :param upside_down: what is little is light
        :param note: what is said in its corner besides the floor's lines
        """
        height, width = picture.pixels.shape
        self._image = QImage(picture.pixels.data, width, height, 4 * width, QImage.Format_RGB32)
        self._picture, self._unit, self._note = picture, unit, note
        self._upside_down = upside_down
        self.update()

    def show_warning(self, warning):
        """Say across the picture why it is not to be trusted; '' takes it away."""
        if warning != self._warning:
            self._warning = warning
            self.update()

    def clear(self, words):
        """Show words instead of a picture."""
        if self._picture is not None or words != self._words:
            self._picture, self._image, self._words, self._warning = None, None, words, ''
            self.update()

    def drawing_size(self):
        """Return (width, height) that a picture is to have [px]."""
        ratio = self.devicePixelRatioF()
        width, height = max(1.0, self.width() * ratio), max(1.0, self.height() * ratio)
        share = min(1.0, math.sqrt(MOST_PIXELS / (width * height)))
        return max(1, round(width * share)), max(1, round(height * share))

    def _look(self, orbit):
        """Look from another place."""
        self.orbit = orbit
        self.moved.emit()

    def mousePressEvent(self, event):  # noqa: N802
        """Take hold."""
        self._grip = QPointF(event.pos())

    def mouseMoveEvent(self, event):  # noqa: N802
        """Turn or move with the hand."""
        if self._grip is None or not event.buttons():
            return
        way, self._grip = QPointF(event.pos()) - self._grip, QPointF(event.pos())
        if event.buttons() & Qt.LeftButton:
            self._look(self.orbit.turned(way.x(), way.y()))
        else:
            self._look(self.orbit.moved(way.x(), way.y(), self.height()))

    def mouseReleaseEvent(self, event):  # noqa: N802
        """Let go, where no other button holds on."""
        if not event.buttons():
            self._grip = None

    def mouseDoubleClickEvent(self, event):  # noqa: N802
        """Show all."""
        self._grip = None
        if event.button() == Qt.LeftButton:
            self.reset_requested.emit()

    def wheelEvent(self, event):  # noqa: N802
        """Zoom."""
        self._look(self.orbit.zoomed(event.angleDelta().y() / _NOTCH))
        event.accept()

    def keyPressEvent(self, event):  # noqa: N802
        """Turn, move, zoom, show all."""
        way = _ARROWS.get(event.key())
        if way is not None and event.modifiers() & Qt.ShiftModifier:
            # What is looked through goes the way of the arrow, so what is seen goes against it.
            self._look(self.orbit.moved(-_KEY_PX * way[0], -_KEY_PX * way[1], self.height()))
        elif way is not None:
            self._look(self.orbit.turned(_KEY_PX * way[0], _KEY_PX * way[1]))
        elif event.key() in _ZOOMS:
            self._look(self.orbit.zoomed(_ZOOMS[event.key()]))
        elif event.key() == Qt.Key_Home:
            self.reset_requested.emit()
        else:
            super().keyPressEvent(event)

    def resizeEvent(self, event):  # noqa: N802
        """Ask for a picture of the new size."""
        super().resizeEvent(event)
        self.resized.emit()

    def focusInEvent(self, event):  # noqa: N802
        """Show where the keyboard is."""
        super().focusInEvent(event)
        self.update()

    focusOutEvent = focusInEvent  # noqa: N815

    def sizeHint(self):  # noqa: N802
        """Return a comfortable size."""
        unit = self.fontMetrics().height()
        return QSize(20 * unit, 15 * unit)

    def minimumSizeHint(self):  # noqa: N802
        """Return the least in which something can be seen."""
        unit = self.fontMetrics().height()
        return QSize(9 * unit, 6 * unit)

    def paintEvent(self, event):  # noqa: N802
        """Paint picture, scale and words."""
        painter = QPainter(self)
        room = QRectF(self.rect())
        unit = self.fontMetrics().height()
        painter.fillRect(room, QColor(GROUND))
        if self._image is None:
            painter.setPen(Qt.white)
            painter.drawText(room.adjusted(unit, unit, -unit, -unit),
                             int(Qt.AlignCenter | Qt.TextWordWrap), self._words)
        else:
            painter.setRenderHint(QPainter.SmoothPixmapTransform)
            painter.drawImage(room, self._image)
            self._paint_words(painter, unit)
            if self._picture.scale is not None:
                self._paint_scale(painter, unit)
        if self._warning:
            self._paint_warning(painter, room, unit)
        if self.hasFocus():
            painter.setBrush(Qt.NoBrush)
            painter.setPen(QPen(theme.colour(theme.DRIVE, self.palette()), 4))
            painter.drawRect(room)

    def _paint_words(self, painter, unit):
        """Paint in the lower left corner how far the lines of the floor are apart."""
        words = 'lines {:g} m apart'.format(self._picture.grid_m)
        if self._picture.cut:
            words = 'cut {:g} m above the floor, {}'.format(CEILING_M, words)
        words = '{}, {}'.format(self._note, words) if self._note else words
        words = theme.fitting_text(painter.fontMetrics(), (words,), self.width() - 2 * unit)
        box = QRectF(0.0, 0.0, painter.fontMetrics().horizontalAdvance(words) + unit, 1.3 * unit)
        box.moveBottomLeft(QPointF(0.3 * unit, self.height() - 0.3 * unit))
        _paint_shade(painter, box)
        painter.drawText(box, int(Qt.AlignCenter), words)

    def _paint_scale(self, painter, unit):
        """Paint what the colours stand for at the right edge; in little room without."""
        low, high = self._picture.scale
        ends = [number_text(value, high - low, self._unit) for value in (high, low)]
        if self._upside_down:
            ends.reverse()
        wide = 1.4 * unit + theme.text_width(self.font(), *ends)
        box = QRectF(self.width() - wide - 0.3 * unit, 0.3 * unit, wide,
                     min(10.0 * unit, self.height() - 2.2 * unit))
        if box.height() < 4.0 * unit or box.left() < 3.0 * unit:
            return
        _paint_shade(painter, box)
        bar = QRectF(box.right() - 0.9 * unit, box.top() + 0.3 * unit, 0.6 * unit,
                     box.height() - 0.6 * unit)
        painter.drawImage(bar, self._scale)
        words = QRectF(box.left(), bar.top(), wide - 1.2 * unit, bar.height())
        for text, side in zip(ends, (Qt.AlignTop, Qt.AlignBottom)):
            painter.drawText(words, int(Qt.AlignRight | side), text)

    def _paint_warning(self, painter, room, unit):
        """Paint words across the top and take the light off the rest."""
        ink = theme.colour(theme.ATTENTION, self.palette())
        painter.fillRect(room, QColor(0, 0, 0, 115))
        half = _FRAME_PX / 2.0
        painter.setBrush(Qt.NoBrush)
        painter.setPen(QPen(ink, _FRAME_PX))
        painter.drawRect(room.adjusted(half, half, -half, -half))
        band = QRectF(0.0, 0.0, room.width(), 2.0 * unit)
        painter.fillRect(band, ink)
        painter.setRenderHint(QPainter.Antialiasing)
        theme.paint_sign(painter, QRectF(0.5 * unit, 0.35 * unit, 1.3 * unit, 1.3 * unit),
                         theme.TRIANGLE, theme.readable_on(ink), ink)
        painter.setFont(theme.larger(self.font(), 1.15, bold=True))
        painter.setPen(theme.readable_on(ink))
        words = band.adjusted(2.4 * unit, 0.0, -0.5 * unit, 0.0)
        painter.drawText(words, int(Qt.AlignLeft | Qt.AlignVCenter), theme.fitting_text(
            painter.fontMetrics(), (self._warning, self._warning.rpartition(', ')[2]),
            words.width()))


def number_text(value, span, unit):
    """Return an end of a scale, with the digits that its span needs, e.g. "1.8 m"."""
    digits = min(3, max(0, 1 - math.floor(math.log10(span)))) if span > 0.0 else 0
    text = '{:.{}f}'.format(value, digits) if abs(value) < 1e6 else '{:.1e}'.format(value)
    return '{} {}'.format(text, unit).rstrip()


def _paint_shade(painter, box):
    """Paint a dark ground for words, and choose white for them."""
    painter.setPen(Qt.NoPen)
    painter.setBrush(_SHADE)
    painter.drawRoundedRect(box, 4, 4)
    painter.setPen(Qt.white)
