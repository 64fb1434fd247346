# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Controls that act only while they are held: a button, and a small pad that springs back."""
from python_qt_binding.QtCore import Signal

from mhri.base.accessories import AXIS2
from mhri.base.gui import theme
from mhri.base.gui.controls import Button
from mhri.driving.gui.hold_limit import HoldLimit
from mhri.driving.gui.spring_pad import CAPTION_LINES, deflection_of, is_lost, SpringPad


class HoldButton(Button):
    """A button that acts while it is pressed; every kind of loss releases it, as of the stick."""

    #: it was released since no events came from the remote display
    ran_out = Signal()

    def __init__(self, text, parent=None):
        super().__init__(text, parent)
        self.limit = HoldLimit(self)
        self.limit.ran_out.connect(self._run_out)
        self.pressed.connect(self.limit.renew)
        self.released.connect(self.limit.end)

    def centre(self):
        """Release it; it has to be pressed again."""
        if self.isDown():
            self.setDown(False)
            self.released.emit()

    def _run_out(self):
        self.centre()
        self.ran_out.emit()

    def event(self, event):
        """Release it on every kind of loss."""
        if is_lost(self, event):
            self.centre()
        return super().event(event)

    def mouseMoveEvent(self, event):  # noqa: N802
        """Note the sign of life; a move without a button shows that the release was lost."""
        if not event.buttons():
            self.centre()
        elif self.isDown():
            self.limit.renew()
        super().mouseMoveEvent(event)


class AxisPad(SpringPad):
    """A small pad for one or two axes, its name above it.

    :param control: :class:`mhri.accessories.controls.Control`
    """

    USUAL_UNITS = MIN_UNITS = (5.0, 5.0 + CAPTION_LINES)

    #: its values: (up +) of an axis, (left +, up +) of two
    moved = Signal(tuple)

    def __init__(self, control, parent=None):
        super().__init__(parent)
        self._spec = control.spec
        self._values = ()
        if self._spec.kind != AXIS2:
            self.ARROWS = (0, 2)
        self.setAccessibleName(control.label)

    def _hold(self, across, along):
        """Emit the values of a place of the knob."""
        up, left = deflection_of(across, along)
        values = (left, up) if self._spec.kind == AXIS2 else (up,)
        if values != self._values:
            self._values = values
            self.moved.emit(values)

    def paintEvent(self, event):  # noqa: N802
        """Paint its name, the pad and the knob."""
        painter = theme.smooth_painter(self)
        self._paint_caption(painter, theme.fitting_text(
            self.fontMetrics(), (self._spec.label,), self.width() - self.fontMetrics().height()))
        self._paint_all(painter)
