# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the map is painted with: the ground that seldom changes, points, robots, goals, words."""
from functools import lru_cache
import math

import numpy as np
from python_qt_binding.QtCore import QPointF, QRectF, Qt
from python_qt_binding.QtGui import (
    QColor, QFont, QFontMetrics, QImage, QPainter, QPainterPath, QPalette, QPen, QPolygonF)

from mhri.base.gui import theme
from mhri.base.series import round_step
from mhri.base.views import GONE
from mhri.map.trail import GOOD, LOST, SLOW

# The hue of a robot's disc, trail and points, by its number, on light and on dark: of Okabe and
# Ito and between them, without those that mean something else here. The number says the same.
_HUES = (('#0072B2', '#56B4E9'), ('#A14F80', '#CC79A7'), ('#6F6400', '#F0E442'),
         ('#5B4BC4', '#A99BF5'), ('#00766E', '#5FD3C6'), ('#7A5A2E', '#D9B98C'))
_LINK_TONES = {GOOD: theme.LIVE, SLOW: theme.ATTENTION, LOST: theme.STOP}
# So much of the ground is mixed into a trail, by how old it is.
_FADES = (0.0, 0.35, 0.65)
_STROKES = (Qt.SolidLine, Qt.DashLine, Qt.DotLine)
# Lines of the ground are at least so far apart [px].
_LINES_PX = 44.0
_POINT_PX = 3
# Room around words for their edge.
_EDGE_PX = 2


def hue_of(number, palette):
    """Return the :class:`QColor` of the robot of a number."""
    return QColor(_HUES[max(0, number - 1) % len(_HUES)][theme.is_dark(palette)])


def polygon_of(pixels):
    """Return an array (n, 2) as a :class:`QPolygonF`."""
    return QPolygonF([QPointF(x, y) for x, y in pixels.tolist()])


def grid_picture(grid, palette):
    """Return a :class:`Grid` as a picture, its lowest row on top, and what keeps its memory."""
    free, taken = palette.color(QPalette.Base), palette.color(QPalette.WindowText)
    unknown = theme.blend(palette.color(QPalette.Window), taken, 0.16)
    table = np.array([unknown.rgb()] + [theme.blend(free, taken, 0.9 * share / 100.0).rgb()
                                        for share in range(101)], np.uint32)
    pixels = np.ascontiguousarray(table[grid.cells.astype(np.int16) + 1])
    height, width = pixels.shape
    return QImage(pixels.data, width, height, 4 * width, QImage.Format_RGB32), pixels


class Ground:
    """The map, lines of whole metres, the fence and the trails: painted once for many drawings."""

    def __init__(self):
        self._key = None
        self._image = None
        self._pixels = None
        self.painted = 0

    def pixels(self, key, canvas, ratio, paint):
        """Return the picture as an array (height, width) of RGB32; it is not to be changed.

        :param key: what it depends on: the same again costs nothing
        :param ratio: pixels of the screen for one of the widget
        :param paint: function of the :class:`QPainter` that paints it anew
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
    """Return a picture with what the lasers of robots have met as dots of their hues."""
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
    """Paint what is known of the world, and lines of whole metres.

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
    """Paint lines of whole metres; those of the origin are stronger."""
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
    """Paint the fence: dashed, in the colour of what holds a robot back."""
    painter.setBrush(Qt.NoBrush)
    painter.setPen(QPen(theme.colour(theme.ATTENTION, palette), 2.5, Qt.DashLine))
    corners = QPolygonF([QPointF(*canvas.pixel(*corner)) for corner in fence])
    (painter.drawPolygon if closed else painter.drawPolyline)(corners)


def trail_ink(number, grade, by_link, palette):
    """Return the pen of a piece of trail; each grade has a stroke of its own by link."""
    if by_link:
        return QPen(theme.colour(_LINK_TONES[grade], palette), 2.6, _STROKES[grade])
    return QPen(theme.blend(hue_of(number, palette), palette.color(QPalette.Base), _FADES[grade]),
                2.6 - 0.6 * grade)


def paint_trails(painter, canvas, palette, robots, by_link, now_s):
    """Paint where robots have been."""
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
    painter.setPen(Qt.NoPen)
    painter.setBrush(ink)
    side = max(9.0, 0.3 * length)
    painter.drawPolygon(QPolygonF([tip + 0.3 * (tip - QPointF(x_px, y_px)) / max(
        1.0, length) * side] + [tip - QPointF(side * math.cos(heading + turn), -side * math.sin(
            heading + turn)) for turn in (0.5, -0.5)]))


def paint_robot(painter, canvas, palette, robot, font):
    """Paint a robot's footprint, heading, and its number in a disc; in a word what it does."""
    x_px, y_px = canvas.pixel(robot.pose.x_m, robot.pose.y_m)
    middle, heading = QPointF(x_px, y_px), canvas.heading(robot.pose.heading_rad)
    hue = hue_of(robot.number, palette)
    base = palette.color(QPalette.Base)
    if robot.old:
        hue = theme.blend(hue, base, 0.55)
    bold = theme.larger(font, 1.0, bold=True)
    metrics = QFontMetrics(bold)
    disc = disc_px(metrics, robot.number)
    foot = robot.radius_m * canvas.px_per_m
    edge = _edge_ink(robot, palette)
    painter.setBrush(QColor(hue.red(), hue.green(), hue.blue(), 60))
    painter.setPen(QPen(edge or hue, 3.5 if edge else 1.6,
                        Qt.DashLine if robot.old else Qt.SolidLine))
    painter.drawEllipse(middle, max(foot, disc), max(foot, disc))
    reach = max(foot, disc) + (0 if foot > 1.9 * disc else 0.55 * disc)
    nose = [QPointF(x_px + far * math.cos(heading + turn), y_px - far * math.sin(heading + turn))
            for far, turn in ((reach + 4.0, 0.0), (disc * 0.95, 0.55), (disc * 0.95, -0.55))]
    painter.setPen(QPen(base, 1.0))
    painter.setBrush(hue)
    painter.drawPolygon(QPolygonF(nose))
    painter.setPen(QPen(base, 1.2))
    painter.drawEllipse(middle, disc, disc)
    painter.setFont(bold)
    painter.setPen(theme.readable_on(hue))
    painter.drawText(QRectF(x_px - 2 * disc, y_px - disc, 4 * disc, 2 * disc), int(Qt.AlignCenter),
                     str(robot.number) if robot.number else robot.name[:2])
    word = robot_word(robot)
    if word:
        below = y_px + max(foot, disc) + 3.0
        paint_words(painter, x_px - metrics.horizontalAdvance(word) / 2.0, below + metrics.ascent(),
                    word, bold, edge or theme.colour(theme.TEXT, palette), base)


def disc_px(metrics, number):
    """Return the radius of the disc that a number is written in [px]."""
    return 0.5 * max(1.35 * metrics.height(), metrics.horizontalAdvance(str(number)) + 12.0)


def robot_word(robot):
    """Return what is written below a robot: only what is not the rule."""
    if robot.trouble:
        return '{} {}'.format(robot.name, robot.trouble)
    if robot.driven or robot.looked_at or robot.selected:
        return '{} {}'.format(robot.name, robot.state)
    return robot.state if robot.task else ''


def _edge_ink(robot, palette):
    """Return the colour around a robot whose state is not the rule, else None."""
    if robot.trouble:
        return theme.colour(theme.STOP if robot.trouble == GONE else theme.ATTENTION, palette)
    if robot.task or robot.driven or robot.selected:
        return theme.colour(theme.TASK if robot.task else theme.DRIVE, palette)
    return theme.colour(theme.TEXT, palette) if robot.looked_at else None


def paint_words(painter, x_px, y_px, text, font, ink, edge):
    """Paint words with an edge, to be read on everything; (x, y) is where their line begins."""
    image = _words_picture(text, font.toString(), ink.rgba(), edge.rgba(),
                           painter.device().devicePixelRatioF())
    painter.drawImage(QPointF(round(x_px) - _EDGE_PX,
                              round(y_px) - _EDGE_PX - QFontMetrics(font).ascent()), image)


# To paint an edge takes a millisecond, and the same words come ten times a second.
@lru_cache(maxsize=300)
def _words_picture(text, font_name, ink, edge, ratio):
    """Return words with an edge as a picture."""
    font = QFont()
    font.fromString(font_name)
    metrics = QFontMetrics(font)
    width, height = (math.ceil(ratio * (size + 2 * _EDGE_PX)) for size in (
        metrics.horizontalAdvance(text) + 2, metrics.height()))
    image = QImage(width, height, QImage.Format_ARGB32_Premultiplied)
    image.setDevicePixelRatio(ratio)
    image.fill(Qt.transparent)
    path = QPainterPath()
    path.addText(QPointF(_EDGE_PX, _EDGE_PX + metrics.ascent()), font, text)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.Antialiasing)
    painter.setPen(QPen(QColor(edge), 3.5, Qt.SolidLine, Qt.RoundCap, Qt.RoundJoin))
    painter.drawPath(path)
    painter.fillPath(path, QColor(ink))
    painter.end()
    return image
