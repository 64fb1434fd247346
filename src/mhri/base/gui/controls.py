# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Flat buttons, drop-downs and fields in the colours of the palette: no gradients, one accent.

They paint themselves, because within rqt the style belongs to rqt. Python cannot be the style
either: PyQt may hand it the options of another control that was painted before.
"""
from contextlib import suppress

from python_qt_binding.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from python_qt_binding.QtGui import QPainter, QPainterPath, QPalette
from python_qt_binding.QtWidgets import (
    QComboBox, QHeaderView, QLineEdit, QProgressBar, QPushButton, QSizePolicy)

from mhri.base.gui import icons, theme
from mhri.base.text import shown_number, typed_number


def paint_control(painter, widget, on=False):
    """Paint the ground, the edge and the focus of a control.

    :param on: whether it is pressed or checked: it has a tint and the edge of the accent
    """
    palette, rect = widget.palette(), QRectF(widget.rect())
    ground, accent = palette.color(QPalette.Button), theme.colour(theme.DRIVE, palette)
    edge, width = theme.edge_colour(palette), 1.0
    if not widget.isEnabled():
        ground = theme.blend(ground, palette.color(QPalette.Window), 0.6)
        edge = theme.blend(edge, palette.color(QPalette.Window), 0.5)
    elif on:
        ground, edge, width = theme.blend(ground, accent, 0.22), accent, 2.0
    elif widget.underMouse():
        ground = theme.blend(ground, palette.color(QPalette.ButtonText), 0.08)
    theme.paint_box(painter, rect, ground, edge, width)
    if widget.hasFocus():
        theme.paint_focus(painter, widget.rect(), palette)


def ink_of(widget):
    """Return the colour of the text of a control."""
    return widget.palette().color(
        QPalette.Active if widget.isEnabled() else QPalette.Disabled, QPalette.ButtonText)


class Button(QPushButton):
    """A flat button; :meth:`set_icon` sets an icon before its text."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self._icon = ''
        self.setAttribute(Qt.WA_Hover)

    def set_icon(self, name):
        """Show an icon of :mod:`mhri.base.gui.icons`, and make room for it; return the button."""
        self._icon = name
        self.setMinimumWidth(self.minimumWidth() + self._icon_px())
        self.updateGeometry()
        return self

    def _icon_px(self):
        """Return the width of the icon and of the gap beside it [px]."""
        return self.fontMetrics().height() + 2 * theme.GRID if self._icon else 0

    def sizeHint(self):  # noqa: N802
        """Return the size for icon and text."""
        return super().sizeHint() + QSize(self._icon_px(), 0)

    def minimumSizeHint(self):  # noqa: N802
        """Return the size for icon and text."""
        return super().minimumSizeHint() + QSize(self._icon_px(), 0)

    def paintEvent(self, event):  # noqa: N802
        """Paint ground, icon and text."""
        painter = QPainter(self)
        paint_control(painter, self, self.isDown() or self.isChecked())
        self.paint_text(painter)

    def paint_text(self, painter):
        """Paint icon and text in the middle; with a menu, also an arrow."""
        ink, rect = ink_of(self), QRectF(self.rect())
        if self.menu() is not None:
            side = self.fontMetrics().height()
            rect.setRight(rect.right() - side)
            icons.paint_icon(painter, QRectF(rect.right() - theme.GRID, rect.top(), side,
                                             rect.height()), 'chevron-down', ink)
        shift = self._icon_px()
        if shift:
            width = self.fontMetrics().horizontalAdvance(self.text())
            left = rect.center().x() - (width + shift) / 2.0
            icons.paint_icon(painter, QRectF(left, rect.top(), shift - 2 * theme.GRID,
                                             rect.height()), self._icon, ink)
            rect = QRectF(QPointF(left + shift, rect.top()), rect.bottomRight())
        painter.setPen(ink)
        painter.drawText(rect, int(Qt.AlignVCenter | Qt.TextShowMnemonic | (
            Qt.AlignLeft if shift else Qt.AlignHCenter)), self.text())


class FittingButton(Button):
    """A button with the longest of its texts that fits."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._texts = ('',)
        self.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)

    def show_texts(self, *texts):
        """Show one of some texts, the longest first."""
        self._texts = texts
        self.updateGeometry()
        self._fit()

    def _fit(self):
        """Show the longest text that fits."""
        room = self.width() - self._icon_px() - theme.touch_size(self) // 2
        self.setText(theme.fitting_text(self.fontMetrics(), self._texts, room))

    def sizeHint(self):  # noqa: N802
        """Return room for the longest text."""
        return self._size_of(self._texts[0])

    def minimumSizeHint(self):  # noqa: N802
        """Return room for the shortest text."""
        return self._size_of(self._texts[-1])

    def _size_of(self, text):
        touch = theme.touch_size(self)
        width = theme.text_width(self.font(), text) + touch // 2 + self._icon_px()
        return QSize(max(touch, width), touch)

    def resizeEvent(self, event):  # noqa: N802
        """Fit the new size."""
        super().resizeEvent(event)
        self._fit()


class Combo(QComboBox):
    """A flat drop-down."""

    def shown(self):
        """Return the text to show."""
        return self.currentText()

    def paintEvent(self, event):  # noqa: N802
        """Paint ground, text and arrow; the text of an editable one paints itself."""
        painter = QPainter(self)
        paint_control(painter, self)
        rect, side, ink = QRectF(self.rect()), self.fontMetrics().height(), ink_of(self)
        icons.paint_icon(painter, QRectF(rect.right() - side - theme.GRID, rect.top(), side,
                                         rect.height()), 'chevron-down', ink)
        if self.isEditable():
            return
        words = rect.adjusted(2 * theme.GRID, 0, -side - 2 * theme.GRID, 0)
        painter.setPen(ink)
        painter.drawText(words, int(Qt.AlignLeft | Qt.AlignVCenter), theme.fitting_text(
            self.fontMetrics(), (self.shown(),), words.width()))


class LineField(QLineEdit):
    """A flat field for a line of text."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.setFrame(False)
        # The field itself keeps 2 px free.
        self.setTextMargins(*(2 * theme.GRID - 2, 0) * 2)

    def paintEvent(self, event):  # noqa: N802
        """Paint the text on its ground, then round corners, the edge and the focus."""
        super().paintEvent(event)
        painter, inside, corners = theme.smooth_painter(self), QPainterPath(), QPainterPath()
        inside.addRoundedRect(QRectF(self.rect()), theme.GRID, theme.GRID)
        corners.addRect(QRectF(self.rect()))
        palette = self.palette()
        painter.fillPath(corners - inside, palette.color(QPalette.Window))
        edge = self.edge_colour()
        if not self.isEnabled():
            edge = theme.blend(edge, palette.color(QPalette.Window), 0.5)
        theme.paint_box(painter, QRectF(self.rect()), Qt.NoBrush, edge)
        if self.hasFocus():
            theme.paint_focus(painter, self.rect(), palette)

    def edge_colour(self):
        """Return the colour of the edge."""
        return theme.edge_colour(self.palette())


class NumberField(LineField):
    """A field for a number with its unit, the same on a computer of any language.

    Typed text stays as it is, and has the edge of a warning while it is not a number within the
    bounds; what is left of a mistyped number is never taken for one. The arrow keys step.

    :param unit: shown behind the number
    :param decimals: shown at least
    :param empty: shown while the field is empty
    """

    def __init__(self, unit, low, high, step, decimals=0, empty='', parent=None):
        super().__init__(parent)
        self._unit, self._low, self._high = unit, low, high
        self._step, self._decimals = step, decimals
        self._wrong = False
        self.setPlaceholderText(empty)
        self._make_room()
        self.editingFinished.connect(self._on_finished)
        self.textChanged.connect(self._on_changed)

    def changeEvent(self, event):  # noqa: N802
        """Follow the size of the text."""
        super().changeEvent(event)
        if event.type() == QEvent.FontChange:
            self._make_room()

    def _make_room(self):
        """Keep the place of the unit free."""
        self.setTextMargins(2 * theme.GRID - 2, 0, 2 * theme.GRID + self._unit_width(), 0)

    def _unit_width(self):
        return self.fontMetrics().horizontalAdvance(' ' + self._unit)

    def sizeHint(self):  # noqa: N802
        """Return a width for the bounds and the unit, or for what an empty field shows."""
        metrics, hint = self.fontMetrics(), super().sizeHint()
        widest = max(metrics.horizontalAdvance(one) for one in (self.placeholderText(), *(
            '{:g}.'.format(bound) + '0' * self._decimals for bound in (self._low, self._high))))
        hint.setWidth(widest + self._unit_width() + 5 * theme.GRID)
        return hint

    def value(self):
        """Return the number, None if the field is empty.

        :raises ValueError: it is not a number within the bounds
        """
        self._wrong = True
        self.update()
        number = typed_number(self.text(), self._low, self._high) if self.text().strip() else None
        self._wrong = False
        return number

    def set_value(self, value):
        """Show a number; None empties the field."""
        self.setText('' if value is None else shown_number(value, self._decimals))

    def step(self, steps):
        """Add some steps within the bounds; an empty field begins at zero, a wrong one stays."""
        with suppress(ValueError):
            value = self.value()
            value = 0.0 if value is None else value + steps * self._step
            self.set_value(min(self._high, max(self._low, value)))

    def keyPressEvent(self, event):  # noqa: N802
        """Step with the arrow keys."""
        steps = {Qt.Key_Up: 1, Qt.Key_Down: -1}.get(event.key())
        if steps:
            self.step(steps)
        else:
            super().keyPressEvent(event)

    def _on_changed(self):
        """Show that a wrong text has become right."""
        if self._wrong:
            with suppress(ValueError):
                self.value()

    def _on_finished(self):
        """Show a finished number as others are shown, and what is wrong as such."""
        with suppress(ValueError):
            self.set_value(self.value())

    def edge_colour(self):
        """Return the colour of the edge."""
        return theme.colour(theme.ATTENTION, self.palette()) if self._wrong \
            else super().edge_colour()

    def paintEvent(self, event):  # noqa: N802
        """Paint the unit behind the number."""
        super().paintEvent(event)
        if self.text():
            painter = QPainter(self)
            painter.setPen(theme.colour(theme.MUTED, self.palette()))
            painter.drawText(self.rect().adjusted(0, 0, -2 * theme.GRID, 0),
                             int(Qt.AlignRight | Qt.AlignVCenter), self._unit)


class Head(QHeaderView):
    """The head of a table: words above a line."""

    def paintSection(self, painter, rect, index):  # noqa: N802
        """Paint the head of a column."""
        palette = self.palette()
        painter.fillRect(rect, palette.color(QPalette.Base))
        painter.fillRect(rect.adjusted(0, rect.height() - 1, 0, 0), theme.line_colour(palette))
        painter.setPen(theme.colour(theme.MUTED, palette))
        painter.drawText(rect.adjusted(theme.GRID, 0, 0, 0), int(self.defaultAlignment()),
                         str(self.model().headerData(index, self.orientation()) or ''))


class Progress(QProgressBar):
    """A flat progress bar with its text in the middle."""

    def paintEvent(self, event):  # noqa: N802
        """Paint the ground, the part that is done, and the text."""
        painter, palette, rect = QPainter(self), self.palette(), QRectF(self.rect())
        theme.paint_box(painter, rect, palette.color(QPalette.Base), theme.edge_colour(palette))
        share = (self.value() - self.minimum()) / max(1, self.maximum() - self.minimum())
        done = rect.adjusted(2, 2, -2, -2)
        done.setWidth(done.width() * min(1.0, max(0.0, share)))
        if done.width() > 2 * theme.GRID:
            theme.paint_box(painter, done, theme.blend(
                palette.color(QPalette.Base), theme.colour(theme.DRIVE, palette), 0.4))
        painter.setPen(theme.colour(theme.TEXT, palette))
        painter.drawText(rect, Qt.AlignCenter, self.text())
