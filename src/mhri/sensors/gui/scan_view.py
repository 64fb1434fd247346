# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's laser scan from above: the robot in the middle, ahead is up."""
import math

import numpy as np
from python_qt_binding.QtCore import QPointF, QRectF, QSize, Qt
from python_qt_binding.QtGui import QPainter, QPalette, QPen, QPolygonF
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.pending import Pace
from mhri.base.plausible import BOUNDS, RANGE

# Radius of the picture and distance of its rings [m].
_RINGS = {1.0: 0.25, 1.5: 0.5, 2.0: 0.5, 3.0: 1.0, 4.0: 1.0, 6.0: 2.0, 8.0: 2.0, 12.0: 3.0,
          20.0: 5.0, 30.0: 10.0, 50.0: 10.0, 100.0: 25.0}
# So many scans in a row have to fit a smaller picture before it is taken: nothing jumps.
_SHRINK_AFTER = 40
NEAR_M = 0.5
OLD_S = 1.0
ROBOT_RADIUS_M = 0.18
NUMBERS_PERIOD_S = 0.25


def _valid(ranges):
    """Return which ranges are measurements that can be drawn."""
    with np.errstate(invalid='ignore'):
        return (ranges >= BOUNDS[RANGE].least) & (ranges <= BOUNDS[RANGE].greatest)


def reach_for(ranges):
    """Return the radius [m] that shows all but the farthest 2 % of some ranges."""
    valid = ranges[_valid(ranges)]
    farthest = np.percentile(valid, 98) if len(valid) else 0.0
    return next((reach for reach in _RINGS if farthest <= reach), max(_RINGS))


def scan_points(ranges, angle_min, angle_increment):
    """Return the points that can be as arrays (x ahead, y left, range), all in m."""
    valid = _valid(ranges)
    angles = angle_min + angle_increment * np.flatnonzero(valid)
    distances = ranges[valid]
    return distances * np.cos(angles), distances * np.sin(angles), distances


class ScanView(QWidget):
    """Points in metres around the sensor, rings with their radius, the robot's outline.

    What is nearer than 0.5 m is orange and larger. A single sensor is drawn in the robot's middle,
    as if it were mounted there.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._points = None
        self._nearest_m = math.nan
        self._line = ''
        self._numbers = Pace(NUMBERS_PERIOD_S)
        self._reach_m = 4.0
        self._ample = 0
        self._words = 'waiting for the first scan'
        self._warning = ''
        self._build()

    def _build(self):
        """Set what never changes."""
        self.setObjectName('scan_view')
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    @property
    def reach_m(self):
        """Radius of the picture [m]."""
        return self._reach_m

    @property
    def nearest_m(self):
        """Range of the nearest point [m], NaN for none."""
        return self._nearest_m

    @property
    def warning(self):
        """What is said while the scan is old, '' while it is live."""
        return self._warning

    def show_value(self, scan):
        """Show a scan as :meth:`Lasers.take` returns it: NaN is no point."""
        ranges, angle_min, angle_increment, _ = scan
        self._follow(reach_for(ranges))
        self._points = scan_points(ranges, angle_min, angle_increment)
        self._nearest_m = float(np.min(self._points[2])) if len(self._points[2]) else math.nan
        self._warning = ''
        if self._numbers.due():
            self._line = 'nothing within reach' if math.isnan(self._nearest_m) else \
                'nearest {:.2f} m'.format(self._nearest_m)
        self.update()

    def show_age(self, age_s):
        """Tell the age of the newest scan [s], None before the first: old ones are marked."""
        old = age_s is not None and age_s > OLD_S and self._points is not None
        warning = 'OLD SCAN, {}'.format(words.age_text(age_s)) if old else ''
        if warning != self._warning:
            self._warning = warning
            self.update()

    def save_settings(self):
        """Return what is kept between runs: there is nothing to choose."""
        return {}

    def restore_settings(self, settings):
        """Take over a dict of :meth:`save_settings`."""

    def clear(self, text):
        """Show words instead of a scan."""
        self._points, self._words, self._warning = None, text, ''
        self.update()

    def _follow(self, wanted_m):
        """Grow at once, shrink late."""
        self._ample = self._ample + 1 if wanted_m < self._reach_m else 0
        if wanted_m > self._reach_m or self._ample >= _SHRINK_AFTER or self._points is None:
            self._reach_m, self._ample = wanted_m, 0

    def sizeHint(self):  # noqa: N802
        """Return a comfortable size."""
        side = self.fontMetrics().height() * 15
        return QSize(side, side)

    def minimumSizeHint(self):  # noqa: N802
        """Return the least that can be read."""
        side = self.fontMetrics().height() * 8
        return QSize(side, side)

    def paintEvent(self, event):  # noqa: N802
        """Paint rings, points, robot and words."""
        painter = QPainter(self)
        palette = self.palette()
        painter.fillRect(self.rect(), palette.color(QPalette.Base))
        if self._points is None:
            painter.setPen(theme.colour(theme.MUTED, palette))
            painter.drawText(self.rect(), int(Qt.AlignCenter | Qt.TextWordWrap), self._words)
            return
        painter.setRenderHint(QPainter.Antialiasing)
        unit = self.fontMetrics().height()
        line_room = 1.4 * unit
        radius = min(self.width() / 2.0, (self.height() - line_room) / 2.0) - 3.0
        scale = radius / self._reach_m
        painter.save()
        painter.setClipRect(QRectF(0, 0, self.width(), self.height() - line_room))
        painter.translate(self.width() / 2.0, (self.height() - line_room) / 2.0)
        self._paint_rings(painter, scale)
        self._paint_points(painter, scale)
        self._paint_robot(painter, scale)
        painter.restore()
        self._paint_line(painter, line_room)

    def _paint_rings(self, painter, scale):
        """Paint the rings, their radii and the way ahead."""
        palette, unit = self.palette(), self.fontMetrics().height()
        step = _RINGS[self._reach_m]
        beyond = math.hypot(self.width(), self.height()) / 2.0 / scale
        painter.setBrush(Qt.NoBrush)
        painter.setPen(QPen(theme.line_colour(palette), 1))
        for index in range(1, int(beyond / step) + 1):
            painter.drawEllipse(QPointF(0, 0), index * step * scale, index * step * scale)
        painter.drawLine(QPointF(0, -beyond * scale), QPointF(0, beyond * scale))
        painter.drawLine(QPointF(-beyond * scale, 0), QPointF(beyond * scale, 0))
        painter.setPen(theme.colour(theme.MUTED, palette))
        lines = max(1, math.ceil(1.3 * unit / (step * scale)))
        for index in range(lines, int(self._reach_m / step) + 1, lines):
            label = QRectF(4, -index * step * scale, 6 * unit, 1.1 * unit)
            painter.drawText(label, int(Qt.AlignLeft | Qt.AlignTop),
                             '{:g} m'.format(index * step))

    def _paint_points(self, painter, scale):
        """Paint the points; forward is up, left is left."""
        ahead, left, distances = self._points
        xs, ys = -left * scale, -ahead * scale
        near = distances < NEAR_M
        for chosen, ink, width in ((~near, theme.DRIVE, 3.4), (near, theme.ATTENTION, 6.0)):
            if self._warning:
                ink = theme.MUTED
            painter.setPen(QPen(theme.colour(ink, self.palette()), width, Qt.SolidLine,
                                Qt.RoundCap))
            painter.drawPoints(QPolygonF([QPointF(x, y) for x, y in zip(
                xs[chosen].tolist(), ys[chosen].tolist())]))

    def _paint_robot(self, painter, scale):
        """Paint the robot's outline to scale, with its nose."""
        ink = theme.colour(theme.TEXT, self.palette())
        body = max(ROBOT_RADIUS_M * scale, 4.0)
        painter.setPen(QPen(ink, 1.6))
        painter.setBrush(theme.blend(self.palette().color(QPalette.Base), ink, 0.18))
        painter.drawEllipse(QPointF(0, 0), body, body)
        painter.setPen(Qt.NoPen)
        painter.setBrush(ink)
        painter.drawPolygon(QPolygonF([QPointF(0, -0.8 * body), QPointF(0.5 * body, 0.35 * body),
                                       QPointF(-0.5 * body, 0.35 * body)]))

    def _paint_line(self, painter, height):
        """Paint the line of words below the picture."""
        palette = self.palette()
        line = QRectF(0, self.height() - height, self.width(), height)
        painter.fillRect(line, palette.color(QPalette.Window))
        left = 0.0
        if self._warning or self._nearest_m < NEAR_M:
            side = height - 4.0
            theme.paint_sign(painter, QRectF(line.left(), line.top() + 2.0, side, side),
                             theme.TRIANGLE, theme.colour(theme.ATTENTION, palette),
                             palette.color(QPalette.Base))
            left = height + 2.0
        painter.setPen(theme.colour(theme.TEXT, palette))
        painter.drawText(line.adjusted(left, 0, 0, 0), int(Qt.AlignLeft | Qt.AlignVCenter),
                         self._warning or self._line)
