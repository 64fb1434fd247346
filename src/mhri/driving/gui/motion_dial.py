# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's heading and motion as a picture: a compass with a track."""
import math
from collections import deque

from python_qt_binding.QtCore import QPointF, QRectF, Qt
from python_qt_binding.QtGui import QPalette, QPen, QPolygonF
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.painting import Sized
from mhri.base.limits import Velocity

TRACK_POINTS = 600
TRACK_STEP_M = 0.02
_TRACK_RADII_M = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
# The arrow bends by the robot's turn in this time [s], up to a maximum that is still readable.
_AHEAD_S = 2.0
_MAX_BEND_RAD = 2.6
# Full scale for the speed of a robot without a known maximum.
_USUAL_MAX_MPS = 0.5
# A dial smaller than this many lines of text has no labels.
_SMALL_UNITS = 9.0


class MotionDial(Sized, QWidget):
    """The robot in the middle, its ``odom`` frame around it: x up, y to the left (REP-103).

    The arrow's length is the speed as a fraction of the robot's maximum, its bend the turn; the
    line is the robot's past path, to the scale shown in the corner.
    """

    USUAL_UNITS, MIN_UNITS = (16, 16), (3, 3)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._view = None
        self._track = deque(maxlen=TRACK_POINTS)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    def show_view(self, view):
        """Show a :class:`RobotView`; values that are None or not finite are not drawn."""
        self._view = view
        if _finite(view.x_m, view.y_m):
            point = (view.x_m, view.y_m)
            if not self._track or math.dist(point, self._track[-1]) >= TRACK_STEP_M:
                self._track.append(point)
        self.update()

    def _radius(self):
        """Return the radius of the dial [px]."""
        units = 0.3 if self._is_small() else 1.3
        edge = self.fontMetrics().height() * units
        return max(4.0, min(self.width(), self.height()) / 2.0 - edge)

    def _is_small(self):
        """Return whether there is no room for labels."""
        return min(self.width(), self.height()) < _SMALL_UNITS * self.fontMetrics().height()

    def paintEvent(self, event):  # noqa: N802
        """Paint everything."""
        painter = theme.smooth_painter(self)
        painter.translate(QRectF(self.rect()).center())
        radius = self._radius()
        self._paint_rim(painter, radius)
        if self._view is None:
            return
        if _finite(self._view.x_m, self._view.y_m):
            self._paint_track(painter, radius)
        if _finite(self._view.heading_rad):
            self._paint_robot(painter, radius)
        else:
            painter.setPen(theme.colour(theme.MUTED, self.palette()))
            painter.drawText(QRectF(-radius, -radius, 2 * radius, 2 * radius),
                             int(Qt.AlignCenter), 'no odometry yet')

    def _paint_rim(self, painter, radius):
        """Paint rim, ticks and the names of the axes."""
        palette = self.palette()
        line = theme.line_colour(palette)
        theme.set_ink(painter, QPen(line, 2), palette.color(QPalette.Base))
        painter.drawEllipse(QPointF(0, 0), radius, radius)
        painter.setPen(QPen(line, 1, Qt.DotLine))
        painter.drawEllipse(QPointF(0, 0), radius / 2.0, radius / 2.0)
        unit = self.fontMetrics().height()
        for degrees in range(0, 360, 30):
            major = degrees % 90 == 0
            painter.setPen(QPen(theme.colour(theme.MUTED, palette), 2 if major else 1))
            inner = radius - (0.06 if major else 0.035) * radius
            painter.drawLine(_polar(math.radians(degrees), inner),
                             _polar(math.radians(degrees), radius))
            if major and not self._is_small():
                place = _polar(math.radians(degrees), radius + unit * 0.72)
                text = {0: 'x', 90: 'y'}.get(degrees, '')
                painter.drawText(QRectF(place.x() - unit, place.y() - unit, 2 * unit, 2 * unit),
                                 int(Qt.AlignCenter), text)

    def _paint_track(self, painter, radius):
        """Paint the robot's past path and its scale."""
        here = (self._view.x_m, self._view.y_m)
        reach = max((math.dist(point, here) for point in self._track), default=0.0)
        span = next((r for r in _TRACK_RADII_M if r >= reach * 1.05), _TRACK_RADII_M[-1])
        scale = radius / span
        points = [QPointF(-(y - here[1]) * scale, -(x - here[0]) * scale)
                  for x, y in self._track]
        points.append(QPointF(0, 0))
        painter.save()
        painter.setClipRect(QRectF(-radius, -radius, 2 * radius, 2 * radius))
        painter.setPen(QPen(theme.colour(theme.MUTED, self.palette()), 2, Qt.SolidLine,
                            Qt.RoundCap, Qt.RoundJoin))
        painter.setBrush(Qt.NoBrush)
        painter.drawPolyline(QPolygonF(points))
        painter.restore()
        if self._is_small():
            return
        painter.setPen(theme.colour(theme.MUTED, self.palette()))
        corner = QRectF(self.rect()).translated(-QRectF(self.rect()).center())
        painter.drawText(corner.adjusted(2, 2, -2, -2), int(Qt.AlignLeft | Qt.AlignBottom),
                         'rim: {:g} m'.format(span))

    def _paint_robot(self, painter, radius):
        """Paint the body, pointing along the robot's heading, and the arrow of its speed."""
        view = self._view
        ink = theme.colour(theme.DRIVE if view.driven else theme.TEXT, self.palette())
        body = radius * 0.15
        painter.save()
        painter.rotate(-math.degrees(view.heading_rad))
        painter.save()
        self._paint_motion(painter, ink, body, radius)
        painter.restore()
        painter.setPen(QPen(ink, 2))
        painter.setBrush(theme.blend(self.palette().color(QPalette.Base), ink, 0.25))
        painter.drawEllipse(QPointF(0, 0), body, body)
        theme.set_ink(painter, brush=ink)
        painter.drawPolygon(QPolygonF([QPointF(0, -body * 0.78), QPointF(body * 0.55, body * 0.45),
                                       QPointF(0, body * 0.2), QPointF(-body * 0.55, body * 0.45)]))
        painter.restore()

    def _paint_motion(self, painter, ink, body, radius):
        """Paint the arrow of the speed, bent like the path, or of a turn on the spot."""
        view = self._view
        if not _finite(view.linear_mps, view.angular_rad_s):
            return
        moves = Velocity(view.linear_mps, lateral_mps=view.lateral_mps or 0.0)
        share = min(1.0, moves.speed_mps / (view.max_linear_mps or _USUAL_MAX_MPS))
        bend = max(-_MAX_BEND_RAD, min(_MAX_BEND_RAD, view.angular_rad_s * _AHEAD_S))
        if share > 0.01:
            painter.rotate(-math.degrees(math.atan2(moves.lateral_mps, moves.linear_mps)))
            path = _bent(body + (radius * 0.84 - body) * share, bend)
        elif abs(bend) > 0.02:
            path = [QPointF(-math.sin(bend * part / 16.0) * body * 1.8,
                            -math.cos(bend * part / 16.0) * body * 1.8) for part in range(17)]
        else:
            return
        painter.setBrush(Qt.NoBrush)
        painter.setPen(QPen(ink, max(3.0, radius * 0.035), Qt.SolidLine, Qt.FlatCap,
                            Qt.RoundJoin))
        painter.drawPolyline(QPolygonF(path))
        theme.set_ink(painter, brush=ink)
        painter.save()
        painter.translate(path[-1])
        step = path[-1] - path[-2]
        painter.rotate(math.degrees(math.atan2(step.x(), -step.y())))
        head = radius * 0.07
        painter.drawPolygon(QPolygonF([QPointF(0, -head), QPointF(head * 0.8, head * 0.4),
                                       QPointF(-head * 0.8, head * 0.4)]))
        painter.restore()


def _bent(length, bend):
    """Return the path ahead from the robot's centre, of a length [px] and a total turn [rad]."""
    path, steps, angle = [QPointF(0, 0)], 24, 0.0
    for _ in range(steps):
        angle += bend / steps
        last = path[-1]
        path.append(QPointF(last.x() - math.sin(angle) * length / steps,
                            last.y() - math.cos(angle) * length / steps))
    return path


def _finite(*values):
    """Return whether all values are finite numbers."""
    return all(value is not None and math.isfinite(value) for value in values)


def _polar(angle_rad, radius):
    """Return the point on the dial at an angle from x (up), counter-clockwise."""
    return QPointF(-math.sin(angle_rad) * radius, -math.cos(angle_rad) * radius)
