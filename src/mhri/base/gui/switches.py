# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Check boxes and radio buttons for touch, with a mark that is visible on every desktop."""
from python_qt_binding.QtCore import QRectF, QSize, Qt
from python_qt_binding.QtGui import QPalette, QPen
from python_qt_binding.QtWidgets import QButtonGroup, QCheckBox, QRadioButton, QSizePolicy

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows


class _Switch:
    """Base of both kinds; a click does not take the focus from the driving widget."""

    # Size of the mark, in heights of a line.
    _MARK_UNITS = 1.25

    def __init__(self, text='', parent=None):
        super().__init__(text, parent)
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)

    def sizeHint(self):  # noqa: N802
        """Return the size of mark and text, high enough for touch."""
        metrics = self.fontMetrics()
        return QSize(metrics.horizontalAdvance(self.text()) + round(2.1 * metrics.height()),
                     theme.touch_size(self))

    def minimumSizeHint(self):  # noqa: N802
        """Return the size hint."""
        return self.sizeHint()

    def hitButton(self, pos):  # noqa: N802
        """Return whether a point is on the widget: all of it is the target."""
        return self.rect().contains(pos)

    def paintEvent(self, event):  # noqa: N802
        """Paint the mark and the text; without a text, the mark is in the centre."""
        painter = theme.smooth_painter(self)
        palette, unit = self.palette(), self.fontMetrics().height()
        side = self._MARK_UNITS * unit
        box = QRectF(2.0 if self.text() else (self.width() - side) / 2.0,
                     (self.height() - side) / 2.0, side, side)
        enabled = self.isEnabled()
        ink = theme.colour(theme.DRIVE if enabled else theme.MUTED, palette)
        lively = enabled and (self.isChecked() or self.underMouse())
        painter.setPen(QPen(ink if lively else theme.colour(theme.MUTED, palette), 2))
        painter.setBrush(palette.color(QPalette.Base))
        self._paint_mark(painter, box, ink)
        painter.setPen(theme.colour(theme.TEXT if enabled else theme.MUTED, palette))
        words = self.rect().adjusted(round(1.75 * unit), 0, 0, 0)
        painter.drawText(words, int(Qt.AlignLeft | Qt.AlignVCenter), self.text())
        if self.hasFocus():
            theme.set_ink(painter, QPen(palette.color(QPalette.WindowText), 1, Qt.DotLine))
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))


class SwitchBox(_Switch, QCheckBox):
    """A check box with a text; all of it is the target."""

    def _paint_mark(self, painter, box, ink):
        """Paint box and tick."""
        if self.isChecked():
            painter.setBrush(ink)
        painter.drawRoundedRect(box, 4, 4)
        if self.isChecked():
            theme.paint_sign(painter, box.adjusted(3, 3, -3, -3), theme.TICK,
                             theme.readable_on(ink), ink)


class SquareBox(SwitchBox):
    """A square check box without a text, large enough for touch."""

    _MARK_UNITS = 1.35

    def sizeHint(self):  # noqa: N802
        """Return the smallest square for touch."""
        side = theme.touch_size(self)
        return QSize(side, side)


class SwitchRadio(_Switch, QRadioButton):
    """A radio button with a text; all of it is the target."""

    def _paint_mark(self, painter, box, ink):
        """Paint ring and dot."""
        painter.drawEllipse(box)
        if self.isChecked():
            theme.set_ink(painter, brush=ink)
            inset = 0.25 * box.width()
            painter.drawEllipse(box.adjusted(inset, inset, -inset, -inset))


def radio_group(parent, layout, prefix, spoken, texts):
    """Create and place a group of exclusive radio buttons; return them by key.

    While one has the focus the arrow keys choose; a click does not move the focus there.

    :param prefix: prefix of their object names, before the key
    :param spoken: prefix of their accessible names, before the text
    :param texts: {key: text}
    """
    group, buttons = QButtonGroup(parent), {}
    for key, text in texts.items():
        button = buttons[key] = SwitchRadio(text, parent)
        button.setObjectName(prefix + key)
        button.setAccessibleName(spoken + text)
        keep_arrows(button)
        group.addButton(button)
        layout.addWidget(button)
    return buttons
