# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The operator's speed limits: two sliders with their values."""
from python_qt_binding.QtCore import QRectF, QSize, Qt, QTimer, Signal
from python_qt_binding.QtGui import QPalette, QPen
from python_qt_binding.QtWidgets import (
    QAbstractSlider, QGridLayout, QHBoxLayout, QLabel, QSizePolicy, QStyle, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.choices import IgnoresWheel
from mhri.base.gui.labels import TextLine
from mhri.base.gui.pending import Pending
from mhri.base.gui.switches import SwitchBox

_PER_UNIT = 100  # slider steps in one m/s or rad/s
LINEAR_RANGE_MPS = (0.05, 1.0)
ANGULAR_RANGE_RAD_S = (0.1, 3.2)
EMIT_PERIOD_MS = 50
_ANSWER_WITHIN_S = 1.0


class LimitSlider(IgnoresWheel, QAbstractSlider):
    """A slider for touch: the handle is as large as a finger and jumps to the touched position.

    The wheel has no effect: scrolling past must not change the speed of robots.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self.setOrientation(Qt.Horizontal)
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)

    def sizeHint(self):  # noqa: N802
        """Return a comfortable size for touch."""
        side = theme.touch_size(self)
        return QSize(side * 4, side)

    def minimumSizeHint(self):  # noqa: N802
        """Return the minimum size for touch."""
        side = theme.touch_size(self)
        return QSize(side * 2, side)

    def mousePressEvent(self, event):  # noqa: N802
        """Grab the handle."""
        if event.button() == Qt.LeftButton:
            self.setSliderDown(True)
            self._follow(event.pos().x())

    def mouseMoveEvent(self, event):  # noqa: N802
        """Move the handle."""
        if self.isSliderDown():
            self._follow(event.pos().x())

    def mouseReleaseEvent(self, event):  # noqa: N802
        """Release the handle."""
        if event.button() == Qt.LeftButton:
            self.setSliderDown(False)

    def _follow(self, x):
        """Set the value for a position, in whole single steps."""
        margin = self._radius() + 2
        raw = QStyle.sliderValueFromPosition(
            self.minimum(), self.maximum(), x - margin, max(1, self.width() - 2 * margin))
        self.setValue(round(raw / self.singleStep()) * self.singleStep())

    def _radius(self):
        """Return the radius of the handle [px]."""
        return round(self.fontMetrics().height() * 0.62)

    def sliderChange(self, change):  # noqa: N802
        """Repaint after any change."""
        self.update()

    def paintEvent(self, event):  # noqa: N802
        """Paint groove, filled part and handle."""
        painter = theme.smooth_painter(self)
        palette = self.palette()
        radius = self._radius()
        margin = radius + 2
        span = max(1, self.width() - 2 * margin)
        x = margin + QStyle.sliderPositionFromValue(self.minimum(), self.maximum(), self.value(),
                                                    span)
        middle = self.height() / 2.0
        theme.set_ink(painter, brush=theme.line_colour(palette))
        painter.drawRoundedRect(QRectF(margin, middle - 3, span, 6), 3, 3)
        ink = theme.colour(theme.DRIVE if self.isEnabled() else theme.MUTED, palette)
        painter.setBrush(ink)
        painter.drawRoundedRect(QRectF(margin, middle - 3, x - margin, 6), 3, 3)
        theme.set_ink(painter, QPen(ink, 3),
                      ink if self.isSliderDown() else palette.color(QPalette.Button))
        painter.drawEllipse(QRectF(x - radius, middle - radius, 2 * radius, 2 * radius))
        if self.hasFocus():
            painter.setPen(QPen(palette.color(QPalette.WindowText), 1, Qt.DotLine))
            painter.setBrush(Qt.NoBrush)
            painter.drawRect(self.rect().adjusted(0, 1, -1, -2))


class SpeedLimits(QWidget):
    """Forward [m/s] and turn [rad/s]; shows the limits in force unless the operator edits them."""

    #: m/s and rad/s; at most 20 times a second while a slider moves, and at the end
    limits_requested = Signal(float, float)
    #: whether all selected robots should keep to the pace of the slowest
    together_requested = Signal(bool)
    #: whether manually driven robots should slow down for obstacles
    brake_requested = Signal(bool)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._limits = (0.5, 1.5)
        self._unsent = None
        self._asked = Pending(_ANSWER_WITHIN_S)
        self._build()
        self._connect()
        self._show()

    def _build(self):
        """Make and place the sliders."""
        self.setFont(theme.base_font(self.font()))
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(self.fontMetrics().height() // 2)
        grid.setVerticalSpacing(0)
        self.linear_slider = self._slider('linear_slider', LINEAR_RANGE_MPS, 5, 20)
        self.angular_slider = self._slider('angular_slider', ANGULAR_RANGE_RAD_S, 10, 50)
        self._values = []
        rows = (('Speed', 'forward', self.linear_slider, '0.00 m/s'),
                ('', 'turn', self.angular_slider, '0.00 rad/s'))
        for row, (head, word, slider, sample) in enumerate(rows):
            value = TextLine(self)
            value.setFont(theme.number_font(self.font()))
            value.fix_width('0.00 rad/s')
            value.setObjectName(slider.objectName().replace('slider', 'value'))
            self._values.append(value)
            slider.setAccessibleName('Speed limit, {}'.format(word))
            for column, widget in enumerate((QLabel(head, self), QLabel(word, self), slider,
                                             value)):
                grid.addWidget(widget, row, column)
        self.together_box = SwitchBox('stay together', self)
        self.together_box.setObjectName('together_box')
        self.together_box.setToolTip(
            'All selected robots keep to what the slowest of them can do, on the same curve')
        self.brake_box = SwitchBox('obstacle brake', self)
        self.brake_box.setObjectName('brake_box')
        self.brake_box.setToolTip(
            'Driven robots slow down and stop before obstacles that their laser sees;\n'
            'without a laser, that their depth camera sees. Backing away and turning stay\n'
            'possible; what neither sees is not avoided.')
        self.pace_label = TextLine(self)
        self.pace_label.setObjectName('pace_label')
        group = QHBoxLayout()
        group.setSpacing(self.fontMetrics().height() // 2)
        group.addWidget(self.together_box)
        group.addWidget(self.pace_label, 1)
        grid.addWidget(QLabel('Group', self), len(rows), 0)
        grid.addLayout(group, len(rows), 1, 1, 3)
        grid.addWidget(self.brake_box, len(rows) + 1, 1, 1, 3)
        grid.setColumnStretch(2, 1)
        self._timer = QTimer(self, singleShot=True, interval=EMIT_PERIOD_MS)

    def _slider(self, name, bounds, step, page):
        """Make one slider; its steps are hundredths."""
        slider = LimitSlider(self)
        slider.setObjectName(name)
        slider.setRange(round(bounds[0] * _PER_UNIT), round(bounds[1] * _PER_UNIT))
        slider.setSingleStep(step)
        slider.setPageStep(page)
        return slider

    def _connect(self):
        """Connect the sliders."""
        for slider in (self.linear_slider, self.angular_slider):
            slider.valueChanged.connect(self._on_value)
            slider.sliderReleased.connect(self._send)
        self._timer.timeout.connect(self._send)
        self.together_box.clicked.connect(self.together_requested)
        self.brake_box.clicked.connect(self.brake_requested)

    def show_limits(self, limits):
        """Show the limits in force [m/s, rad/s], unless the operator is changing them."""
        if limits != self._limits or self._asked.value is not None:
            self._limits = limits
            self._show()

    def show_pace(self, together, pace, slowed=False, brake=False):
        """Show the pace of the robots as text, highlighted if ``slowed`` by a link."""
        self.together_box.setChecked(together)
        self.brake_box.setChecked(brake)
        head, _, tail = pace.partition(': ')
        # Keep the speed when shortening: the percentage or the maximum.
        shorter = (head,) if slowed else (tail, tail.replace('at most ', '')) if tail else ()
        self.pace_label.show_text(pace, theme.ATTENTION if slowed else theme.MUTED, shorter)

    def _show(self):
        """Place the sliders; a limit outside their range is still shown as a number."""
        if self._dragged():
            return
        limits = self._asked.settle(self._limits)
        for slider, value in zip((self.linear_slider, self.angular_slider), limits):
            slider.blockSignals(True)
            slider.setValue(round(value * _PER_UNIT))
            slider.blockSignals(False)
        self._write(limits)

    def _write(self, limits):
        """Write the values beside the sliders."""
        for label, value, unit in zip(self._values, limits, ('m/s', 'rad/s')):
            label.show_text('{:.2f} {}'.format(value, unit))

    def _dragged(self):
        """Return whether the operator holds a slider."""
        return self.linear_slider.isSliderDown() or self.angular_slider.isSliderDown()

    def _on_value(self):
        """Handle a value set by the operator; the other limit stays as it is in force."""
        sliders = (self.linear_slider, self.angular_slider)
        limits = list(self._asked.settle(self._limits))
        index = sliders.index(self.sender())
        limits[index] = sliders[index].value() / _PER_UNIT
        self._unsent = tuple(limits)
        self._asked.ask(self._unsent)
        self._write(limits)
        if not self._timer.isActive():
            self._send()

    def _send(self):
        """Request the newest value, once."""
        if self._unsent is None:
            return
        limits, self._unsent = self._unsent, None
        self._timer.start()
        self.limits_requested.emit(*limits)
