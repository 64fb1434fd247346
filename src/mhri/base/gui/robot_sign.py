# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mark of a robot: its shape, in its colour, with its number; on the map, row and tile."""
import math

from python_qt_binding.QtCore import QPointF, QRectF, QSize, Qt
from python_qt_binding.QtGui import QColor, QPolygonF
from python_qt_binding.QtWidgets import QSizePolicy

from mhri.base.gui import theme
from mhri.base.gui.labels import TextLine
from mhri.base.robot_colours import colour_of, DISC, PENTAGON, shape_of


def hue_of(number, palette):
    """Return the :class:`QColor` of a robot's number."""
    return QColor(colour_of(number, theme.is_dark(palette)))


def radius_px(metrics, number):
    """Return the radius of the mark of a number [px].

    :param metrics: ``QFontMetrics`` of its font
    """
    return 0.5 * max(1.35 * metrics.height(), metrics.horizontalAdvance(str(number)) + 12.0)


def paint_shape(painter, middle, radius, number):
    """Paint the shape of a robot in the painter's pen and brush.

    :param middle: ``QPointF``
    :param radius: that of the disc [px]; other shapes have about the same area
    """
    shape = shape_of(number)
    if shape == DISC:
        painter.drawEllipse(middle, radius, radius)
    elif shape == PENTAGON:
        reach = 1.17 * radius
        painter.drawPolygon(QPolygonF([middle + QPointF(
            reach * math.sin(corner * math.tau / 5.0),
            0.06 * radius - reach * math.cos(corner * math.tau / 5.0)) for corner in range(5)]))
    else:
        half = 0.9 * radius
        painter.drawRoundedRect(QRectF(middle.x() - half, middle.y() - half, 2 * half, 2 * half),
                                0.2 * radius, 0.2 * radius)


def paint_number(painter, middle, radius, text, ground):
    """Write a number, or the beginning of a name, into the shape of a robot.

    :param ground: ``QColor`` of the shape
    """
    painter.setPen(theme.readable_on(ground))
    painter.drawText(QRectF(middle.x() - 2 * radius, middle.y() - radius, 4 * radius, 2 * radius),
                     int(Qt.AlignCenter), text)


class RobotNumber(TextLine):
    """The mark of a robot on its row and its tile; empty without a number."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Preferred)

    def shown_text(self):
        """Return the number, which is scaled to fit."""
        return self.text()

    def show_number(self, number):
        """Show a number; 0 shows nothing."""
        text = str(number) if number else ''
        if text != self.text():
            self.show_text(text)
            self.updateGeometry()

    def sizeHint(self):  # noqa: N802
        """Return room for the mark in a line of text, as wide for one digit as for two."""
        high = self.fontMetrics().height()
        return QSize(theme.text_width(self.font(), self.text(), '88'), high)

    minimumSizeHint = sizeHint

    def paintEvent(self, event):  # noqa: N802
        """Paint the shape and the number in it."""
        if not self.text():
            return
        painter = theme.smooth_painter(self)
        number, middle, high = int(self.text()), QRectF(self.rect()).center(), self.fontMetrics(
            ).height()
        radius = max(2.0, min(self.height() / 2.3, self.width() / 2.3, 0.78 * high))
        hue = hue_of(number, self.palette())
        theme.set_ink(painter, brush=hue)
        paint_shape(painter, middle, radius, number)
        fits = 1.45 * radius / theme.text_width(self.font(), self.text())
        painter.setFont(theme.larger(self.font(), min(0.9, fits), bold=True))
        paint_number(painter, middle, radius, self.text(), hue)
