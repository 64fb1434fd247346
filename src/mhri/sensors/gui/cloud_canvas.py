# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A drawn cloud with its scale, turned by mouse or keyboard."""
import math

from python_qt_binding.QtCore import QPointF, QRectF, Qt, Signal
from python_qt_binding.QtGui import QColor, QImage, QPainter, QPen
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.painting import paint_warning, Sized
from mhri.sensors.cloud_picture import CEILING_M, GROUND, TABLE
from mhri.sensors.orbit import Orbit

# Larger pictures are drawn smaller and scaled up: more pixels make a cloud no sharper.
MAX_PIXELS = 1_300_000
_KEY_PX = 20
_ARROWS = {Qt.Key_Left: (-1, 0), Qt.Key_Right: (1, 0), Qt.Key_Up: (0, -1), Qt.Key_Down: (0, 1)}
_ZOOMS = {Qt.Key_Plus: 1.0, Qt.Key_Equal: 1.0, Qt.Key_Minus: -1.0}
# A notch of a usual wheel [eighths of a degree].
_NOTCH = 120.0
_SHADE = QColor(0, 0, 0, 150)


class CloudCanvas(Sized, QWidget):
    """Shows a :class:`mhri.sensors.cloud_picture.Picture`, or words without one.

    Drag turns, drag with the right or middle button moves, the wheel zooms, a double click requests
    the view of the whole cloud. With the keyboard focus (by Tab, not by a click, so that the arrows
    keep driving): arrows turn, with Shift they move, plus and minus zoom, Home shows all.
    """

    MIN_UNITS = (9, 6)

    #: the viewpoint, :attr:`orbit`, has changed
    moved = Signal()
    #: the view of the whole cloud is requested
    reset_requested = Signal()
    #: :meth:`drawing_size` has changed
    resized = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self.orbit = Orbit()
        #: the displayed picture, or None
        self.picture = None
        self._image = None
        self._unit = ''
        self._upside_down = False
        #: text in place of a picture
        self.words = 'waiting for the first cloud'
        self._note = ''
        #: text across the picture, '' while it is live
        self.warning = ''
        self._grip = None
        self._clear_px = 0
        self._build()

    def _build(self):
        """Set up the widget."""
        self.setObjectName('cloud_canvas')
        self.setAccessibleName('point cloud; arrows turn it, plus and minus zoom')
        self.setAttribute(Qt.WA_OpaquePaintEvent)
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        keep_arrows(self)
        # From high, at the top, to low.
        self._scale = QImage(1, len(TABLE), QImage.Format_RGB32)
        for row, colour in enumerate(TABLE[::-1].tolist()):
            self._scale.setPixel(0, row, colour)

    def show_picture(self, picture, unit, upside_down=False, note=''):
        """Show a :class:`Picture`; its pixels are not copied.

        :param unit: of its scale, e.g. 'm'
        :param upside_down: small values are light
        :param note: text in its corner besides the floor's lines
        """
        height, width = picture.pixels.shape
        self._image = QImage(picture.pixels.data, width, height, 4 * width, QImage.Format_RGB32)
        self.picture, self._unit, self._note = picture, unit, note
        self._upside_down = upside_down
        self.update()

    def show_warning(self, warning):
        """Show a warning across the picture; '' removes it."""
        if warning != self.warning:
            self.warning = warning
            self.update()

    def keep_clear(self, height):
        """Set the height at the top that something else covers [px]."""
        if height != self._clear_px:
            self._clear_px = height
            self.update()

    def room(self):
        """Return the rectangle of the picture."""
        return self.rect()

    def clear(self, words):
        """Show words instead of a picture."""
        if self.picture is not None or words != self.words:
            self.picture, self._image, self.words, self.warning = None, None, words, ''
            self.update()

    def drawing_size(self):
        """Return (width, height) of the pictures to draw [px]."""
        ratio = self.devicePixelRatioF()
        width, height = max(1.0, self.width() * ratio), max(1.0, self.height() * ratio)
        share = min(1.0, math.sqrt(MAX_PIXELS / (width * height)))
        return max(1, round(width * share)), max(1, round(height * share))

    def _look(self, orbit):
        """Set the viewpoint."""
        self.orbit = orbit
        self.moved.emit()

    def mousePressEvent(self, event):  # noqa: N802
        """Begin a drag."""
        self._grip = QPointF(event.pos())

    def mouseMoveEvent(self, event):  # noqa: N802
        """Turn or move the view with the mouse."""
        if self._grip is None or not event.buttons():
            return
        way, self._grip = QPointF(event.pos()) - self._grip, QPointF(event.pos())
        if event.buttons() & Qt.LeftButton:
            self._look(self.orbit.turned(way.x(), way.y()))
        else:
            self._look(self.orbit.moved(way.x(), way.y(), self.height()))

    def mouseReleaseEvent(self, event):  # noqa: N802
        """End the drag once no button is pressed."""
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
            # The view follows the arrow, so the scene moves against it.
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
        """Request a picture of the new size."""
        super().resizeEvent(event)
        self.resized.emit()

    def focusInEvent(self, event):  # noqa: N802
        """Show the keyboard focus."""
        super().focusInEvent(event)
        self.update()

    focusOutEvent = focusInEvent  # noqa: N815

    def paintEvent(self, event):  # noqa: N802
        """Paint picture, scale and words."""
        painter = QPainter(self)
        room = QRectF(self.rect())
        unit = self.fontMetrics().height()
        painter.fillRect(room, QColor(GROUND))
        if self._image is None:
            painter.setPen(Qt.white)
            painter.drawText(room.adjusted(unit, unit, -unit, -unit),
                             int(Qt.AlignCenter | Qt.TextWordWrap), self.words)
        else:
            painter.setRenderHint(QPainter.SmoothPixmapTransform)
            painter.drawImage(room, self._image)
            self._paint_scale(painter, unit, self._paint_words(painter, unit))
        if self.warning:
            paint_warning(painter, room, self, (
                self.warning, self.warning.rpartition(', ')[2]), self._clear_px)
        if self.hasFocus():
            theme.set_ink(painter, QPen(theme.colour(theme.DRIVE, self.palette()), 4))
            painter.drawRect(room)

    def _paint_words(self, painter, unit):
        """Paint the spacing of the floor's lines in the upper left corner.

        The numbers, the stick and other views lie over the other corners.

        :returns: y of its lower edge
        """
        words = 'lines {:g} m apart'.format(self.picture.grid_m)
        if self.picture.cut:
            words = 'cut {:g} m above the floor, {}'.format(CEILING_M, words)
        words = '{}, {}'.format(self._note, words) if self._note else words
        words = theme.fitting_text(painter.fontMetrics(), (words,), self.width() - 2 * unit)
        box = QRectF(0.0, 0.0, painter.fontMetrics().horizontalAdvance(words) + unit, 1.3 * unit)
        box.moveTopLeft(QPointF(0.3 * unit, self._clear_px + 0.3 * unit))
        _paint_shade(painter, box)
        painter.drawText(box, int(Qt.AlignCenter), words)
        return box.bottom()

    def _paint_scale(self, painter, unit, top):
        """Paint the scale of the colours at the left edge, unless there is too little room."""
        if self.picture.scale is None:
            return
        low, high = self.picture.scale
        ends = [number_text(value, high - low, self._unit) for value in (high, low)]
        if self._upside_down:
            ends.reverse()
        wide = 1.4 * unit + theme.text_width(self.font(), *ends)
        box = QRectF(0.3 * unit, top + 0.3 * unit, wide,
                     min(10.0 * unit, 0.6 * (self.height() - top)))
        if box.height() < 4.0 * unit or self.width() - wide < 3.0 * unit:
            return
        _paint_shade(painter, box)
        bar = QRectF(box.left() + 0.3 * unit, box.top() + 0.3 * unit, 0.6 * unit,
                     box.height() - 0.6 * unit)
        painter.drawImage(bar, self._scale)
        words = QRectF(bar.right() + 0.3 * unit, bar.top(), wide - 1.2 * unit, bar.height())
        for text, side in zip(ends, (Qt.AlignTop, Qt.AlignBottom)):
            painter.drawText(words, int(Qt.AlignLeft | side), text)


def number_text(value, span, unit):
    """Return the text of a scale's end, with as many digits as its span needs, e.g. "1.8 m"."""
    digits = min(3, max(0, 1 - math.floor(math.log10(span)))) if span > 0.0 else 0
    text = '{:.{}f}'.format(value, digits) if abs(value) < 1e6 else '{:.1e}'.format(value)
    return '{} {}'.format(text, unit).rstrip()


def _paint_shade(painter, box):
    """Paint a dark background for words, and choose white for them."""
    theme.set_ink(painter, brush=_SHADE)
    painter.drawRoundedRect(box, 4, 4)
    painter.setPen(Qt.white)
