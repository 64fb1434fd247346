# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A long press: opens the menu of a widget for operators without a right button."""
from python_qt_binding.QtCore import QEvent, QObject, Qt, QTimer, Signal

LONG_PRESS_MS = 600
# A press that moves by more is a drag [px].
DRAG_PX = 8
_ENDS = frozenset((QEvent.MouseButtonRelease, QEvent.MouseButtonDblClick, QEvent.Hide,
                   QEvent.WindowDeactivate))


class LongPress(QObject):
    """Emits :attr:`held` once the left button or a finger has rested on a widget for 0.6 s."""

    #: where the press was, in the widget
    held = Signal(object)

    def __init__(self, widget):
        super().__init__(widget)
        self._at = None
        self._timer = QTimer(self, singleShot=True, interval=LONG_PRESS_MS)
        self._timer.timeout.connect(self._on_time)
        widget.installEventFilter(self)

    def _on_time(self):
        self.held.emit(self._at)

    def eventFilter(self, watched, event):  # noqa: N802
        """Watch presses, and pass on every event."""
        kind = event.type()
        if kind == QEvent.MouseButtonPress and event.button() == Qt.LeftButton:
            self._at = event.pos()
            self._timer.start()
        elif kind in _ENDS:
            self._timer.stop()
        elif kind == QEvent.MouseMove and self._timer.isActive() \
                and (event.pos() - self._at).manhattanLength() > DRAG_PX:
            self._timer.stop()
        return False
