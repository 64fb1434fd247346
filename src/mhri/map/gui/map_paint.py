# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Painting functions of the map: ground, points, robots, goals, labels."""
import math

import numpy as np
from python_qt_binding.QtCore import QPointF, QRectF, Qt
from python_qt_binding.QtGui import (
    QColor, QFontMetrics, QImage, QPainter, QPalette, QPen, QPolygonF)

from mhri.base.gui import theme
from mhri.base.gui.painting import edged_words
from mhri.base.gui.robot_sign import hue_of, paint_number, paint_shape, radius_px
from mhri.base.series import round_step
from mhri.base.views import GONE
from mhri.map.trail import GOOD, LOST, SLOW

_LINK_TONES = {GOOD: theme.LIVE, SLOW: theme.ATTENTION, LOST: theme.STOP}
# Share of the ground colour in a trail, by its age.
_FADES = (0.0, 0.35, 0.65)
_STROKES = (Qt.SolidLine, Qt.DashLine, Qt.DotLine)
# Minimum distance of grid lines [px].
_LINES_PX = 44.0
_POINT_PX = 3
# Margin of labels for their outline.
_EDGE_PX = 2


def polygon_of(pixels):
    """Return an array (n, 2) as a :class:`QPolygonF`."""
    return QPolygonF([QPointF(x, y) for x, y in pixels.tolist()])


def grid_picture(grid, palette):
    """Return (a :class:`Grid` as a picture, its lowest row on top, the owner of its memory)."""
    free, taken = palette.color(QPalette.Base), palette.color(QPalette.WindowText)
    unknown = theme.blend(palette.color(QPalette.Window), taken, 0.16)
    table = np.array([unknown.rgb()] + [theme.blend(free, taken, 0.9 * share / 100.0).rgb()
                                        for share in range(101)], np.uint32)
    pixels = np.ascontiguousarray(table[grid.cells.astype(np.int16) + 1])
    height, width = pixels.shape
    return QImage(pixels.data, width, height, 4 * width, QImage.Format_RGB32), pixels


class Ground:
    """The background: map, grid lines, fence and trails, cached across repaints."""

    def __init__(self):
        self._key = None
        self._image = None
        self._pixels = None
        self.painted = 0

    def pixels(self, key, canvas, ratio, paint):
        """Return the picture as a read-only array (height, width) of RGB32.

        :param key: everything that the picture depends on; it is only repainted on a change
        :param ratio: screen pixels per widget pixel
        :param paint: function of a :class:`QPainter` that paints the picture
        """
        key = (key, canvas, ratio)
        if key != self._key:
            self._key = key
            self.painted += 1
            size = max(1, round(canvas.width * ratio)), max(1, round(canvas.height * ratio))
            self._image = QImage(*size, QImage.Format_RGB32)
            self._image.setDevicePixelRatio(ratio)
            painter = QPainter(self._image)
            painter.setRenderHint(QPainter.Antialiasing)
            paint(painter)
            painter.end()
            bits = self._image.constBits()
            if hasattr(bits, 'setsize'):
                bits.setsize(self._image.bytesPerLine() * size[1])
            self._pixels = np.frombuffer(bits, np.uint32).reshape(size[1], -1)[:, :size[0]]
        return self._pixels


def stamp(pixels, canvas, ratio, robots, palette):
    """Return a picture of the laser points of robots as dots in their hues."""
    placed = [robot for robot in robots if robot.points is not None and len(robot.points)]
    result = np.ascontiguousarray(pixels).copy()
    if not placed:
        return result
    places = canvas.pixels(np.concatenate([robot.points for robot in placed])) * ratio
    inks = np.repeat(np.array([hue_of(robot.number, palette).rgb() for robot in placed], np.uint32),
                     [len(robot.points) for robot in placed])
    side = max(2, round(_POINT_PX * ratio))
    height, width = result.shape
    inside = ((places > side) & (places < (width - side, height - side))).all(axis=1)
    columns, rows = (places[inside] - side / 2.0).astype(np.intp).T
    inks, flat = inks[inside], result.reshape(-1)
    at = rows * width + columns
    for down in range(side):
        for right in range(side):
            flat[at + (down * width + right)] = inks
    return result


def paint_ground(painter, canvas, palette, grid, image):
    """Paint the map, and grid lines at whole metres.

    :param grid: the :class:`Grid`, None without a map
    :param image: its picture
    """
    painter.fillRect(QRectF(0, 0, canvas.width, canvas.height), palette.color(
        QPalette.Base) if grid is None else QColor(theme.blend(palette.color(
            QPalette.Window), palette.color(QPalette.WindowText), 0.16)))
    if grid is not None:
        painter.save()
        painter.setRenderHint(QPainter.Antialiasing, False)
        painter.setRenderHint(QPainter.SmoothPixmapTransform,
                              canvas.px_per_m * grid.resolution_m < 1.0)
        painter.translate(*canvas.pixel(grid.origin.x_m, grid.origin.y_m))
        painter.rotate(-math.degrees(canvas.heading(grid.origin.heading_rad)))
        scale = canvas.px_per_m * grid.resolution_m
        painter.scale(scale, -scale)
        painter.drawImage(QPointF(0, 0), image)
        painter.restore()
    _paint_lines(painter, canvas, palette)


def _paint_lines(painter, canvas, palette):
    """Paint grid lines at whole metres; those through the origin are stronger."""
    step = round_step(_LINES_PX / canvas.px_per_m)
    reach = math.hypot(canvas.width, canvas.height) / 2.0 / canvas.px_per_m + step
    quiet, strong = (theme.blend(palette.color(QPalette.WindowText), palette.color(
        QPalette.Base), share) for share in (0.86, 0.6))
    for index in range(math.floor(-reach / step), math.ceil(reach / step) + 1):
        for axis, middle in enumerate((canvas.x_m, canvas.y_m)):
            at = (round(middle / step) + index) * step
            painter.setPen(QPen(strong if abs(at) < step / 2.0 else quiet, 1))
            ends = [(at, canvas.y_m - reach), (at, canvas.y_m + reach)] if axis == 0 else \
                [(canvas.x_m - reach, at), (canvas.x_m + reach, at)]
            painter.drawLine(*[QPointF(*canvas.pixel(*end)) for end in ends])


def paint_fence(painter, canvas, palette, fence, closed=True):
    """Paint the fence: dashed, in the colour of everything that stops a robot."""
    theme.set_ink(painter, QPen(theme.colour(theme.ATTENTION, palette), 2.5, Qt.DashLine))
    corners = QPolygonF([QPointF(*canvas.pixel(*corner)) for corner in fence])
    (painter.drawPolygon if closed else painter.drawPolyline)(corners)


def trail_ink(number, grade, by_link, palette):
    """Return the pen of a piece of trail; by link, each grade has its own line style."""
    if by_link:
        return QPen(theme.colour(_LINK_TONES[grade], palette), 2.6, _STROKES[grade])
    return QPen(theme.blend(hue_of(number, palette), palette.color(QPalette.Base), _FADES[grade]),
                2.6 - 0.6 * grade)


def paint_trails(painter, canvas, palette, robots, by_link, now_s):
    """Paint the trails of robots."""
    painter.setBrush(Qt.NoBrush)
    for robot in robots:
        if robot.trail is not None and robot.pose is not None:
            for grade, places in robot.trail.pieces(by_link, now_s):
                painter.setPen(trail_ink(robot.number, grade, by_link, palette))
                painter.drawPolyline(polygon_of(canvas.pixels(places)))


def paint_arrow(painter, x_px, y_px, heading, length, ink, width=3.0):
    """Paint an arrow from a pixel; 0 is to the right, a quarter turn up."""
    tip = QPointF(x_px + length * math.cos(heading), y_px - length * math.sin(heading))
    painter.setPen(QPen(ink, width, Qt.SolidLine, Qt.RoundCap))
    painter.drawLine(QPointF(x_px, y_px), tip)
    theme.set_ink(painter, brush=ink)
    side = max(9.0, 0.3 * length)
    painter.drawPolygon(QPolygonF([tip + 0.3 * (tip - QPointF(x_px, y_px)) / max(
        1.0, length) * side] + [tip - QPointF(side * math.cos(heading + turn), -side * math.sin(
            heading + turn)) for turn in (0.5, -0.5)]))


def paint_robot(painter, canvas, palette, robot, font):
    """Paint a robot's footprint, heading, and number in its shape.

    One whose place is old, or that is lost, is pale and dashed.
    """
    x_px, y_px = canvas.pixel(robot.pose.x_m, robot.pose.y_m)
    middle, heading = QPointF(x_px, y_px), canvas.heading(robot.pose.heading_rad)
    hue = hue_of(robot.number, palette)
    base = palette.color(QPalette.Base)
    if robot.old:
        hue = theme.blend(hue, base, 0.55)
    bold = theme.larger(font, theme.BODY, bold=True)
    metrics = QFontMetrics(bold)
    disc = radius_px(metrics, robot.number)
    foot = robot.radius_m * canvas.px_per_m
    edge = _edge_ink(robot, palette)
    painter.setBrush(QColor(hue.red(), hue.green(), hue.blue(), 60))
    painter.setPen(QPen(edge or hue, 3.5 if edge else 1.6,
                        Qt.DashLine if robot.old else Qt.SolidLine))
    painter.drawEllipse(middle, max(foot, disc), max(foot, disc))
    reach = max(foot, disc) + (0 if foot > 1.9 * disc else 0.55 * disc)
    nose = [QPointF(x_px + far * math.cos(heading + turn), y_px - far * math.sin(heading + turn))
            for far, turn in ((reach + 4.0, 0.0), (disc * 0.95, 0.55), (disc * 0.95, -0.55))]
    theme.set_ink(painter, QPen(base, 1.0), hue)
    painter.drawPolygon(QPolygonF(nose))
    painter.setPen(QPen(base, 1.2))
    paint_shape(painter, middle, disc, robot.number)
    painter.setFont(bold)
    paint_number(painter, middle, disc, str(robot.number) if robot.number else robot.name[:2], hue)


def paint_labels(painter, canvas, palette, robots, font, large):
    """Paint the label below each robot; a calm one only where it lies over no other label.

    :param robots: in the order of painting: the last ones are the most important
    :param large: whether the map is large; a small one only has labels of robots in trouble
    """
    bold, taken = theme.larger(font, theme.BODY, bold=True), []
    metrics = QFontMetrics(bold)
    for robot in sorted(reversed(robots), key=lambda robot: not robot.trouble):
        word = robot_word(robot, large)
        if not word or robot.pose is None:
            continue
        x_px, y_px = canvas.pixel(robot.pose.x_m, robot.pose.y_m)
        below = y_px + 3.0 + max(robot.radius_m * canvas.px_per_m,
                                 radius_px(metrics, robot.number))
        wide = metrics.horizontalAdvance(word)
        box = QRectF(x_px - wide / 2.0, below, wide, metrics.height())
        if robot.trouble or not any(box.intersects(other) for other in taken):
            taken.append(box)
            paint_words(painter, box.left(), below + metrics.ascent(), word, bold, _edge_ink(
                robot, palette) or theme.colour(theme.TEXT, palette), palette.color(QPalette.Base))


def robot_word(robot, large=True):
    """Return the label below a robot, which only names unusual states."""
    if robot.trouble:
        return '{} {}'.format(robot.name, robot.lost or robot.trouble)
    if not large:
        return ''
    if robot.driven or robot.looked_at or robot.selected:
        return '{} {}'.format(robot.name, robot.state)
    return robot.state if robot.task else ''


def _edge_ink(robot, palette):
    """Return the colour around a robot in an unusual state, else None."""
    if robot.trouble:
        return theme.colour(theme.STOP if robot.trouble == GONE or robot.lost else theme.ATTENTION,
                            palette)
    if robot.task or robot.driven or robot.selected:
        return theme.colour(theme.TASK if robot.task else theme.DRIVE, palette)
    return theme.colour(theme.TEXT, palette) if robot.looked_at else None


def paint_words(painter, x_px, y_px, text, font, ink, edge):
    """Paint outlined text, readable on any background; (x, y) is the start of the baseline."""
    image = edged_words(text, font.toString(), ink.rgba(), edge.rgba(), 3.5, _EDGE_PX,
                        painter.device().devicePixelRatioF())
    painter.drawImage(QPointF(round(x_px) - _EDGE_PX,
                              round(y_px) - _EDGE_PX - QFontMetrics(font).ascent()), image)
