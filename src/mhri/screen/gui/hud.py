# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers over the picture: speed, turn, heading; and in one sentence why the robot stands."""
from python_qt_binding.QtCore import QPointF, QRectF, QSize, Qt
from python_qt_binding.QtGui import (
    QColor, QFontMetrics, QImage, QPainter, QPainterPath, QPen, QPixmap)
from python_qt_binding.QtWidgets import QWidget

from mhri.base import views
from mhri.base.gui import theme, words
from mhri.screen.asked import asked_line

_EDGE = 0.22
# Sizes of the numbers and of the sentence, the one that fits: a large tile may be narrow.
_NUMBER_SIZES, _SENTENCE_SIZES = (1.35, 1.0), (1.25, 1.0)
# Height that a sentence needs, in heights of a line.
_SENTENCE_UNITS = 1.5
_DIM = QColor(190, 190, 190)
# Room around a line for its edge; and the lines that are kept: {what they are: picture}.
_BESIDE_PX = 8
_WRITTEN, _MOST_WRITTEN = {}, 100


def hud_lines(view):
    """Return what is written at the lower left, as a list of lines.

    :param view: :class:`mhri.base.views.RobotView`
    """
    if view.linear_mps is None and view.angular_rad_s is None:
        return []
    figures = (words.linear_text(view.linear_mps), words.turn_text(view.angular_rad_s),
               asked_line(view))
    return [words.BETWEEN_FIGURES.join(filter(None, figures)),
            'heading {}'.format(words.compass_text(view.heading_rad))]


def _wrapped(line, metrics, width):
    """Return a line in as many as it takes in a width [px], broken between words."""
    if metrics.horizontalAdvance(line) <= width:
        return [line]
    found = ['']
    for word in line.split(' '):
        longer = ' '.join(filter(None, (found[-1], word)))
        if found[-1] and metrics.horizontalAdvance(longer) > width:
            found.append(word)
        else:
            found[-1] = longer
    return found


def _written(text, font, ink, ratio):
    """Return a line with a dark edge as a :class:`QImage`, the newest kept: an edge is dear.

    :param ratio: pixels of the image for one of the screen's
    """
    key = text, font.key(), ink.rgba(), ratio
    image = _WRITTEN.pop(key, None)
    if image is None:
        image = _write(text, font, ink, ratio)
        while len(_WRITTEN) >= _MOST_WRITTEN:
            del _WRITTEN[next(iter(_WRITTEN))]
    _WRITTEN[key] = image
    return image


def _write(text, font, ink, ratio):
    metrics = QFontMetrics(font)
    size = QSize(metrics.horizontalAdvance(text), metrics.height()) + QSize(
        2 * _BESIDE_PX, 2 * _BESIDE_PX)
    image = QImage(size * ratio, QImage.Format_ARGB32_Premultiplied)
    image.setDevicePixelRatio(ratio)
    image.fill(Qt.transparent)
    path = QPainterPath()
    path.addText(QPointF(_BESIDE_PX, _BESIDE_PX + metrics.ascent()), font, text)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.Antialiasing)
    painter.setPen(QPen(QColor(0, 0, 0, 230), _EDGE * metrics.height(), Qt.SolidLine,
                        Qt.RoundCap, Qt.RoundJoin))
    painter.drawPath(path)
    painter.fillPath(path, ink)
    painter.end()
    return image


def _holds(room, needed):
    """Tell whether a room is as wide and high as it needs to be."""
    return needed.width() <= room.width() and needed.height() <= room.height()


class Hud(QWidget):
    """Words with a dark edge, readable on white and on black; clicks go through to the picture.

    They are painted once for each change, not with each picture beneath.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._lines = ()
        self._extra = ()
        self._sentence = ''
        self._shorter = ()
        self._sign = None
        self._old = False
        self._large = True
        self._shown = True
        self._clear_px = 0
        self._picture = None
        self._build()

    def _build(self):
        """Let clicks through."""
        self.setObjectName('hud')
        self.setAttribute(Qt.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.NoFocus)
        self.setPalette(theme.over_picture(self.palette()))

    @property
    def lines(self):
        """The lines on show."""
        return self._lines

    @property
    def sign(self):
        """(shape, colour name) before the sentence, or None."""
        return self._sign

    @property
    def sentence(self):
        """The sentence on show, '' for none."""
        return self._sentence

    def show_large(self, large):
        """Write large, or small."""
        self._large = large
        self._renew()

    def show_numbers(self, shown):
        """Show the numbers, or the sentence alone."""
        self._show(shown=shown)

    def keep_clear(self, width):
        """Leave so much of the right end [px] to something else."""
        self._show(clear_px=width)

    def set_extra(self, lines):
        """Have further lines below the numbers when these are shown next: nearest thing, task.

        An empty one keeps its place, so that nothing jumps.
        """
        self._extra = tuple(lines)

    def show_view(self, view):
        """Show the numbers of a :class:`RobotView`, and the further lines."""
        self._show(lines=(*hud_lines(view), *self._extra), old=view.link != views.LIVE)

    def show_sentence(self, text, sign=None, shorter=()):
        """Say why the robot stands, or what is wrong; '' for nothing.

        :param shorter: what to say where not even the beginning of the text has room
        """
        self._show(sentence=text, sign=sign, shorter=tuple(shorter))

    def _show(self, **changes):
        """Renew the picture where anything changes."""
        changed = False
        for name, value in changes.items():
            name = '_' + name
            changed |= getattr(self, name) != value
            setattr(self, name, value)
        if changed:
            self._renew()

    def _renew(self):
        """Paint anew at the next occasion."""
        self._picture = None
        self.update()

    def resizeEvent(self, event):  # noqa: N802
        """Fit the width."""
        super().resizeEvent(event)
        self._renew()

    def changeEvent(self, event):  # noqa: N802
        """Follow the font."""
        super().changeEvent(event)
        self._renew()

    def paintEvent(self, event):  # noqa: N802
        """Paint the words."""
        if self._picture is None:
            self._picture = self._paint_words()
        QPainter(self).drawPixmap(0, 0, self._picture)

    def _paint_words(self):
        """Return the words as a picture that can be seen through."""
        ratio = self.devicePixelRatioF()
        picture = QPixmap(self.size() * ratio)
        picture.setDevicePixelRatio(ratio)
        picture.fill(Qt.transparent)
        painter = QPainter(picture)
        painter.setRenderHint(QPainter.Antialiasing)
        unit = self.fontMetrics().height()
        y = self.height() - 0.6 * unit
        font, lines = self._fitting(self.width() - self._clear_px - 1.4 * unit)
        if self._sentence:
            # It is worth more than the last numbers.
            room = y - _SENTENCE_UNITS * unit
            lines = lines[:max(0, int(room / QFontMetrics(font).height()))]
        ink = _DIM if self._old else QColor(Qt.white)
        for line in reversed(lines):
            written = _written(line, font, ink, ratio)
            y -= written.height() / ratio - 2 * _BESIDE_PX
            painter.drawImage(QPointF(0.7 * unit - _BESIDE_PX, y - _BESIDE_PX), written)
        if self._sentence:
            self._paint_sentence(painter, y - 0.2 * unit)
        painter.end()
        return picture

    def _fitting(self, width):
        """Return (font, lines) as they fit a width [px]; a small tile has one line alone."""
        for size in _NUMBER_SIZES if self._large else _NUMBER_SIZES[-1:]:
            font = theme.number_font(theme.larger(self.font(), size, bold=True))
            metrics, lines = QFontMetrics(font), []
            for line in self._lines if self._shown else ():
                if metrics.horizontalAdvance(line) <= width:
                    lines.append(line)
                else:
                    lines += line.split(words.BETWEEN_FIGURES)
            if all(metrics.horizontalAdvance(line) <= width for line in lines):
                break
        if self._large:
            return font, [part for line in lines for part in _wrapped(line, metrics, width)]
        return font, lines[:1]

    def _paint_sentence(self, painter, foot):
        """Paint the sentence on a dark ground, with its sign, over the lines."""
        unit, flags = self.fontMetrics().height(), int(
            Qt.AlignLeft | Qt.AlignBottom | Qt.TextWordWrap)
        for size in _SENTENCE_SIZES if self._large else _SENTENCE_SIZES[-1:]:
            painter.setFont(theme.larger(self.font(), size, bold=self._large))
            metrics = painter.fontMetrics()
            side = metrics.height() if self._sign else 0
            left = 0.6 * unit + 1.3 * side
            room = QRectF(left, 0, max(unit, self.width() - self._clear_px - left - unit),
                          max(unit, foot))
            texts = [words.kept_together(text) for text in (
                self._sentence, *words.beginnings(self._sentence), *self._shorter,
                *words.beginnings(self._sentence, (), most=4))]
            text = next((text for text in texts if _holds(
                room, painter.boundingRect(room, flags, text))), '')
            if text == texts[0]:
                break
        # As the painter breaks it: metrics of whole pixels may break it elsewhere.
        needed = painter.boundingRect(room, flags, text)
        ground = QRectF(0.4 * unit, needed.top() - 0.15 * unit,
                        needed.right() - 0.4 * unit + 0.5 * unit, needed.height() + 0.3 * unit)
        painter.setPen(Qt.NoPen)
        painter.setBrush(theme.OVER_PICTURE)
        painter.drawRoundedRect(ground, 4, 4)
        if self._sign:
            shape, colour = self._sign
            theme.paint_sign(painter, QRectF(ground.left() + 0.2 * unit, needed.top(), side, side),
                             shape, theme.colour(colour, self.palette()), QColor(Qt.black))
        painter.setPen(Qt.white)
        painter.drawText(room, flags, text)
