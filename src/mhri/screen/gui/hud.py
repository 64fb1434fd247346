# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers over the picture: speed, turn rate, heading; and a sentence on why the robot stands."""
from python_qt_binding.QtCore import QPointF, QRectF, Qt
from python_qt_binding.QtGui import QColor, QFontMetrics, QPainter, QPixmap
from python_qt_binding.QtWidgets import QWidget

from mhri.accessories.controls import looks_words
from mhri.base import views
from mhri.base.gui import theme, words
from mhri.base.gui.painting import edged_words
from mhri.screen.asked import asked_line

_EDGE, _EDGE_INK = 0.22, QColor(0, 0, 0, 230)
# Font sizes of numbers and sentence; the first that fits is used, as a large tile may be narrow.
_SIZES = theme.TITLE, theme.BODY
# Left margin of the numbers in a large and in a small tile [line heights], on the grid.
_LEFT_UNITS = 0.7, 0.3
# Height of a sentence [line heights].
_SENTENCE_UNITS = 1.5
_DIM = QColor(190, 190, 190)
# Margin below the numbers [line heights], on the grid.
_FOOT_UNITS = 0.6
# Margin around a line for its edge.
_BESIDE_PX = 8


def hud_lines(view):
    """Return the lines of text at the lower left.

    :param view: :class:`mhri.base.views.RobotView`
    """
    if view.linear_mps is None and view.angular_rad_s is None:
        return []
    figures = *words.motion_texts(view, both=True), asked_line(view)
    return [words.BETWEEN_FIGURES.join(filter(None, figures)),
            words.BETWEEN_FIGURES.join(filter(None, (
                'heading {}'.format(words.compass_text(view.heading_rad)),
                looks_words(view.accessories))))]


def _wrapped(line, metrics, width):
    """Return a line wrapped between words to a width [px]."""
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


def _holds(room, needed):
    """Return whether a rectangle is at least as large as another."""
    return needed.width() <= room.width() and needed.height() <= room.height()


class Hud(QWidget):
    """Text with a dark edge, readable on white and on black; clicks pass through to the picture.

    The text is rendered once per change, not with each picture below it.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        #: the displayed lines
        self.lines = ()
        self._extra = ()
        #: the displayed sentence, '' if none
        self.sentence = ''
        self._shorter = ()
        #: (shape, colour name) before the sentence, or None
        self.sign = None
        self._old = False
        self._large = True
        self._shown = True
        #: width at the right end that is kept free [px]
        self.clear_px = 0
        self._strip_px = 0
        self._numbers_px = 0
        self._picture = None
        self._build()

    def _build(self):
        """Pass clicks through."""
        self.setObjectName('hud')
        self.setAttribute(Qt.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.NoFocus)
        self.setPalette(theme.over_picture(self.palette()))

    def show_large(self, large):
        """Choose large or small text."""
        self._large = large
        self._renew()

    def show_numbers(self, shown):
        """Show or hide the numbers; the sentence stays."""
        if shown != self._shown:
            self._numbers_px = 0
        self._show(_shown=shown)

    def keep_clear(self, width):
        """Keep a width [px] at the right end free."""
        self._show(clear_px=width)

    def show_strip(self, height):
        """Keep a strip of this height [px] free between the numbers and the sentence."""
        self._show(_strip_px=height)

    def numbers_height(self):
        """Return the height of the numbers with their margin [px].

        It grows with them, and shrinks only with the widget or its font, so that what lies above
        does not move to and fro.
        """
        font, lines = self._fitting()
        self._numbers_px = max(self._numbers_px, round(
            len(lines) * QFontMetrics(font).height()
            + theme.on_grid(_FOOT_UNITS * self.fontMetrics().height())))
        return self._numbers_px

    def set_extra(self, lines):
        """Set extra lines below the numbers, such as clearance and task, for the next view.

        An empty line keeps its place, so that nothing moves.
        """
        self._extra = tuple(lines)

    def show_view(self, view):
        """Show the numbers of a :class:`RobotView`, and the extra lines."""
        self._show(lines=(*hud_lines(view), *self._extra), _old=view.link != views.LIVE)

    def show_sentence(self, text, sign=None, shorter=()):
        """Show why the robot stands, or its problem; '' clears it.

        :param shorter: alternatives if not even the beginning of the text fits
        """
        self._show(sentence=text, sign=sign, _shorter=tuple(shorter))

    def _show(self, **changes):
        """Discard the cached picture if anything changes."""
        changed = False
        for name, value in changes.items():
            changed |= getattr(self, name) != value
            setattr(self, name, value)
        if changed:
            self._renew()

    def _renew(self):
        """Repaint with the next paint event."""
        self._picture = None
        self.update()

    def resizeEvent(self, event):  # noqa: N802
        """Fit the new size."""
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self._numbers_px = 0
        self._renew()

    def changeEvent(self, event):  # noqa: N802
        """Apply a new font."""
        super().changeEvent(event)
        self._numbers_px = 0
        self._renew()

    def paintEvent(self, event):  # noqa: N802
        """Paint the text."""
        if self._picture is None:
            self._picture = self._paint_words()
        QPainter(self).drawPixmap(0, 0, self._picture)

    def _paint_words(self):
        """Return the text as a transparent picture."""
        ratio = self.devicePixelRatioF()
        picture = QPixmap(self.size() * ratio)
        picture.setDevicePixelRatio(ratio)
        picture.fill(Qt.transparent)
        painter = theme.smooth_painter(picture)
        unit = self.fontMetrics().height()
        y = self.height() - theme.on_grid(_FOOT_UNITS * unit)
        font, lines = self._fitting()
        # The first lines have priority, then the sentence, then the last lines.
        room = y - self._strip_px - (_SENTENCE_UNITS * unit if self.sentence else 0.0)
        lines = lines[:max(0, int(room / QFontMetrics(font).height()))]
        ink = _DIM if self._old else QColor(Qt.white)
        for line in reversed(lines):
            written = edged_words(line, font.toString(), ink.rgba(), _EDGE_INK.rgba(),
                                  _EDGE * QFontMetrics(font).height(), _BESIDE_PX, ratio)
            y -= written.height() / ratio - 2 * _BESIDE_PX
            left = theme.on_grid(_LEFT_UNITS[not self._large] * unit)
            painter.drawImage(QPointF(left - _BESIDE_PX, y - _BESIDE_PX), written)
        if self.sentence:
            if self._strip_px:
                y = min(y, self.height() - self._numbers_px - self._strip_px)
            self._paint_sentence(painter, y - theme.on_grid(0.2 * unit))
        painter.end()
        return picture

    def _fitting(self):
        """Return (font, lines) that fit the width; a small tile has a single line."""
        width = self.width() - self.clear_px - 1.4 * self.fontMetrics().height()
        for size in _SIZES if self._large else _SIZES[-1:]:
            font = theme.number_font(theme.larger(self.font(), size, bold=True))
            metrics, lines = QFontMetrics(font), []
            for line in self.lines if self._shown else ():
                if metrics.horizontalAdvance(line) <= width:
                    lines.append(line)
                else:
                    lines += line.split(words.BETWEEN_FIGURES)
            if all(metrics.horizontalAdvance(line) <= width for line in lines):
                break
        if self._large:
            return font, [part for line in lines for part in _wrapped(
                words.kept_together(line), metrics, width)]
        # Without room for "turning left" it says "turning"; no number is cut off.
        texts = [lines[0], *words.motion_shorter(lines[0])] if lines else []
        return font, [text for text in texts if metrics.horizontalAdvance(text) <= width][:1]

    def _paint_sentence(self, painter, foot):
        """Paint the sentence and its sign on a dark background, above the lines."""
        unit, flags = self.fontMetrics().height(), int(
            Qt.AlignLeft | Qt.AlignBottom | Qt.TextWordWrap)
        beside, above = theme.on_grid(0.4 * unit), theme.on_grid(0.2 * unit)
        for size in _SIZES if self._large else _SIZES[-1:]:
            painter.setFont(theme.larger(self.font(), size, bold=self._large))
            metrics = painter.fontMetrics()
            side = metrics.height() if self.sign else 0
            left = 0.6 * unit + 1.3 * side
            room = QRectF(left, 0, max(unit, self.width() - self.clear_px - left - unit),
                          max(unit, foot))
            texts = [words.kept_together(text) for text in (
                self.sentence, *words.beginnings(self.sentence), *self._shorter,
                *words.beginnings(self.sentence, (), most=4))]
            text = next((text for text in texts if _holds(
                room, painter.boundingRect(room, flags, text))), '')
            if text == texts[0]:
                break
        # From the painter, because metrics in whole pixels may wrap differently.
        needed = painter.boundingRect(room, flags, text) if text else QRectF(
            left, foot - metrics.height(), 0.0, metrics.height())
        ground = QRectF(beside, needed.top() - above, needed.right(), needed.height() + 2 * above)
        theme.set_ink(painter, brush=theme.OVER_PICTURE)
        painter.drawRoundedRect(ground, theme.GRID, theme.GRID)
        if self.sign:
            shape, colour = self.sign
            theme.paint_sign(painter, QRectF(ground.left() + above, needed.top(), side, side),
                             shape, theme.colour(colour, self.palette()), QColor(Qt.black))
        painter.setPen(Qt.white)
        painter.drawText(room, flags, text)
