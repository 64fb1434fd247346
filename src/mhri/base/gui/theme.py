# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Colours, shapes, fonts and sizes: one look for every widget, in light and in dark.

The colours are those of Okabe and Ito, which people with any kind of colour vision can distinguish;
and colour is never the only sign: each state has a shape and a word as well. Sizes follow the font,
so that a 4K screen with a larger font shows a larger panel.
"""
from python_qt_binding.QtCore import QPointF, QRectF, Qt
from python_qt_binding.QtGui import (
    QColor, QFont, QFontDatabase, QFontMetrics, QPainter, QPainterPath, QPalette, QPen,
    QPolygonF)
from python_qt_binding.QtWidgets import QApplication

from mhri.base import battery, views

LIVE = 'live'
ATTENTION = 'attention'
STOP = 'stop'
DRIVE = 'drive'
TASK = 'task'
MUTED = 'muted'
TEXT = 'text'

# Three of them are darker on a light background, to keep a contrast of 3 for signs.
_LIGHT = {LIVE: '#00855F', ATTENTION: '#A86E00', STOP: '#C65300', DRIVE: '#0072B2',
          TASK: '#A0527D'}
_DARK = {LIVE: '#10B083', ATTENTION: '#E69F00', STOP: '#E8702A', DRIVE: '#56B4E9',
         TASK: '#CC79A7'}
# The background of the stop button, in every theme: white on it has a contrast of at least 4.5.
STOP_GROUND = QColor('#C35200')

# The available themes and their labels.
DARK, LIGHT, CONTRAST, SYSTEM = 'dark', 'light', 'contrast', 'system'
THEMES = {DARK: 'Dark', LIGHT: 'Light', CONTRAST: 'High contrast', SYSTEM: 'As the desktop'}
# Window, field, button, text.
_GROUNDS = {DARK: ('#22262b', '#16191d', '#353b43', '#eceef0'),
            LIGHT: ('#f0f1f2', '#ffffff', '#e2e4e7', '#14171a'),
            CONTRAST: ('#000000', '#000000', '#1c1c1c', '#ffffff')}

DISC = 'disc'
RING = 'ring'
TRIANGLE = 'triangle'
CROSSED_SQUARE = 'crossed_square'
OCTAGON = 'octagon'
STOP_SIGN = 'stop_sign'
TICK = 'tick'
DIAMOND = 'diamond'

# Shape and colour of each state.
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
# A warning; a robot on a task, and one whose task waits.
WARNING = (TRIANGLE, ATTENTION)
ON_TASK, TASK_WAITS = (DIAMOND, TASK), WARNING
BATTERY_TONES = {battery.FINE: TEXT, battery.LOW: ATTENTION, battery.FLAT: STOP}

# Property of an application that keeps the desktop's own palette.
_DESKTOPS = 'mhri_palette_of_the_desktop'

# The background beside and between pictures, in every theme.
PICTURE_GROUND = QColor('#0c0e12')
# The background of text on a picture, in every theme.
OVER_PICTURE = QColor(12, 14, 18, 205)

# The size of text, as a factor: see :mod:`mhri.base.gui.text_size`.
text_scale = [1.0]

SMALLEST_TEXT_PT = 11.0
SMALLEST_TOUCH_PX = 36
# All distances are multiples of this [px]; corners have this radius.
GRID = 4
# The type scale, as factors of ordinary text: the word of a pill; ordinary text; numbers and
# headings; names; the state of the whole screen.
SMALL, BODY, HEAD, TITLE, LARGE, HUGE = 0.92, 1.0, 1.15, 1.3, 1.5, 2.0


def palette_of(name):
    """Return the :class:`QPalette` of a theme; for SYSTEM an empty one, i.e. the desktop's."""
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
    """Apply a theme to an application, or to a widget and its children.

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
    """Return whether a palette is dark."""
    return palette.color(QPalette.Window).lightness() < 128


def over_picture(palette):
    """Return a palette for text on a picture: light on dark in every theme."""
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
    """Return a blend of two colours: ``share`` 0 is the first, 1 the second."""
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


def hover_colour(palette):
    """Return the background of a flat control below the pointer."""
    return blend(palette.color(QPalette.Window), palette.color(QPalette.WindowText), 0.10)


def edge_colour(palette):
    """Return the colour of the edge of a control; strong where the ground is black."""
    window, text = palette.color(QPalette.Window), palette.color(QPalette.WindowText)
    return blend(text, window, 0.35 if not window.lightness() else 0.62)


def base_font(font):
    """Return the font for ordinary text: the desktop's, but at least 11 points, times the scale.

    :param font: for its family and style
    """
    result, desktop = QFont(font), QApplication.font()
    if desktop.pointSizeF() > 0.0:
        result.setPointSizeF(max(desktop.pointSizeF(), SMALLEST_TEXT_PT) * text_scale[0])
    elif desktop.pixelSize() > 0:
        result.setPixelSize(round(desktop.pixelSize() * text_scale[0]))
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


def on_grid(length):
    """Return a distance [px] as the nearest multiple of :data:`GRID`, at least one."""
    return GRID * max(1, round(length / GRID))


def touch_size(widget):
    """Return the minimum width and height of a touch target [px]."""
    return max(SMALLEST_TOUCH_PX, 2 * widget.fontMetrics().height())


def text_width(font, *samples):
    """Return the width of the widest sample [px]."""
    metrics = QFontMetrics(font)
    return max(metrics.horizontalAdvance(sample) for sample in samples) + 2


def for_fingers(part, name='', spoken='', tip=''):
    """Make a widget high enough for touch, and return it.

    It gets the focus by Tab, but not by a click.

    :param spoken: its accessible name
    """
    part.setObjectName(name)
    part.setAccessibleName(spoken)
    part.setToolTip(tip)
    part.setFocusPolicy(Qt.TabFocus)
    part.setMinimumHeight(touch_size(part))
    return part


def finger_button(parent, name, text, tip='', also='', room=1.0):
    """Return a button for touch with a margin beside its text.

    :param also: another text of the button, for which it is wide enough, too
    :param room: margin beside its text, as a fraction of the touch size
    """
    # Imported here, because controls are painted in the colours of this module.
    from mhri.base.gui.controls import Button
    button = for_fingers(Button(text, parent), name, tip=tip)
    touch = touch_size(parent)
    button.setMinimumWidth(max(touch, text_width(button.font(), text, also) + int(room * touch)))
    return button


def fitting_text(metrics, texts, width):
    """Return the first of some texts that fits a width [px]; if none does, the last, cut off.

    :param metrics: :class:`QFontMetrics` of the font they are written in
    """
    for text in texts:
        if metrics.horizontalAdvance(text) <= width:
            return text
    return metrics.elidedText(texts[-1], Qt.ElideRight, int(width))


def smooth_painter(widget):
    """Return an antialiased painter on a widget."""
    painter = QPainter(widget)
    painter.setRenderHint(QPainter.Antialiasing)
    return painter


def set_ink(painter, pen=Qt.NoPen, brush=Qt.NoBrush):
    """Set the pen and the brush of a painter; by default none."""
    painter.setPen(pen)
    painter.setBrush(brush)


def paint_sign(painter, rect, shape, ink, ground):
    """Paint one of the state shapes.

    :param rect: :class:`QRectF`; the shape fills the square in its centre
    :param ink: :class:`QColor` of the shape
    :param ground: :class:`QColor` of its cut-outs
    """
    side = min(rect.width(), rect.height())
    painter.save()
    painter.translate(rect.center())
    painter.scale(side / 20.0, side / 20.0)
    set_ink(painter, brush=ink)
    _SHAPES[shape](painter, ink, ground)
    painter.restore()


def paint_battery(painter, rect, fraction, ink):
    """Paint an upright battery filled to its charge.

    :param rect: :class:`QRectF` to fill
    :param fraction: its charge in [0, 1]
    :param ink: :class:`QColor`
    """
    cap = rect.height() / 7.0
    body = rect.adjusted(0.7, cap, -0.7, -0.7)
    set_ink(painter, brush=ink)
    painter.drawRect(QRectF(rect.center().x() - rect.width() / 5.0, rect.top(),
                            rect.width() / 2.5, cap))
    inside = body.adjusted(1.6, 1.6, -1.6, -1.6)
    inside.setTop(inside.bottom() - inside.height() * min(1.0, max(0.0, fraction)))
    painter.drawRect(inside)
    set_ink(painter, QPen(ink, 1.4))
    painter.drawRoundedRect(body, 1.2, 1.2)


def paint_edge(painter, rect, width, ink, dashed=False):
    """Paint a frame along the inside of a :class:`QRect`, dashed to show the keyboard focus.

    The gaps between the dashes are dark.

    :param width: width of the frame [px]
    """
    half = width / 2.0
    strokes = [(PICTURE_GROUND, Qt.SolidLine), (ink, Qt.DashLine)] if dashed \
        else [(ink, Qt.SolidLine)]
    for colour_, line in strokes:
        painter.setPen(QPen(colour_, width, line, Qt.FlatCap, Qt.MiterJoin))
        painter.drawRect(QRectF(rect).adjusted(half, half, -half, -half))


def paint_box(painter, rect, ground, edge=None, width=1.0):
    """Paint a rectangle with round corners.

    :param rect: :class:`QRectF` to fill
    :param ground: :class:`QColor` inside
    :param edge: :class:`QColor` of the edge, None for no edge
    :param width: of the edge [px]
    """
    painter.save()
    painter.setRenderHint(QPainter.Antialiasing)
    set_ink(painter, Qt.NoPen if edge is None else QPen(edge, width), ground)
    half = width / 2.0
    painter.drawRoundedRect(rect.adjusted(half, half, -half, -half), GRID, GRID)
    painter.restore()


def paint_focus(painter, rect, palette):
    """Paint the frame of the keyboard focus inside a :class:`QRect`, in the accent colour."""
    painter.save()
    painter.setRenderHint(QPainter.Antialiasing)
    set_ink(painter, QPen(colour(DRIVE, palette), 2))
    painter.drawRoundedRect(QRectF(rect).adjusted(1, 1, -1, -1), GRID, GRID)
    painter.restore()


def paint_stopped_frame(painter, rect, palette):
    """Paint the background of the stopped state.

    :param rect: :class:`QRect` to fill
    """
    ink = colour(STOP, palette)
    set_ink(painter, QPen(ink, 4), blend(palette.color(QPalette.Window), ink, 0.16))
    painter.drawRoundedRect(QRectF(rect).adjusted(2, 2, -2, -2), 6, 6)


def _stroke(colour_, width):
    """Return a pen with round caps and joins."""
    return QPen(colour_, width, Qt.SolidLine, Qt.RoundCap, Qt.RoundJoin)


def _disc(painter, ink, ground):
    painter.drawEllipse(QPointF(0, 0), 8, 8)


def _ring(painter, ink, ground):
    set_ink(painter, QPen(ink, 2.5))
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
    set_ink(painter, _stroke(ink, 2.4))
    painter.drawRect(QRectF(-7.5, -7.5, 15, 15))
    painter.drawLine(QPointF(-3.6, -3.6), QPointF(3.6, 3.6))
    painter.drawLine(QPointF(-3.6, 3.6), QPointF(3.6, -3.6))


def _draw_octagon(painter):
    near, far = 3.7, 9.0
    painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in (
        (-near, -far), (near, -far), (far, -near), (far, near),
        (near, far), (-near, far), (-far, near), (-far, -near))]))


def _octagon(painter, ink, ground):
    _draw_octagon(painter)
    _exclamation(painter, ground, -4.6, 4.8)


def _stop_sign(painter, ink, ground):
    set_ink(painter, _stroke(ink, 2.2))
    _draw_octagon(painter)
    set_ink(painter, brush=ink)
    painter.drawRect(QRectF(-4.0, -4.0, 8.0, 8.0))


def _tick(painter, ink, ground):
    path = QPainterPath(QPointF(-7, 0.5))
    path.lineTo(-2.4, 5.4)
    path.lineTo(7, -5.6)
    set_ink(painter, _stroke(ink, 3.4))
    painter.drawPath(path)


def _diamond(painter, ink, ground):
    painter.drawPolygon(QPolygonF([QPointF(0, -9), QPointF(9, 0), QPointF(0, 9), QPointF(-9, 0)]))


_SHAPES = {DISC: _disc, RING: _ring, TRIANGLE: _triangle, CROSSED_SQUARE: _crossed_square,
           OCTAGON: _octagon, STOP_SIGN: _stop_sign, TICK: _tick, DIAMOND: _diamond}
