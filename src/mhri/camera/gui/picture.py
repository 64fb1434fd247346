# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera's picture as large as fits; for depth with its scale and the distance at a point."""
import math

from python_qt_binding.QtCore import QPointF, QRect, QRectF, QSize, Qt
from python_qt_binding.QtGui import QBrush, QColor, QImage, QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.camera.depth_colour import colour_at

NO_MEASUREMENT = 'no measurement'
_FRAME_PX = 5
_SCALE_STEPS = 128
# Scale and cross are left out where the picture would be narrower than this [heights of a line].
_ROOMY_UNITS = 18.0
# As DepthColour hatches what has no measurement.
_NONE_GROUND, _NONE_LINES = '#a0a0a0', '#606060'
# A picture that is smaller than its room by no more than this is shown as it is, which is quicker
# and sharper than a scaled one.
_CLOSE_ENOUGH_PX = 3


def distance_text(depth_m):
    """Return a distance, e.g. "1.83 m"; words for NaN and None."""
    if depth_m is None or not math.isfinite(depth_m):
        return NO_MEASUREMENT
    return '{:.2f} m'.format(depth_m)


def titles(warning):
    """Return the first line of a warning in fewer and fewer words: "OLD PICTURE, 2.4 s"."""
    age = warning.rpartition(', ')[2]
    return warning, warning.replace(' PICTURE, ', ' '), age


class PictureView(QWidget):
    """Shows one :class:`mhri.camera.images.Frame`, or words where there is none.

    For depth, the distance under the pointer is written beside a cross; while the pointer is
    elsewhere, that in the middle of the picture.

    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._frame = None
        self._image = None
        self._words = ''
        self._warning = ''
        self._point = None
        self._with_scale = False
        self._clear_px = 0
        self._build()

    def _build(self):
        """Set what never changes."""
        self.setObjectName('picture')
        self.setAttribute(Qt.WA_OpaquePaintEvent)
        # Beside a picture it is dark in every theme.
        self.setPalette(theme.over_picture(self.palette()))
        # From far, on top, to near; colour_at is the one place that knows the colours.
        self._scale = QImage(1, _SCALE_STEPS, QImage.Format_RGB32)
        for step in range(_SCALE_STEPS):
            far_first = _SCALE_STEPS - 1 - step
            self._scale.setPixelColor(0, step, QColor(*colour_at(far_first, (0, _SCALE_STEPS - 1))))
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    @property
    def frame(self):
        """The frame on show, or None."""
        return self._frame

    @property
    def words(self):
        """What is said where there is no picture."""
        return self._words

    @property
    def warning(self):
        """What is said across the picture, '' while it is live."""
        return self._warning

    def show_frame(self, frame):
        """Show a frame; its pixels are not copied, so nobody may change them afterwards."""
        height, width = frame.rgb.shape[:2]
        # QImage does not keep what its pixels belong to alive: the frame does, beside it.
        self._image = QImage(frame.rgb.data, width, height, 3 * width, QImage.Format_RGB888)
        self._frame = frame
        self.update()

    def clear(self, words, with_scale=False):
        """Show words instead of a picture; ``with_scale``: depth comes next, leave it its room."""
        if self._frame is not None or (words, with_scale) != (self._words, self._with_scale):
            self._words, self._with_scale = words, with_scale
            self._frame = self._image = None
            self.update()

    def show_warning(self, warning):
        """Say across the picture why it is not to be trusted; '' takes it away.

        The first line is set large, what follows below it.
        """
        if warning != self._warning:
            self._warning = warning
            self.update()

    def keep_clear(self, height):
        """Write below so much of the upper end [px]: something else lies on that."""
        if height != self._clear_px:
            self._clear_px = height
            self.update()

    def room(self):
        """Return the rectangle that a picture may fill."""
        scale = self._scale_width() if self._with_scale and self._is_roomy() else 0
        return self.rect().adjusted(0, 0, -scale, 0)

    def _is_roomy(self):
        """Tell whether there is room for more than the picture: a thumbnail has none."""
        return self.width() >= _ROOMY_UNITS * self.fontMetrics().height()

    def target(self):
        """Return the rectangle that the picture on show fills; empty without one."""
        if self._image is None:
            return QRectF()
        room, ratio = QRectF(self.room()), self.devicePixelRatioF()
        size = QSize(*self._frame.full_size) if all(self._frame.full_size) else self._image.size()
        shown = size.scaled(self.room().size() * ratio, Qt.KeepAspectRatio)
        image = self._image.size()
        if abs(shown.width() - image.width()) <= _CLOSE_ENOUGH_PX \
                and abs(shown.height() - image.height()) <= _CLOSE_ENOUGH_PX:
            shown = image
        # On whole pixels of the screen, or it would be blurred.
        left = math.floor((room.width() * ratio - shown.width()) / 2.0)
        top = math.floor((room.height() * ratio - shown.height()) / 2.0)
        return QRectF(left / ratio, top / ratio, shown.width() / ratio, shown.height() / ratio)

    def distance_at(self, point):
        """Return (distance [m] or NaN, True) under a point of the widget, (NaN, False) beside."""
        target = self.target()
        if self._frame is None or self._frame.depth_m is None or not target.contains(point):
            return math.nan, False
        height, width = self._frame.depth_m.shape
        column = int((point.x() - target.left()) / target.width() * width)
        row = int((point.y() - target.top()) / target.height() * height)
        return float(self._frame.depth_m[min(row, height - 1), min(column, width - 1)]), True

    def sizeHint(self):  # noqa: N802
        """Return a comfortable size."""
        unit = self.fontMetrics().height()
        return QSize(20 * unit, 15 * unit)

    def minimumSizeHint(self):  # noqa: N802
        """Return the least in which something can be seen."""
        unit = self.fontMetrics().height()
        return QSize(9 * unit, 5 * unit)

    def mouseMoveEvent(self, event):  # noqa: N802
        """Follow the pointer."""
        self._point = QPointF(event.pos())
        self.update()

    def mousePressEvent(self, event):  # noqa: N802
        """Follow the pointer, and leave the click to the tile."""
        self.mouseMoveEvent(event)
        event.ignore()

    def leaveEvent(self, event):  # noqa: N802
        """Go back to the middle."""
        self._point = None
        self.update()

    def paintEvent(self, event):  # noqa: N802
        """Paint picture, scale, cross and warning; or the words."""
        painter = QPainter(self)
        palette = self.palette()
        ground = palette.color(QPalette.Base).darker(106)
        if self._image is None:
            painter.fillRect(self.rect(), ground)
            painter.setPen(theme.colour(theme.MUTED, palette))
            inset = self.fontMetrics().height()
            painter.drawText(self.rect().adjusted(inset, inset, -inset, -inset),
                             int(Qt.AlignCenter | Qt.TextWordWrap), self._words)
            return
        target = self.target()
        painter.fillRect(self.rect(), ground)
        painter.setRenderHint(QPainter.SmoothPixmapTransform)
        painter.drawImage(target, self._image)
        if self._with_scale and self._is_roomy():
            self._paint_scale(painter)
        if self._warning:
            self._paint_warning(painter, target)
        elif self._frame.depth_m is not None and self._is_roomy():
            self._paint_cross(painter, target)

    def _scale_width(self):
        """Return the width of the scale with its numbers [px]."""
        return self.fontMetrics().horizontalAdvance('00.0 m') + 2 * self.fontMetrics().height()

    def _paint_scale(self, painter):
        """Paint the colours of depth, the distances they stand for, and that of no measurement."""
        unit, room = self.fontMetrics().height(), self.rect().adjusted(0, self._clear_px, 0, 0)
        left = room.right() - self._scale_width() + unit // 2
        bar = QRect(left, room.top() + unit // 2, unit, room.height() - round(2.75 * unit))
        text = theme.colour(theme.TEXT, self.palette())
        line = theme.line_colour(self.palette())
        painter.setRenderHint(QPainter.SmoothPixmapTransform)
        painter.drawImage(bar, self._scale)
        none = QRect(left, bar.bottom() + unit // 2, unit, unit)
        painter.fillRect(none, QColor(_NONE_GROUND))
        painter.fillRect(none, QBrush(QColor(_NONE_LINES), Qt.BDiagPattern))
        painter.setPen(line)
        painter.drawRect(bar)
        painter.drawRect(none)
        painter.setPen(text)
        right = int(Qt.AlignLeft | Qt.AlignVCenter)
        painter.drawText(none.translated(unit + unit // 3, 0).adjusted(0, -4, 4 * unit, 4), right,
                         'none')
        if self._frame is None or not self._frame.depth_range_m:
            return
        near, far = self._frame.depth_range_m
        count = max(2, min(6, bar.height() // (2 * unit) + 1))
        for index in range(count):
            share = index / (count - 1.0)
            y = bar.bottom() - round(share * bar.height())
            painter.drawLine(bar.right(), y, bar.right() + unit // 4, y)
            painter.drawText(QRect(bar.right() + unit // 3 + 1, y - unit, 5 * unit, 2 * unit),
                             right, '{:.1f} m'.format(near + share * (far - near)))

    def _paint_cross(self, painter, target):
        """Paint a cross and the distance there."""
        point = self._point if self._point is not None and target.contains(self._point) \
            else target.center()
        depth_m, _ = self.distance_at(point)
        unit = self.fontMetrics().height()
        painter.setRenderHint(QPainter.Antialiasing)
        # White on black is seen on every colour.
        for ink, width in ((Qt.black, 4.0), (Qt.white, 1.6)):
            painter.setPen(QPen(ink, width))
            for across, along in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                step = QPointF(across, along)
                painter.drawLine(point + 0.3 * unit * step, point + 0.9 * unit * step)
        words = distance_text(depth_m)
        painter.setFont(theme.number_font(theme.larger(self.font(), 1.1, bold=True)))
        metrics = painter.fontMetrics()
        box = QRectF(0, 0, metrics.horizontalAdvance(words) + unit, metrics.height() + unit / 3.0)
        box.moveBottomLeft(point + QPointF(0.6 * unit, -0.6 * unit))
        box.moveRight(min(box.right(), target.right() - 2))
        box.moveTop(max(box.top(), target.top() + 2, self._clear_px + 2))
        painter.setPen(Qt.NoPen)
        painter.setBrush(QColor(0, 0, 0, 200))
        painter.drawRoundedRect(box, 4, 4)
        painter.setPen(Qt.white)
        painter.drawText(box, int(Qt.AlignCenter), words)

    def _paint_warning(self, painter, target):
        """Paint a frame around the picture and words across its top, and take the light off it."""
        ink = theme.colour(theme.ATTENTION, self.palette())
        painter.fillRect(target, QColor(0, 0, 0, 115))
        target.setTop(max(target.top(), self._clear_px))
        half = _FRAME_PX / 2.0
        painter.setPen(QPen(ink, _FRAME_PX))
        painter.setBrush(Qt.NoBrush)
        painter.drawRect(target.adjusted(half, half, -half, -half))
        unit = self.fontMetrics().height()
        font = theme.larger(self.font(), 1.15, bold=True)
        painter.setFont(font)
        band = QRectF(target.left(), target.top(), target.width(), 2.0 * unit)
        painter.fillRect(band, ink)
        painter.setRenderHint(QPainter.Antialiasing)
        side = 1.3 * unit
        theme.paint_sign(painter, QRectF(band.left() + unit / 2.0, band.top() + 0.35 * unit, side,
                                         side), theme.TRIANGLE, theme.readable_on(ink), ink)
        title, _, reason = self._warning.partition('\n')
        words = band.adjusted(2.4 * unit, 0, -unit / 2.0, 0)
        painter.setPen(theme.readable_on(ink))
        # The age is what matters: the word before it gives way.
        painter.drawText(words, int(Qt.AlignLeft | Qt.AlignVCenter), theme.fitting_text(
            painter.fontMetrics(), titles(title), words.width()))
        painter.setFont(self.font())
        painter.setPen(Qt.white)
        below = QRectF(target.left() + unit, band.bottom() + unit / 2.0,
                       target.width() - 2.0 * unit, target.bottom() - band.bottom() - unit)
        painter.drawText(below, int(Qt.AlignLeft | Qt.AlignTop | Qt.TextWordWrap), reason)
