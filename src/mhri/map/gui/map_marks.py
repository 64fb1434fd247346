# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Paints goals, leaders, marks, the drawing in progress and the scale bar."""
import math

from python_qt_binding.QtCore import QPointF, Qt
from python_qt_binding.QtGui import QFontMetrics, QPalette, QPen, QPolygonF

from mhri.base.gui import theme
from mhri.base.gui.robot_sign import hue_of, paint_number, paint_shape, radius_px
from mhri.map.canvas import length_words, scale_bar
from mhri.map.gesture import FENCE
from mhri.map.gui.map_paint import paint_arrow, paint_fence, paint_words, trail_ink
from mhri.map.labels import place_labels
from mhri.map.trail import LINK_WORDS

# From the pole of a flag to its words [px].
_CLOTH_PX = 16.0


def paint_goal(painter, canvas, palette, goal, scene, font):
    """Paint the goals of robots: route, corners and names."""
    robots = [scene.robot(name) for name in goal.robots]
    number = next((robot.number for robot in robots if robot is not None), 0)
    ink = hue_of(number, palette)
    corners = QPolygonF([QPointF(*canvas.pixel(*corner)) for corner in goal.route])
    theme.set_ink(painter, QPen(ink, 2.0, Qt.DashLine))
    (painter.drawPolygon if goal.closed and len(goal.route) > 2 else painter.drawPolyline)(corners)
    for robot in robots:
        if robot is not None and robot.pose is not None and not goal.closed:
            painter.drawLine(QPointF(*canvas.pixel(robot.pose.x_m, robot.pose.y_m)), corners[0])
    last = corners[corners.count() - 1]
    for corner in corners:
        theme.set_ink(painter, QPen(palette.color(QPalette.Base), 1.0), ink)
        painter.drawEllipse(corner, 4.0, 4.0)
    theme.set_ink(painter, QPen(ink, 2.4))
    painter.drawEllipse(last, 9.0, 9.0)
    if goal.heading_rad is not None:
        paint_arrow(painter, last.x(), last.y(), canvas.heading(goal.heading_rad), 26.0, ink)
    who = ', '.join(str(robot.number) for robot in robots if robot is not None)
    paint_words(painter, last.x() + 13.0, last.y() - 7.0, who,
                theme.larger(font, theme.BODY, bold=True), ink, palette.color(QPalette.Base))


def paint_mark(painter, canvas, palette, mark, font):
    """Paint a mark, to which robots can be sent: a filled flag with its name."""
    _paint_flag(painter, canvas.pixel(mark.pose.x_m, mark.pose.y_m), palette, mark.name, font, True)


def paint_flags(painter, canvas, palette, flags, font):
    """Paint the marks of the session: outlined flags with the first words of their notes."""
    metrics = QFontMetrics(font)
    pixels = [canvas.pixel(flag.x_m, flag.y_m) for flag in flags]
    words = place_labels(
        [(*pixel, flag.label) for pixel, flag in zip(pixels, flags)], metrics.horizontalAdvance,
        metrics.height(), _CLOTH_PX, canvas.width)
    for pixel, (left, text) in zip(pixels, words):
        _paint_flag(painter, pixel, palette, text, font, False, left)


def _paint_flag(painter, pixel, palette, text, font, filled, left=None):
    """Paint a flag with a text that begins right of it, or at ``left`` [px]."""
    x_px, y_px = pixel
    ink, base = theme.colour(theme.TEXT, palette), palette.color(QPalette.Base)
    painter.setPen(QPen(ink, 2.0))
    painter.drawLine(QPointF(x_px, y_px), QPointF(x_px, y_px - 20.0))
    painter.setBrush(ink if filled else base)
    painter.drawPolygon(QPolygonF([QPointF(x_px, y_px - 20.0), QPointF(x_px + 13.0, y_px - 15.0),
                                   QPointF(x_px, y_px - 10.0)]))
    painter.setBrush(ink)
    painter.drawEllipse(QPointF(x_px, y_px), 2.5, 2.5)
    if text:
        paint_words(painter, x_px + _CLOTH_PX if left is None else left, y_px - 9.0, text, font,
                    ink, base)


def paint_scale(painter, canvas, palette, font):
    """Paint the scale bar at the lower left."""
    left, bottom = 9.0, canvas.height - 9.0
    length_m, length = scale_bar(canvas.px_per_m, min(180.0, canvas.width / 3.0))
    ink, base = theme.colour(theme.TEXT, palette), palette.color(QPalette.Base)
    for pen in (QPen(base, 5.0), QPen(ink, 2.0)):
        painter.setPen(pen)
        painter.drawPolyline(QPolygonF([
            QPointF(left, bottom - 6.0), QPointF(left, bottom), QPointF(left + length, bottom),
            QPointF(left + length, bottom - 6.0)]))
    paint_words(painter, left + 6.0, bottom - 7.0, length_words(length_m), font, ink, base)


def paint_leaders(painter, canvas, palette, scene):
    """Paint an arrow from each follower towards its leader."""
    for follower, leader in scene.leaders:
        one, other = scene.robot(follower), scene.robot(leader)
        if one and other and one.pose and other.pose:
            x_px, y_px = canvas.pixel(one.pose.x_m, one.pose.y_m)
            right, down = canvas.pixel(other.pose.x_m, other.pose.y_m)
            paint_arrow(painter, x_px, y_px, math.atan2(y_px - down, right - x_px),
                        0.6 * math.hypot(right - x_px, down - y_px), hue_of(one.number, palette),
                        2.0)


def paint_drawn(painter, canvas, palette, drawn, cursor):
    """Paint the drawing in progress.

    :param drawn: :class:`mhri.map.gesture.Gesture`
    :param cursor: position (x, y) [m] of the pointer, None outside
    """
    ink = theme.colour(theme.DRIVE, palette)
    if drawn.pose is not None:
        x_px, y_px = canvas.pixel(drawn.pose.x_m, drawn.pose.y_m)
        if drawn.start is not None:
            theme.set_ink(painter, QPen(ink, 2.4, Qt.DashLine))
            painter.drawLine(QPointF(*canvas.pixel(*drawn.start)), QPointF(x_px, y_px))
            return
        theme.set_ink(painter, QPen(palette.color(QPalette.Base), 1.0), ink)
        painter.drawEllipse(QPointF(x_px, y_px), 7.0, 7.0)
        if math.isfinite(drawn.pose.heading_rad):
            paint_arrow(painter, x_px, y_px, canvas.heading(drawn.pose.heading_rad), 44.0, ink, 4.0)
    corners = [*drawn.corners, *([cursor] if drawn.corners and cursor is not None else ())]
    if corners:
        paint_fence(painter, canvas, palette, corners, drawn.tool == FENCE and len(corners) > 2)
        theme.set_ink(painter, QPen(palette.color(QPalette.Base), 1.0), ink)
        for corner in drawn.corners:
            painter.drawEllipse(QPointF(*canvas.pixel(*corner)), 5.0, 5.0)


def paint_hint(painter, canvas, palette, hint, cursor, robot, font):
    """Paint what a click would do beside the pointer, and under it the robot being dragged.

    :param cursor: position (x, y) [m] of the pointer
    :param robot: the dragged robot, None without one
    """
    x_px, y_px = canvas.pixel(*cursor)
    bold, base = theme.larger(font, theme.BODY, bold=True), palette.color(QPalette.Base)
    metrics = QFontMetrics(bold)
    gap = metrics.height()
    if robot is not None:
        hue, radius = hue_of(robot.number, palette), radius_px(metrics, robot.number)
        theme.set_ink(painter, QPen(theme.colour(theme.DRIVE, palette), 2.4), hue)
        paint_shape(painter, QPointF(x_px, y_px), radius, robot.number)
        painter.setFont(bold)
        paint_number(painter, QPointF(x_px, y_px), radius, str(robot.number or ''), hue)
        gap += radius / 2.0
    wide = metrics.horizontalAdvance(hint)
    # Clear of the pointer; at the right edge to its left.
    left = x_px + gap if x_px + gap + wide < canvas.width else max(0.0, x_px - gap - wide)
    paint_words(painter, left, min(canvas.height - 4.0, max(gap, y_px - gap / 2.0)), hint, bold,
                theme.colour(theme.DRIVE, palette), base)


def paint_legend(painter, canvas, palette, font):
    """Paint the legend of trails by link quality beside the scale bar."""
    metrics = QFontMetrics(font)
    left, bottom = 9.0 + min(190.0, canvas.width / 3.0), canvas.height - 9.0
    for grade, words in enumerate(LINK_WORDS):
        painter.setPen(trail_ink(1, grade, True, palette))
        painter.drawLine(QPointF(left, bottom - 4.0), QPointF(left + 24.0, bottom - 4.0))
        paint_words(painter, left + 29.0, bottom, words, font, theme.colour(theme.TEXT, palette),
                    palette.color(QPalette.Base))
        left += 29.0 + metrics.horizontalAdvance(words) + metrics.height()
