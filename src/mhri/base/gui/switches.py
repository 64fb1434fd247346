# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Check boxes and radio buttons for fingers, with a mark that is seen on every desktop."""
from python_qt_binding.QtCore import QRectF, QSize, Qt
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QCheckBox, QRadioButton, QSizePolicy

from mhri.base.gui import theme


def _prepare(button):
    """Set what both kinds have in common; a click does not take the keyboard from what drives."""
    button.setFocusPolicy(Qt.TabFocus)
    button.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)


def _size(button):
    """Return the room for mark and words, high enough for a finger."""
    metrics = button.fontMetrics()
    return QSize(metrics.horizontalAdvance(button.text()) + round(2.1 * metrics.height()),
                 theme.touch_size(button))


def _paint(button, paint_mark):
    """Paint the words beside a mark: ``paint_mark(painter, box, ink)``."""
    painter = QPainter(button)
    painter.setRenderHint(QPainter.Antialiasing)
    palette, unit = button.palette(), button.fontMetrics().height()
    side = 1.25 * unit
    box = QRectF(2.0, (button.height() - side) / 2.0, side, side)
    enabled = button.isEnabled()
    ink = theme.colour(theme.DRIVE if enabled else theme.MUTED, palette)
    lively = enabled and (button.isChecked() or button.underMouse())
    painter.setPen(QPen(ink if lively else theme.colour(theme.MUTED, palette), 2))
    painter.setBrush(palette.color(QPalette.Base))
    paint_mark(painter, box, ink)
    painter.setPen(theme.colour(theme.TEXT if enabled else theme.MUTED, palette))
    words = button.rect().adjusted(round(1.75 * unit), 0, 0, 0)
    painter.drawText(words, int(Qt.AlignLeft | Qt.AlignVCenter), button.text())
    if button.hasFocus():
        painter.setPen(QPen(palette.color(QPalette.WindowText), 1, Qt.DotLine))
        painter.setBrush(Qt.NoBrush)
        painter.drawRect(button.rect().adjusted(0, 0, -1, -1))


class SwitchBox(QCheckBox):
    """A check box with words; all of it is the target."""

    def __init__(self, text='', parent=None):
        super().__init__(text, parent)
        _prepare(self)

    def sizeHint(self):  # noqa: N802
        """Return the room for box and words."""
        return _size(self)

    minimumSizeHint = sizeHint

    def hitButton(self, pos):  # noqa: N802
        """Tell whether a place is on the box: everywhere is."""
        return self.rect().contains(pos)

    def paintEvent(self, event):  # noqa: N802
        """Paint box, tick and words."""
        _paint(self, self._paint_mark)

    def _paint_mark(self, painter, box, ink):
        """Paint the box."""
        if self.isChecked():
            painter.setBrush(ink)
        painter.drawRoundedRect(box, 4, 4)
        if self.isChecked():
            theme.paint_sign(painter, box.adjusted(3, 3, -3, -3), theme.TICK,
                             theme.readable_on(ink), ink)


class SwitchRadio(QRadioButton):
    """A radio button with words; all of it is the target."""

    def __init__(self, text='', parent=None):
        super().__init__(text, parent)
        _prepare(self)

    def sizeHint(self):  # noqa: N802
        """Return the room for mark and words."""
        return _size(self)

    minimumSizeHint = sizeHint

    def hitButton(self, pos):  # noqa: N802
        """Tell whether a place is on the button: everywhere is."""
        return self.rect().contains(pos)

    def paintEvent(self, event):  # noqa: N802
        """Paint ring, dot and words."""
        _paint(self, self._paint_mark)

    def _paint_mark(self, painter, box, ink):
        """Paint the ring."""
        painter.drawEllipse(box)
        if self.isChecked():
            painter.setPen(Qt.NoPen)
            painter.setBrush(ink)
            inset = 0.25 * box.width()
            painter.drawEllipse(box.adjusted(inset, inset, -inset, -inset))
