# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera's picture as large as fits; for depth with its scale and the distance at a point."""
import math

from python_qt_binding.QtCore import QPoint, QPointF, QRect, QRectF, QSize, Qt
from python_qt_binding.QtGui import QBrush, QColor, QImage, QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.painting import paint_warning, Sized
from mhri.camera.depth_colour import colour_at
from mhri.camera.gui.path_layer import paint_path

NO_MEASUREMENT = 'no measurement'
_SCALE_STEPS = 128
# Scale and cross are hidden in a narrower picture [heights of a line].
_ROOMY_UNITS = 18.0
# The colours of invalid pixels, as in DepthColour.
_NONE_GROUND, _NONE_LINES = '#a0a0a0', '#606060'
# A picture smaller than its room by at most this is not scaled, which is faster and sharper.
_CLOSE_ENOUGH_PX = 3


def distance_text(depth_m):
    """Return a distance, e.g. "1.83 m"; words for NaN and None."""
    if depth_m is None or not math.isfinite(depth_m):
        return NO_MEASUREMENT
    return '{:.2f} m'.format(depth_m)


def titles(warning):
    """Return ever shorter versions of the first line of a warning: "OLD PICTURE, 2.4 s"."""
    age = warning.rpartition(', ')[2]
    return warning, warning.replace(' PICTURE, ', ' '), age


def _cover(size, room, cut):
    """Return a picture's :class:`QSize` in a room that it fills if at most a share is cut off."""
    inside = size.scaled(room, Qt.KeepAspectRatio)
    outside = size.scaled(room, Qt.KeepAspectRatioByExpanding)
    if inside.isEmpty() or outside.width() * (1.0 - cut) <= inside.width() + 1:
        return outside if not inside.isEmpty() else inside
    return QSize(round(inside.width() / (1.0 - cut)), round(inside.height() / (1.0 - cut)))


class PictureView(Sized, QWidget):
    """Shows one :class:`mhri.camera.images.Frame`, or words without one.

    For depth, the distance under the pointer is shown beside a cross, or the distance in the middle
    of the picture while the pointer is elsewhere.

    """

    def __init__(self, parent=None):
        super().__init__(parent)
        #: the displayed frame, or None
        self.frame = None
        self._image = None
        #: text in place of a picture
        self.words = ''
        #: text across the picture, '' while it is live
        self.warning = ''
        #: the displayed :class:`mhri.sensors.floor.FloorPath`, or None
        self.path = None
        self._point = None
        self._with_scale = False
        self._clear_px = 0
        self._cut = 0.0
        self._build()

    def _build(self):
        """Set up the widget."""
        self.setObjectName('picture')
        self.setAttribute(Qt.WA_OpaquePaintEvent)
        # The border of a picture is dark in every theme.
        self.setPalette(theme.over_picture(self.palette()))
        # From far, at the top, to near.
        self._scale = QImage(1, _SCALE_STEPS, QImage.Format_RGB32)
        for step in range(_SCALE_STEPS):
            far_first = _SCALE_STEPS - 1 - step
            self._scale.setPixelColor(0, step, QColor(*colour_at(far_first, (0, _SCALE_STEPS - 1))))
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    def show_frame(self, frame):
        """Show a frame; its pixels are not copied, and must not change afterwards."""
        height, width = frame.rgb.shape[:2]
        # QImage does not keep the array of its pixels alive; the frame does.
        self._image = QImage(frame.rgb.data, width, height, 3 * width, QImage.Format_RGB888)
        self.frame = frame
        self.update()

    def clear(self, words, with_scale=False):
        """Show words instead of a picture; ``with_scale`` reserves the room of the depth scale."""
        if self.frame is not None or (words, with_scale) != (self.words, self._with_scale):
            self.words, self._with_scale = words, with_scale
            self.frame = self._image = self.path = None
            self.update()

    def show_warning(self, warning):
        """Show a warning across the picture; '' removes it.

        Its first line is large.
        """
        if warning != self.warning:
            self.warning = warning
            self.update()

    def show_path(self, path):
        """Show a :class:`mhri.sensors.floor.FloorPath` on the floor of the picture; None: none.

        It is hidden on an old picture, and in a thumbnail.
        """
        if path is not None or self.path is not None:
            self.path = path
            self.update()

    def keep_clear(self, height):
        """Set the height at the top that something else covers [px]."""
        if height != self._clear_px:
            self._clear_px = height
            self.update()

    def show_cut(self, cut):
        """Set the maximum share of a picture that is cut off to fill the room, 0 to 1."""
        if cut != self._cut:
            self._cut = cut
            self.update()

    def room(self):
        """Return the rectangle available for a picture."""
        scale = self._scale_width() if self._with_scale and self._is_roomy() else 0
        return self.rect().adjusted(0, 0, -scale, 0)

    def _is_roomy(self):
        """Return whether there is room for more than the picture, unlike in a thumbnail."""
        return self.width() >= _ROOMY_UNITS * self.fontMetrics().height()

    def target(self):
        """Return the rectangle of the picture, empty without one.

        What is outside of the room is cut off: the top of a picture that is too high, as the floor
        is what one drives on, and both sides of one that is too wide.
        """
        if self._image is None:
            return QRectF()
        room, ratio = QRectF(self.room()), self.devicePixelRatioF()
        shown, image = self.size_on_screen(), self._image.size()
        if abs(shown.width() - image.width()) <= _CLOSE_ENOUGH_PX \
                and abs(shown.height() - image.height()) <= _CLOSE_ENOUGH_PX:
            shown = image
        # Align it to whole pixels of the screen: otherwise it would be blurred.
        left = math.floor((room.width() * ratio - shown.width()) / 2.0)
        spare = room.height() * ratio - shown.height()
        top = math.floor(spare / 2.0 if spare > 0.0 else spare)
        return QRectF(left / ratio, top / ratio, shown.width() / ratio, shown.height() / ratio)

    def size_on_screen(self):
        """Return the :class:`QSize` of the picture in pixels of the screen, parts cut off included.

        One that comes in this size is not scaled here, on the GUI thread. Without a picture, it is
        the size of the room.
        """
        room = self.room().size() * self.devicePixelRatioF()
        return room if self._image is None else _cover(self._whole(), room, self._cut)

    def _whole(self):
        """Return the size of the whole picture, as the camera sent it."""
        return QSize(*self.frame.full_size) if all(self.frame.full_size) else self._image.size()

    def paint_copy(self, painter, box, cut):
        """Paint the picture into a :class:`QRect`, and nothing without one.

        :param cut: maximum share that is cut off to fill it
        """
        if self._image is None:
            return
        shown = QRect(QPoint(0, 0), _cover(self._whole(), box.size(), cut))
        shown.moveCenter(box.center())
        painter.save()
        painter.setClipRect(box)
        painter.setRenderHint(QPainter.SmoothPixmapTransform)
        painter.drawImage(shown, self._image)
        painter.restore()

    def distance_at(self, point):
        """Return (distance [m] or NaN, True) at a point of the widget, (NaN, False) outside."""
        target = self.target()
        if self.frame is None or self.frame.depth_m is None or not target.contains(point):
            return math.nan, False
        height, width = self.frame.depth_m.shape
        column = int((point.x() - target.left()) / target.width() * width)
        row = int((point.y() - target.top()) / target.height() * height)
        return float(self.frame.depth_m[min(row, height - 1), min(column, width - 1)]), True

    def mouseMoveEvent(self, event):  # noqa: N802
        """Follow the pointer."""
        self._point = QPointF(event.pos())
        self.update()

    def mousePressEvent(self, event):  # noqa: N802
        """Follow the pointer, and pass the click to the tile."""
        self.mouseMoveEvent(event)
        event.ignore()

    def leaveEvent(self, event):  # noqa: N802
        """Return the cross to the middle."""
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
                             int(Qt.AlignCenter | Qt.TextWordWrap), self.words)
            return
        target = self.target()
        painter.fillRect(self.rect(), ground)
        painter.setRenderHint(QPainter.SmoothPixmapTransform)
        painter.drawImage(target, self._image)
        if self._with_scale and self._is_roomy():
            self._paint_scale(painter)
        if self.path is not None and not self.warning and self._is_roomy():
            paint_path(painter, target, self.path, palette)
        if self.warning:
            self._paint_warning(painter, target)
        elif self.frame.depth_m is not None and self._is_roomy():
            self._paint_cross(painter, target)

    def _scale_width(self):
        """Return the width of the scale with its numbers [px]."""
        return self.fontMetrics().horizontalAdvance('00.0 m') + 2 * self.fontMetrics().height()

    def _paint_scale(self, painter):
        """Paint the colours of depth with their distances, and the hatch of invalid pixels."""
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
        if self.frame is None or not self.frame.depth_range_m:
            return
        near, far = self.frame.depth_range_m
        count = max(2, min(6, bar.height() // (2 * unit) + 1))
        for index in range(count):
            share = index / (count - 1.0)
            y = bar.bottom() - round(share * bar.height())
            painter.drawLine(bar.right(), y, bar.right() + unit // 4, y)
            painter.drawText(QRect(bar.right() + unit // 3 + 1, y - unit, 5 * unit, 2 * unit),
                             right, '{:.1f} m'.format(near + share * (far - near)))

    def _paint_cross(self, painter, target):
        """Paint a cross and the distance at it."""
        point = self._point if self._point is not None and target.contains(self._point) \
            else target.center()
        depth_m, _ = self.distance_at(point)
        unit = self.fontMetrics().height()
        painter.setRenderHint(QPainter.Antialiasing)
        # White on black is visible on every colour.
        for ink, width in ((Qt.black, 4.0), (Qt.white, 1.6)):
            painter.setPen(QPen(ink, width))
            for across, along in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                step = QPointF(across, along)
                painter.drawLine(point + 0.3 * unit * step, point + 0.9 * unit * step)
        words = distance_text(depth_m)
        painter.setFont(theme.number_font(theme.larger(self.font(), theme.HEAD, bold=True)))
        metrics = painter.fontMetrics()
        box = QRectF(0, 0, metrics.horizontalAdvance(words) + unit, metrics.height() + unit / 3.0)
        box.moveBottomLeft(point + QPointF(0.6 * unit, -0.6 * unit))
        box.moveRight(min(box.right(), target.right() - 2))
        box.moveTop(max(box.top(), target.top() + 2, self._clear_px + 2))
        theme.set_ink(painter, brush=QColor(0, 0, 0, 200))
        painter.drawRoundedRect(box, 4, 4)
        painter.setPen(Qt.white)
        painter.drawText(box, int(Qt.AlignCenter), words)

    def _paint_warning(self, painter, target):
        """Dim the picture, and paint a frame around it and words across its top."""
        title, _, reason = self.warning.partition('\n')
        band = paint_warning(painter, target, self, titles(title), self._clear_px)
        unit = self.fontMetrics().height()
        painter.setFont(self.font())
        painter.setPen(Qt.white)
        below = QRectF(target.left() + unit, band.bottom() + unit / 2.0,
                       target.width() - 2.0 * unit, target.bottom() - band.bottom() - unit)
        painter.drawText(below, int(Qt.AlignLeft | Qt.AlignTop | Qt.TextWordWrap), reason)
