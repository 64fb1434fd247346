# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Paints the committed path of a robot on the floor of its picture."""
from python_qt_binding.QtCore import QPointF, Qt
from python_qt_binding.QtGui import QColor, QPainter, QPen, QPolygonF

from mhri.base.gui import theme

# Width of a line as a share of the height of the picture, minimum [px]; width of its edge [lines].
_LINE_SHARE, _MIN_LINE_PX, _EDGE_LINES = 0.006, 2.0, 1.9
# Dashes and gaps of the way straight on [lines].
_DASHES = (6.0, 4.0)
_EDGE = QColor(0, 0, 0, 190)


def paint_path(painter, target, path, palette):
    """Paint what the robot will do in any case, and dashed the way straight on from there.

    :param target: :class:`QRectF` of the picture
    :param path: :class:`mhri.sensors.floor.FloorPath`
    """
    painter.save()
    painter.setClipRect(target)
    painter.setRenderHint(QPainter.Antialiasing)
    painter.setBrush(Qt.NoBrush)
    line_px = max(_MIN_LINE_PX, _LINE_SHARE * target.height())
    for lines, dashes in ((path.onward, _DASHES), (path.committed + path.bar, ())):
        shapes = [QPolygonF([QPointF(target.left() + x * target.width(),
                                     target.top() + y * target.height())
                             for x, y in line.tolist()]) for line in lines]
        for ink, width in ((_EDGE, _EDGE_LINES), (theme.colour(theme.DRIVE, palette), 1.0)):
            pen = QPen(ink, width * line_px, Qt.SolidLine, Qt.FlatCap, Qt.RoundJoin)
            if dashes:
                pen.setDashPattern([part / width for part in dashes])
            painter.setPen(pen)
            for shape in shapes:
                painter.drawPolyline(shape)
    painter.restore()
