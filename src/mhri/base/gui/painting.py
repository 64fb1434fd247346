# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Painting shared by several pictures: a size in lines, outlined text, a warning."""
from functools import lru_cache
import math

from python_qt_binding.QtCore import QPointF, QRectF, QSize, Qt
from python_qt_binding.QtGui import (
    QColor, QFont, QFontMetrics, QImage, QPainter, QPainterPath, QPen)

from mhri.base.gui import theme

_FRAME_PX = 5


class Sized:
    """Mixin of a widget whose size follows its font: (width, height) in heights of a line."""

    #: a comfortable size, and the minimum size for a readable picture
    USUAL_UNITS, MIN_UNITS = (20, 15), (9, 5)

    def sizeHint(self):  # noqa: N802
        """Return a comfortable size."""
        return self._size(self.USUAL_UNITS)

    def minimumSizeHint(self):  # noqa: N802
        """Return the minimum size."""
        return self._size(self.MIN_UNITS)

    def _size(self, units):
        """Convert line heights to pixels."""
        return QSize(*(round(side * self.fontMetrics().height()) for side in units))


# Painting an outline takes a millisecond, and the same text is painted many times a second.
@lru_cache(maxsize=300)
def edged_words(text, font_name, ink, edge, width, beside_px, ratio):
    """Return outlined text, readable on any background, as a :class:`QImage`.

    :param font_name: ``QFont.toString()``
    :param ink: RGBA of the text, like ``edge``
    :param width: stroke width of the outline [px]
    :param beside_px: margin around the text [px]
    :param ratio: device pixel ratio of the image
    """
    font = QFont()
    font.fromString(font_name)
    metrics = QFontMetrics(font)
    image = QImage(*(math.ceil(ratio * (size + 2 * beside_px)) for size in (
        metrics.horizontalAdvance(text) + 2, metrics.height())),
        QImage.Format_ARGB32_Premultiplied)
    image.setDevicePixelRatio(ratio)
    image.fill(Qt.transparent)
    path = QPainterPath()
    path.addText(QPointF(beside_px, beside_px + metrics.ascent()), font, text)
    painter = theme.smooth_painter(image)
    painter.setPen(QPen(QColor.fromRgba(edge), width, Qt.SolidLine, Qt.RoundCap, Qt.RoundJoin))
    painter.drawPath(path)
    painter.fillPath(path, QColor.fromRgba(ink))
    painter.end()
    return image


def paint_warning(painter, room, widget, texts, top=0.0):
    """Darken a picture, and paint a frame and a text across its top.

    :param room: :class:`QRectF` of the picture
    :param widget: the widget with the font and colours to use
    :param texts: the text, then shorter and shorter forms
    :param top: height of the covered strip above [px]
    :returns: the :class:`QRectF` of the text
    """
    ink, unit = theme.colour(theme.ATTENTION, widget.palette()), widget.fontMetrics().height()
    painter.fillRect(room, QColor(0, 0, 0, 115))
    room, half = QRectF(room), _FRAME_PX / 2.0
    room.setTop(max(room.top(), top))
    theme.set_ink(painter, QPen(ink, _FRAME_PX))
    painter.drawRect(room.adjusted(half, half, -half, -half))
    band = QRectF(room.left(), room.top(), room.width(), 2.0 * unit)
    painter.fillRect(band, ink)
    painter.setRenderHint(QPainter.Antialiasing)
    theme.paint_sign(painter, QRectF(band.left() + 0.5 * unit, band.top() + 0.35 * unit,
                                     1.3 * unit, 1.3 * unit),
                     theme.TRIANGLE, theme.readable_on(ink), ink)
    painter.setFont(theme.larger(widget.font(), theme.HEAD, bold=True))
    painter.setPen(theme.readable_on(ink))
    words = band.adjusted(2.4 * unit, 0.0, -0.5 * unit, 0.0)
    painter.drawText(words, int(Qt.AlignLeft | Qt.AlignVCenter), theme.fitting_text(
        painter.fontMetrics(), texts, words.width()))
    return band
