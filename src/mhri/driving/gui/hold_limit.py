# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Time limit for held keys and sticks on a remote display, renewed by further events."""
from python_qt_binding.QtCore import QObject, Qt, QTimer, Signal

from mhri.base.remote_display import HELD_S


class HoldLimit(QObject):
    """Expires :data:`HELD_S` after the last sign of life; never on a local display."""

    ran_out = Signal()

    def __init__(self, parent):
        super().__init__(parent)
        #: the result of :func:`mhri.base.remote_display.remote_kind`
        self.remote = ''
        self._timer = QTimer(self, singleShot=True, timerType=Qt.PreciseTimer,
                             interval=round(1000 * HELD_S))
        self._timer.timeout.connect(self.ran_out)

    def renew(self):
        """Handle a sign of life of the held key or stick."""
        if self.remote:
            self._timer.start()

    def end(self):
        """Stop the timer: nothing is held."""
        self._timer.stop()
