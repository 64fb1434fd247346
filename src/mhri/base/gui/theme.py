# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Colours, shapes, fonts and sizes: one look for every widget, in light and in dark.

The colours are those of Okabe and Ito, which people with any kind of colour vision tell apart; and
none of them is ever the only sign: each state has a shape and a word as well. Sizes follow the
font, so that a 4K screen with a larger font is a larger panel and not a finer one.
"""
from python_qt_binding.QtCore import QPointF, QRectF, Qt
from python_qt_binding.QtGui import (
    QColor, QFont, QFontDatabase, QFontMetrics, QPainterPath, QPalette, QPen, QPolygonF)
from python_qt_binding.QtWidgets import QApplication, QPushButton

from mhri.base import battery, views

LIVE = 'live'
ATTENTION = 'attention'
STOP = 'stop'
DRIVE = 'drive'
TASK = 'task'
MUTED = 'muted'
TEXT = 'text'

# Three of them are darker on a light ground: a sign has a contrast of 3 there, too.
_LIGHT = {LIVE: '#00855F', ATTENTION: '#A86E00', STOP: '#C65300', DRIVE: '#0072B2',
          TASK: '#A0527D'}
_DARK = {LIVE: '#10B083', ATTENTION: '#E69F00', STOP: '#E8702A', DRIVE: '#56B4E9',
         TASK: '#CC79A7'}
# The ground of the stop button, in every theme: white on it has a contrast of 4.5 at least.
STOP_GROUND = QColor('#C35200')

# The looks to choose from, and how they are called.
DARK, LIGHT, CONTRAST, SYSTEM = 'dark', 'light', 'contrast', 'system'
THEMES = {DARK: 'Dark', LIGHT: 'Light', CONTRAST: 'High contrast', SYSTEM: 'As the desktop'}
# Window, field, button, words.
_GROUNDS = {DARK: ('#22262b', '#16191d', '#353b43', '#eceef0'),
            LIGHT: ('#f0f1f2', '#ffffff', '#e2e4e7', '#14171a'),
            CONTRAST: ('#000000', '#000000', '#1c1c1c', '#ffffff')}

DISC = 'disc'
RING = 'ring'
TRIANGLE = 'triangle'
CROSSED_SQUARE = 'crossed_square'
OCTAGON = 'octagon'
TICK = 'tick'
DIAMOND = 'diamond'

# What each state looks like: shape and colour.
LINK_SIGNS = {
    views.WAITING: (RING, MUTED),
    views.LIVE: (DISC, LIVE),
    views.SILENT: (TRIANGLE, ATTENTION),
    views.GONE: (CROSSED_SQUARE, STOP),
}
PROOF_SIGNS = {
    views.PROOF_WAITING: (RING, MUTED),
    views.PROOF_STOPPED: (TICK, LIVE),
    views.PROOF_NOT_CONFIRMED: (OCTAGON, STOP),
}
# A robot on a task, and one whose task waits.
ON_TASK, TASK_WAITS = (DIAMOND, TASK), (TRIANGLE, ATTENTION)
BATTERY_TONES = {battery.FINE: TEXT, battery.LOW: ATTENTION, battery.FLAT: STOP}

# Where an application keeps the desktop's own palette.
_DESKTOPS = 'mhri_palette_of_the_desktop'

# What is beside a picture, and between pictures, in every theme.
PICTURE_GROUND = QColor('#0c0e12')
# What lies under words on a picture, in every theme.
OVER_PICTURE = QColor(12, 14, 18, 205)

SMALLEST_TEXT_PT = 11.0
SMALLEST_TOUCH_PX = 36


def palette_of(name):
    """Return the :class:`QPalette` of a theme; of SYSTEM an empty one, which is the desktop's."""
    if name not in _GROUNDS:
        return QPalette()
    window, field, button, words = map(QColor, _GROUNDS[name])
    accent = QColor((_LIGHT if name == LIGHT else _DARK)[DRIVE])
    result = QPalette(button, window)
    for role, value in (
            (QPalette.Base, field), (QPalette.AlternateBase, window), (QPalette.ToolTipBase, field),
            (QPalette.WindowText, words), (QPalette.Text, words), (QPalette.ButtonText, words),
            (QPalette.ToolTipText, words), (QPalette.BrightText, words),
            (QPalette.PlaceholderText, blend(words, field, 0.34)),
            (QPalette.Link, accent), (QPalette.Highlight, accent),
            (QPalette.HighlightedText, readable_on(accent))):
        result.setColor(role, value)
    for role in (QPalette.WindowText, QPalette.Text, QPalette.ButtonText):
        result.setColor(QPalette.Disabled, role, blend(words, window, 0.45))
    return result


def apply(target, name):
    """Give an application, or a widget and all in it, the look of a theme.

    :param target: :class:`QApplication` or :class:`QWidget`
    :param name: DARK, LIGHT, CONTRAST or SYSTEM
    """
    palette = palette_of(name)
    if isinstance(target, QApplication):
        if target.property(_DESKTOPS) is None:
            target.setProperty(_DESKTOPS, target.palette())
        if name == SYSTEM:
            palette = target.property(_DESKTOPS)
    target.setPalette(palette)


def is_dark(palette):
    """Tell whether a palette is a dark one."""
    return palette.color(QPalette.Window).lightness() < 128


def over_picture(palette):
    """Return a palette for what is written on a picture: light on dark, whatever the theme."""
    result = QPalette(palette)
    for role, value in ((QPalette.Window, '#0c0e12'), (QPalette.Base, '#0c0e12'),
                        (QPalette.WindowText, '#f4f4f4'), (QPalette.Text, '#f4f4f4'),
                        (QPalette.Button, '#2b3036'), (QPalette.ButtonText, '#f4f4f4')):
        result.setColor(role, QColor(value))
    return result


def colour(name, palette):
    """Return the :class:`QColor` of LIVE, ATTENTION, ..., MUTED or TEXT on a palette."""
    if name == TEXT:
        return palette.color(QPalette.WindowText)
    if name == MUTED:
        return blend(palette.color(QPalette.WindowText), palette.color(QPalette.Window), 0.34)
    return QColor((_DARK if is_dark(palette) else _LIGHT)[name])


def blend(one, other, share):
    """Return a colour between two: ``share`` 0 is the one, 1 the other."""
    return QColor.fromRgbF(*[a + (b - a) * share for a, b in zip(
        one.getRgbF()[:3], other.getRgbF()[:3])])


def luminance(one):
    """Return the relative luminance of a :class:`QColor` in [0, 1] (WCAG 2.1)."""
    parts = [part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4
             for part in one.getRgbF()[:3]]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


def contrast(one, other):
    """Return the contrast of two colours, from 1 to 21 (WCAG 2.1)."""
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def readable_on(ground):
    """Return black or white, whichever is easier to read on a colour."""
    return max(QColor(Qt.black), QColor(Qt.white), key=lambda ink: contrast(ink, ground))


def line_colour(palette):
    """Return the colour of quiet outlines and dividers on a palette."""
    return blend(palette.color(QPalette.WindowText), palette.color(QPalette.Window), 0.70)


def base_font(font):
    """Return the font for ordinary text: the desktop's, but never below 11 points."""
    result = QFont(font)
    if 0.0 < font.pointSizeF() < SMALLEST_TEXT_PT:
        result.setPointSizeF(SMALLEST_TEXT_PT)
    return result


def larger(font, factor, bold=False):
    """Return a font scaled by a factor."""
    result = QFont(font)
    if font.pointSizeF() > 0.0:
        result.setPointSizeF(font.pointSizeF() * factor)
    else:
        result.setPixelSize(round(font.pixelSize() * factor))
    result.setBold(bold)
    return result


def number_font(font):
    """Return a font whose digits all have the same width, so that numbers do not jitter."""
    metrics = QFontMetrics(font)
    if len({metrics.horizontalAdvance(digit) for digit in '0123456789'}) == 1:
        return QFont(font)
    fixed = QFontDatabase.systemFont(QFontDatabase.FixedFont)
    fixed.setPointSizeF(font.pointSizeF())
    fixed.setBold(font.bold())
    return fixed


def touch_size(widget):
    """Return the least width and height [px] of what a finger has to hit."""
    return max(SMALLEST_TOUCH_PX, 2 * widget.fontMetrics().height())


def text_width(font, *samples):
    """Return the width [px] that the widest of the samples needs."""
    metrics = QFontMetrics(font)
    return max(metrics.horizontalAdvance(sample) for sample in samples) + 2


def finger_button(parent, name, text, tip='', also=''):
    """Return a button for fingers; Tab comes to it, but a click takes the keyboard from nothing.

    :param also: what else it will say; it is wide enough for that, too
    """
    button, touch = QPushButton(text, parent), touch_size(parent)
    button.setObjectName(name)
    button.setToolTip(tip)
    button.setFocusPolicy(Qt.TabFocus)
    button.setMinimumSize(text_width(button.font(), text, also) + touch, touch)
    return button


def fitting_text(metrics, texts, width):
    """Return the first of some texts that fits a width [px]; where none does, the last, cut off.

    :param metrics: :class:`QFontMetrics` of the font they are written in
    """
    for text in texts:
        if metrics.horizontalAdvance(text) <= width:
            return text
    return metrics.elidedText(texts[-1], Qt.ElideRight, int(width))


def paint_sign(painter, rect, shape, ink, ground):
    """Paint one of the state shapes.

    :param rect: :class:`QRectF`; the shape fills the square in its middle
    :param ink: :class:`QColor` of the shape
    :param ground: :class:`QColor` of what is cut out of it
    """
    side = min(rect.width(), rect.height())
    painter.save()
    painter.translate(rect.center())
    painter.scale(side / 20.0, side / 20.0)
    painter.setPen(Qt.NoPen)
    painter.setBrush(ink)
    _SHAPES[shape](painter, ink, ground)
    painter.restore()


def paint_battery(painter, rect, fraction, ink):
    """Paint an upright battery that is as full as it is charged.

    :param rect: :class:`QRectF` to fill
    :param fraction: its charge in [0, 1]
    :param ink: :class:`QColor`
    """
    cap = rect.height() / 7.0
    body = rect.adjusted(0.7, cap, -0.7, -0.7)
    painter.setPen(Qt.NoPen)
    painter.setBrush(ink)
    painter.drawRect(QRectF(rect.center().x() - rect.width() / 5.0, rect.top(),
                            rect.width() / 2.5, cap))
    inside = body.adjusted(1.6, 1.6, -1.6, -1.6)
    inside.setTop(inside.bottom() - inside.height() * min(1.0, max(0.0, fraction)))
    painter.drawRect(inside)
    painter.setBrush(Qt.NoBrush)
    painter.setPen(QPen(ink, 1.4))
    painter.drawRoundedRect(body, 1.2, 1.2)


def paint_edge(painter, rect, width, ink, dashed=False):
    """Paint a frame along the inside of a :class:`QRect`, of a width [px]; dashed for a keyboard.

    What the dashes leave is dark.
    """
    half = width / 2.0
    strokes = [(PICTURE_GROUND, Qt.SolidLine), (ink, Qt.DashLine)] if dashed \
        else [(ink, Qt.SolidLine)]
    for colour_, line in strokes:
        painter.setPen(QPen(colour_, width, line, Qt.FlatCap, Qt.MiterJoin))
        painter.drawRect(QRectF(rect).adjusted(half, half, -half, -half))


def paint_stopped_frame(painter, rect, palette):
    """Paint the ground of whatever says that everything is stopped.

    :param rect: :class:`QRect` to fill
    """
    ink = colour(STOP, palette)
    painter.setPen(QPen(ink, 4))
    painter.setBrush(blend(palette.color(QPalette.Window), ink, 0.16))
    painter.drawRoundedRect(QRectF(rect).adjusted(2, 2, -2, -2), 6, 6)


def _stroke(colour_, width):
    """Return a round pen."""
    return QPen(colour_, width, Qt.SolidLine, Qt.RoundCap, Qt.RoundJoin)


def _disc(painter, ink, ground):
    painter.drawEllipse(QPointF(0, 0), 8, 8)


def _ring(painter, ink, ground):
    painter.setBrush(Qt.NoBrush)
    painter.setPen(QPen(ink, 2.5))
    painter.drawEllipse(QPointF(0, 0), 7, 7)


def _exclamation(painter, ground, top, bottom):
    painter.setPen(_stroke(ground, 2.4))
    painter.drawLine(QPointF(0, top), QPointF(0, bottom - 4.6))
    painter.drawPoint(QPointF(0, bottom))


def _triangle(painter, ink, ground):
    painter.setPen(_stroke(ink, 2))
    painter.drawPolygon(QPolygonF([QPointF(0, -8), QPointF(8.6, 7.4), QPointF(-8.6, 7.4)]))
    _exclamation(painter, ground, -3.4, 5.0)


def _crossed_square(painter, ink, ground):
    painter.setBrush(Qt.NoBrush)
    painter.setPen(_stroke(ink, 2.4))
    painter.drawRect(QRectF(-7.5, -7.5, 15, 15))
    painter.drawLine(QPointF(-3.6, -3.6), QPointF(3.6, 3.6))
    painter.drawLine(QPointF(-3.6, 3.6), QPointF(3.6, -3.6))


def _octagon(painter, ink, ground):
    near, far = 3.7, 9.0
    painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in (
        (-near, -far), (near, -far), (far, -near), (far, near),
        (near, far), (-near, far), (-far, near), (-far, -near))]))
    _exclamation(painter, ground, -4.6, 4.8)


def _tick(painter, ink, ground):
    path = QPainterPath(QPointF(-7, 0.5))
    path.lineTo(-2.4, 5.4)
    path.lineTo(7, -5.6)
    painter.setBrush(Qt.NoBrush)
    painter.setPen(_stroke(ink, 3.4))
    painter.drawPath(path)


def _diamond(painter, ink, ground):
    painter.drawPolygon(QPolygonF([QPointF(0, -9), QPointF(9, 0), QPointF(0, 9), QPointF(-9, 0)]))


_SHAPES = {DISC: _disc, RING: _ring, TRIANGLE: _triangle, CROSSED_SQUARE: _crossed_square,
           OCTAGON: _octagon, TICK: _tick, DIAMOND: _diamond}
