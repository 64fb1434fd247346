# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A live picture of a pad: a bar for each axis, a key for each button, and their meanings."""
from python_qt_binding.QtCore import QRectF, QSize, Qt
from python_qt_binding.QtGui import QPalette, QPen
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme

UNKNOWN = 'not moved yet'
_COLUMNS = 6


class PadPicture(QWidget):
    """Shows the state of a pad, display only.

    A bar grows from the middle of its axis to the right for positive values; an axis of unknown
    value is marked as such. A pressed button is filled.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._axes, self._buttons = (), ()
        self._axis_words, self._button_words = {}, {}
        # The first value of each axis counts as its rest: a released trigger is at its end.
        self._first = {}
        self._build()

    def _build(self):
        """Set up the widget."""
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self.setAccessibleName('State of the pad')

    def show_pad(self, axes, buttons, axis_words=(), button_words=()):
        """Show a state of the pad.

        :param axes: values in [-1, 1], None if not known yet
        :param buttons: 0 or 1
        :param axis_words: pairs (index, meaning), likewise ``button_words``
        """
        sizes = len(self._axes), len(self._buttons)
        if sizes[0] != len(axes):
            self._first = {}
        for index, value in enumerate(axes):
            if value is not None:
                self._first.setdefault(index, value)
        state = axes, buttons, dict(axis_words), dict(button_words)
        if state != (self._axes, self._buttons, self._axis_words, self._button_words):
            self._axes, self._buttons, self._axis_words, self._button_words = state
            self.setAccessibleDescription(self.seen())
            self.update()
        if sizes != (len(axes), len(buttons)):
            self.updateGeometry()

    def seen(self):
        """Return a description of the pushed axes and pressed buttons."""
        pushed = [str(index) for index, value in enumerate(self._axes)
                  if value is not None and abs(value - self._first[index]) > 0.5]
        pressed = [str(index) for index, value in enumerate(self._buttons) if value]
        return ', '.join('{} {}'.format(word, ' '.join(numbers)) for word, numbers in (
            ('axis', pushed), ('button', pressed)) if numbers)

    def words(self):
        """Return pairs ('axis 3' or 'button 6', its meaning)."""
        return [('{} {}'.format(kind, index), words) for kind, meanings in (
            ('axis', self._axis_words), ('button', self._button_words))
            for index, words in sorted(meanings.items())]

    def _row_px(self):
        return round(1.25 * self.fontMetrics().height())

    def _key_px(self):
        return round(2.6 * self.fontMetrics().height())

    def sizeHint(self):  # noqa: N802
        """Return the size of all axes and buttons."""
        rows = -(-len(self._buttons) // _COLUMNS)
        return QSize(round(16 * self.fontMetrics().height()),
                     len(self._axes) * self._row_px() + rows * self._key_px())

    def minimumSizeHint(self):  # noqa: N802
        """Return the minimum size: bars can be shorter, the height is fixed."""
        return QSize(round(12 * self.fontMetrics().height()), self.sizeHint().height())

    def paintEvent(self, event):  # noqa: N802
        """Paint bars and keys."""
        painter = theme.smooth_painter(self)
        for index, value in enumerate(self._axes):
            self._paint_axis(painter, index, value)
        for index, value in enumerate(self._buttons):
            self._paint_button(painter, index, value)

    def _paint_axis(self, painter, index, value):
        """Paint one axis: number, bar, meaning."""
        height, unit = self._row_px(), self.fontMetrics().height()
        top, palette = index * height, self.palette()
        painter.setPen(theme.colour(theme.TEXT, palette))
        painter.drawText(QRectF(0, top, 1.6 * unit, height), int(Qt.AlignRight | Qt.AlignVCenter),
                         str(index))
        words_px = theme.text_width(self.font(), 'forward') + 0.4 * unit
        bar = QRectF(2 * unit, top + 0.25 * height, self.width() - 2.2 * unit - words_px,
                     0.5 * height)
        painter.drawText(QRectF(bar.right() + 0.4 * unit, top, words_px, height),
                         int(Qt.AlignVCenter), self._axis_words.get(index, ''))
        painter.setPen(QPen(theme.colour(theme.MUTED, palette), 1))
        if value is None:
            painter.drawText(QRectF(bar.left(), top, bar.width(), height), int(Qt.AlignVCenter),
                             UNKNOWN)
            return
        painter.setBrush(palette.color(QPalette.Base))
        painter.drawRect(bar)
        middle, end = bar.center().x(), bar.center().x() + value * bar.width() / 2.0
        painter.fillRect(QRectF(min(middle, end), bar.top(), max(2.0, abs(end - middle)),
                                bar.height()), theme.colour(theme.DRIVE, palette))

    def _paint_button(self, painter, index, pressed):
        """Paint one button: a key with its number, and its meaning below."""
        unit, height, palette = self.fontMetrics().height(), self._key_px(), self.palette()
        row, column = divmod(index, _COLUMNS)
        cell = QRectF(column * self.width() / _COLUMNS,
                      len(self._axes) * self._row_px() + row * height,
                      self.width() / _COLUMNS, height)
        key = QRectF(cell.center().x() - unit, cell.top() + 0.15 * unit, 2 * unit, 1.25 * unit)
        ink = theme.colour(theme.DRIVE, palette)
        painter.setPen(QPen(ink if pressed else theme.colour(theme.MUTED, palette), 1.5))
        painter.setBrush(ink if pressed else palette.color(QPalette.Base))
        painter.drawRoundedRect(key, 4, 4)
        painter.setPen(theme.readable_on(ink) if pressed else theme.colour(theme.TEXT, palette))
        painter.drawText(key, int(Qt.AlignCenter), str(index))
        words = self._button_words.get(index, '')
        if words:
            painter.setPen(theme.colour(theme.TEXT, palette))
            painter.drawText(QRectF(cell.left(), key.bottom(), cell.width(), 1.1 * unit),
                             int(Qt.AlignCenter), theme.fitting_text(
                                 self.fontMetrics(), (words, words.split()[0]), cell.width()))
