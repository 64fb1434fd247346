# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's laser scan from above: ahead is up, and the walls in sight fill the picture."""
import math
from typing import NamedTuple

import numpy as np
from python_qt_binding.QtCore import QPointF, QRectF, Qt
from python_qt_binding.QtGui import QPainter, QPalette, QPen, QPolygonF
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.painting import Sized
from mhri.base.gui.pending import Pace
from mhri.base.plausible import BOUNDS, RANGE

# Distances from the robot to the edges of the picture [m].
_REACHES = (0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0, 30.0, 50.0, 100.0)
# Spacings of the rings [m], of which the picture shows at most so many each way.
_RINGS, _MAX_RINGS = (0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 25.0), 4.0
# This many scans in a row have to fit a smaller reach before it is used, and an edge moves by this
# share of its way with each scan: the scale never jumps.
_SHRINK_AFTER, _STEP = 40, 0.35
# Share of the points that may lie beyond an edge.
_BEYOND = 0.02
# Height of the line of words below the picture [line heights].
_LINE_UNITS = 1.4
NEAR_M = 0.5
OLD_S = 1.0
ROBOT_RADIUS_M = 0.18


def _valid(ranges):
    """Return a mask of the ranges that are measurements to draw."""
    with np.errstate(invalid='ignore'):
        return (ranges >= BOUNDS[RANGE].least) & (ranges <= BOUNDS[RANGE].greatest)


class Window(NamedTuple):
    """Distances from the robot to the edges of the picture [m]."""

    ahead: float
    back: float
    left: float
    right: float


def reach_for(metres):
    """Return the smallest reach [m] of an edge that shows all but the farthest 2 % of distances."""
    farthest = np.percentile(metres, 100.0 * (1.0 - _BEYOND)) if len(metres) else 0.0
    return next((reach for reach in _REACHES if farthest <= reach), _REACHES[-1])


def window_for(points):
    """Return the :class:`Window` that shows all but a few of some :func:`scan_points`."""
    ahead, left, _ = points
    return Window(*(reach_for(np.clip(side, 0.0, None)) for side in (ahead, -ahead, left, -left)))


def scan_points(ranges, angle_min, angle_increment):
    """Return the valid points as arrays (x ahead, y left, range), all in m."""
    valid = _valid(ranges)
    angles = angle_min + angle_increment * np.flatnonzero(valid)
    distances = ranges[valid]
    return distances * np.cos(angles), distances * np.sin(angles), distances


class ScanView(Sized, QWidget):
    """Points in metres around the sensor, rings with their radius, the robot's outline.

    Points nearer than 0.5 m are orange and larger. A single sensor is drawn as if mounted in the
    robot's centre. It is dark in every theme, as it may lie over a picture.
    """

    USUAL_UNITS, MIN_UNITS = (15, 15), (5, 5)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._points = None
        #: range of the nearest point [m], NaN for none
        self.nearest_m = math.nan
        self._line = ''
        self._numbers = Pace()
        #: the displayed :class:`Window`
        self.shown_m = Window(*[4.0] * 4)
        self._wanted_m, self._ample = self.shown_m, [0] * 4
        self._words = 'waiting for the first scan'
        #: text across an old scan, '' while it is live
        self.warning = ''
        self._build()

    def _build(self):
        """Set up the widget."""
        self.setObjectName('scan_view')
        # So that it is not drawn again with each picture below it.
        self.setAttribute(Qt.WA_OpaquePaintEvent)
        self.setPalette(theme.over_picture(self.palette()))
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    def show_value(self, scan):
        """Show a scan as :meth:`Lasers.take` returns it; NaN values are not drawn."""
        ranges, angle_min, angle_increment, _ = scan
        first = self._points is None
        self._points = scan_points(ranges, angle_min, angle_increment)
        self._follow(window_for(self._points), first)
        self.nearest_m = float(np.min(self._points[2])) if len(self._points[2]) else math.nan
        self.warning = ''
        if self._numbers.due():
            self._line = 'nothing within reach' if math.isnan(self.nearest_m) else \
                'nearest {:.2f} m'.format(self.nearest_m)
        self.update()

    def show_age(self, age_s):
        """Mark the newest scan if it is old.

        :param age_s: its age [s], None before the first
        """
        old = age_s is not None and age_s > OLD_S and self._points is not None
        warning = 'OLD SCAN, {}'.format(words.age_text(age_s)) if old else ''
        if warning != self.warning:
            self.warning = warning
            self.update()

    def save_settings(self):
        """Return the settings kept between runs, an empty dict."""
        return {}

    def restore_settings(self, settings):
        """Do nothing: there are no settings to restore."""

    def clear(self, text):
        """Show words instead of a scan."""
        self._points, self._words, self.warning = None, text, ''
        self.update()

    def _follow(self, needed, first):
        """Move each edge outwards at once, inwards late, a part of its way with each scan."""
        wanted = list(self._wanted_m)
        for side, metres in enumerate(needed):
            self._ample[side] = self._ample[side] + 1 if metres < wanted[side] else 0
            if first or metres > wanted[side] or self._ample[side] >= _SHRINK_AFTER:
                wanted[side], self._ample[side] = metres, 0
        self._wanted_m = Window(*wanted)
        self.shown_m = self._wanted_m if first else Window(*(
            now + _STEP * (goal - now) if abs(goal - now) > 0.01 * goal else goal
            for now, goal in zip(self.shown_m, wanted)))

    def frame(self):
        """Return (x, y, scale): the place of the robot in the widget [px], and pixels per metre."""
        edge, line = 3.0, _LINE_UNITS * self.fontMetrics().height()
        width, height = self.width() - 2.0 * edge, self.height() - line - 2.0 * edge
        ahead, back, left, right = self.shown_m
        scale = max(0.1, min(width / (left + right), height / (ahead + back)))
        return (edge + 0.5 * width + 0.5 * (left - right) * scale,
                edge + 0.5 * height + 0.5 * (ahead - back) * scale, scale)

    def paintEvent(self, event):  # noqa: N802
        """Paint rings, points, robot and words."""
        painter = QPainter(self)
        palette = self.palette()
        painter.fillRect(self.rect(), palette.color(QPalette.Base))
        if self._points is None:
            painter.setPen(theme.colour(theme.MUTED, palette))
            painter.drawText(self.rect(), int(Qt.AlignCenter | Qt.TextWordWrap), self._words)
        else:
            painter.setRenderHint(QPainter.Antialiasing)
            line_room = _LINE_UNITS * self.fontMetrics().height()
            x, y, scale = self.frame()
            painter.save()
            painter.setClipRect(QRectF(0, 0, self.width(), self.height() - line_room))
            painter.translate(x, y)
            self._paint_rings(painter, scale)
            self._paint_points(painter, scale)
            self._paint_robot(painter, scale)
            painter.restore()
            self._paint_line(painter, line_room)
        theme.set_ink(painter, QPen(theme.line_colour(palette), 1))
        painter.drawRect(self.rect().adjusted(0, 0, -1, -1))

    def _paint_rings(self, painter, scale):
        """Paint the rings, their radii and the direction ahead."""
        palette, unit = self.palette(), self.fontMetrics().height()
        reach = max(self.shown_m)
        step = next((ring for ring in _RINGS if reach <= _MAX_RINGS * ring), _RINGS[-1])
        beyond = reach + math.hypot(self.width(), self.height()) / scale
        theme.set_ink(painter, QPen(theme.line_colour(palette), 1))
        for index in range(1, int(beyond / step) + 1):
            painter.drawEllipse(QPointF(0, 0), index * step * scale, index * step * scale)
        painter.drawLine(QPointF(0, -beyond * scale), QPointF(0, beyond * scale))
        painter.drawLine(QPointF(-beyond * scale, 0), QPointF(beyond * scale, 0))
        painter.setPen(theme.colour(theme.MUTED, palette))
        lines = max(1, math.ceil(1.3 * unit / (step * scale)))
        for index in range(lines, int(self.shown_m.ahead / step) + 1, lines):
            label = QRectF(4, -index * step * scale, 6 * unit, 1.1 * unit)
            painter.drawText(label, int(Qt.AlignLeft | Qt.AlignTop),
                             '{:g} m'.format(index * step))

    def _paint_points(self, painter, scale):
        """Paint the points; forward is up, left is left."""
        ahead, left, distances = self._points
        xs, ys = -left * scale, -ahead * scale
        near = distances < NEAR_M
        for chosen, ink, width in ((~near, theme.DRIVE, 3.4), (near, theme.ATTENTION, 6.0)):
            if self.warning:
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
        theme.set_ink(painter, brush=ink)
        painter.drawPolygon(QPolygonF([QPointF(0, -0.8 * body), QPointF(0.5 * body, 0.35 * body),
                                       QPointF(-0.5 * body, 0.35 * body)]))

    def _paint_line(self, painter, height):
        """Paint the line of words below the picture."""
        palette = self.palette()
        line = QRectF(0, self.height() - height, self.width(), height)
        painter.fillRect(line, palette.color(QPalette.Window))
        left = 0.0
        if self.warning or self.nearest_m < NEAR_M:
            side = height - 4.0
            theme.paint_sign(painter, QRectF(line.left(), line.top() + 2.0, side, side),
                             theme.TRIANGLE, theme.colour(theme.ATTENTION, palette),
                             palette.color(QPalette.Base))
            left = height + 2.0
        painter.setPen(theme.colour(theme.TEXT, palette))
        painter.drawText(line.adjusted(left + 4.0, 0, 0, 0), int(Qt.AlignLeft | Qt.AlignVCenter),
                         self.warning or self._line)
