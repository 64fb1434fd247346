# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Icons of one family: the SVG files of ``resource/icons``, painted in the colour of the text.

They are files of Lucide as published: lines 2 wide in a square of 24. Qt's own reader of SVG is a
package that not every robot computer has, and it cannot follow a palette; so the few shapes that
such files consist of are read here.
"""
from functools import lru_cache
import math
import os
import re
from xml.etree import ElementTree

from python_qt_binding.QtCore import QPointF, QRectF, Qt
from python_qt_binding.QtGui import (
    QGuiApplication, QIcon, QIconEngine, QPainterPath, QPalette, QPen)

# Side of the square in which the files are drawn, and width of their lines.
_SIDE, _LINE = 24.0, 2.0
_TOKEN = re.compile(r'[A-Za-z]|[-+]?(?:\d*\.\d+|\d+\.?)(?:[eE][-+]?\d+)?')
# Numbers that each command of a path takes.
_TAKES = {'M': 2, 'L': 2, 'H': 1, 'V': 1, 'C': 6, 'S': 4, 'Q': 4, 'A': 7, 'Z': 0}
_folder = ['']


def use_folder(path):
    """Set the folder of the SVG files; before, and for a missing file, an icon is empty."""
    _folder[0] = path


def icon(name):
    """Return a :class:`QIcon`: the file of that name without ``.svg``."""
    return QIcon(_Engine(name))


def paint_icon(painter, rect, name, ink):
    """Paint an icon.

    :param rect: :class:`QRectF`; the icon fills the square in its centre
    :param ink: :class:`QColor` of its lines
    """
    side = min(rect.width(), rect.height())
    painter.save()
    painter.setRenderHint(painter.Antialiasing)
    painter.translate(rect.center() - QPointF(side / 2.0, side / 2.0))
    painter.scale(side / _SIDE, side / _SIDE)
    painter.setPen(QPen(ink, _LINE, Qt.SolidLine, Qt.RoundCap, Qt.RoundJoin))
    painter.setBrush(Qt.NoBrush)
    painter.drawPath(path_of(_folder[0], name))
    painter.restore()


class _Engine(QIconEngine):
    """Paints an icon in the colour of the text on buttons, at any size."""

    def __init__(self, name):
        super().__init__()
        self._name = name

    def iconName(self):  # noqa: N802
        """Return the name, by which a style paints it in the colours of a widget."""
        return self._name

    def clone(self):
        """Return a copy."""
        return _Engine(self._name)

    def paint(self, painter, rect, mode, state):
        """Paint it."""
        group = QPalette.Disabled if mode == QIcon.Disabled else QPalette.Active
        paint_icon(painter, QRectF(rect), self._name,
                   QGuiApplication.palette().color(group, QPalette.ButtonText))


@lru_cache(maxsize=None)
def path_of(folder, name):
    """Return the lines of an icon as a :class:`QPainterPath`, empty if there is no such file.

    :raises ValueError: the file has a shape or a command that is not read here
    """
    path = QPainterPath()
    try:
        root = ElementTree.parse(os.path.join(folder, name + '.svg')).getroot()
    except OSError:
        return path
    for shape in root:
        if not isinstance(shape.tag, str):
            continue
        _add_shape(path, shape.tag.rpartition('}')[2], shape.attrib)
    return path


def _add_shape(path, kind, given):
    """Add one element of a file."""
    def number(key):
        return float(given.get(key, 0.0))

    if kind == 'path':
        _PathReader(path).read(given['d'])
    elif kind == 'line':
        path.moveTo(number('x1'), number('y1'))
        path.lineTo(number('x2'), number('y2'))
    elif kind == 'circle':
        path.addEllipse(QPointF(number('cx'), number('cy')), number('r'), number('r'))
    elif kind == 'rect':
        path.addRoundedRect(QRectF(*map(number, ('x', 'y', 'width', 'height'))), number('rx'),
                            number('rx'))
    elif kind in ('polyline', 'polygon'):
        _PathReader(path).read('M' + given['points'] + ('Z' if kind == 'polygon' else ''))
    else:
        raise ValueError('an icon with a shape that is not read: ' + kind)


class _PathReader:
    """Reads the commands of a path into a :class:`QPainterPath`."""

    def __init__(self, path):
        self._path = path
        self._at = QPointF()
        self._control = QPointF()

    def read(self, text):
        """Read all commands; a command with more numbers than it takes is repeated."""
        tokens = _TOKEN.findall(text)
        while tokens:
            command = tokens.pop(0)
            takes = _TAKES.get(command.upper())
            if takes is None:
                raise ValueError('an icon with a command that is not read: ' + command)
            while True:
                values = [float(tokens.pop(0)) for _ in range(takes)]
                self._do(command.upper(), values, command.islower())
                if not takes or not tokens or tokens[0].isalpha():
                    break
                # More pairs after a "move" are lines.
                command = {'M': 'L', 'm': 'l'}.get(command, command)

    def _do(self, command, values, relative):
        """Carry out one command."""
        before = self._at
        base = before if relative else QPointF()
        if command == 'Z':
            self._path.closeSubpath()
        elif command in 'HV':
            place = values[0] + (base.x() if command == 'H' else base.y())
            self._path.lineTo(QPointF(place, before.y()) if command == 'H'
                              else QPointF(before.x(), place))
        elif command == 'A':
            self._arc(before, values[0], values[3] != 0.0, values[4] != 0.0,
                      base + QPointF(*values[5:]))
        else:
            points = [base + QPointF(*pair) for pair in zip(values[::2], values[1::2])]
            self._draw(command, before, points)
        self._at = self._path.currentPosition()
        if command not in 'CS':
            self._control = self._at

    def _draw(self, command, before, points):
        """Move, or draw a line or a curve."""
        if command == 'M':
            self._path.moveTo(*points)
        elif command == 'L':
            self._path.lineTo(*points)
        elif command == 'Q':
            self._path.quadTo(*points)
        else:
            first = points[:-2] or [before + (before - self._control)]
            self._path.cubicTo(*first, *points[-2:])
            self._control = points[-2]

    def _arc(self, start, radius, large, clockwise, end):
        """Draw a part of a circle to a point."""
        across = end - start
        apart = math.hypot(across.x(), across.y())
        if not apart or not radius:
            self._path.lineTo(end)
            return
        radius = max(radius, apart / 2.0)
        away = math.sqrt(max(0.0, radius ** 2 - apart ** 2 / 4.0))
        side = -1.0 if large == clockwise else 1.0
        middle = (start + end) / 2.0 + QPointF(-across.y(), across.x()) * (side * away / apart)
        begin, stop = (math.degrees(math.atan2(middle.y() - point.y(), point.x() - middle.x()))
                       for point in (start, end))
        sweep = (begin - stop) % 360.0 if clockwise else -((stop - begin) % 360.0)
        self._path.arcTo(QRectF(middle.x() - radius, middle.y() - radius, 2 * radius, 2 * radius),
                         begin, -sweep)
        # So that rounding leaves no gap where the next command begins.
        self._path.lineTo(end)
