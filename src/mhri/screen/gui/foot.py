# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Questions and fields that are shown for a while, right above the foot of the screen."""
from python_qt_binding.QtCore import QEvent, QPoint, QRect
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui.layouts import in_column

# A narrower bar has its buttons below its text; minimum width of a bar [line heights].
_NARROW_UNITS, _MIN_UNITS = 30.0, 16.0
_MARGIN_PX = 4


class PassingBars(QWidget):
    """A column of bars over what is above the foot, so that nothing moves.

    It leaves the virtual joystick free where that leaves the bars enough width.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, its form loaded
    """

    def __init__(self, screen):
        super().__init__(screen)
        self._screen = screen
        self._bars = []
        self.setObjectName('passing')
        self.setAutoFillBackground(True)
        self._column = in_column(of=self, margins=[_MARGIN_PX] * 4)

    def add(self, bar):
        """Add a hidden bar; it has ``show_narrow()``."""
        self._bars.append(bar)
        self._column.addWidget(bar)
        bar.installEventFilter(self)
        self.place()

    def eventFilter(self, watched, event):  # noqa: N802
        """Follow the bars."""
        if event.type() in (QEvent.ShowToParent, QEvent.HideToParent, QEvent.LayoutRequest):
            self.place()
        return False

    def place(self):
        """Follow the size of the screen and of the bars."""
        screen = self._screen
        shown = any(not bar.isHidden() for bar in self._bars)
        self.setVisible(shown)
        if not shown:
            return
        unit, stick = self.fontMetrics().height(), screen.joystick
        width, left = screen.width(), stick.mapTo(screen, QPoint(0, 0)).x()
        if stick.isVisible() and left >= _MIN_UNITS * unit:
            width = left
        for bar in self._bars:
            bar.show_narrow(width < _NARROW_UNITS * unit)
        height = self._column.sizeHint().height()
        self.setGeometry(QRect(0, screen.foot.y() - height, width, height))
        self.raise_()
