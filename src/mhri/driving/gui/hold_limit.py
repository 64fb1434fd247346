# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is held on a remote display counts for a moment only, unless it shows that it still is."""
from python_qt_binding.QtCore import QObject, Qt, QTimer, Signal

from mhri.base.remote_display import HELD_S


class HoldLimit(QObject):
    """Runs out :data:`HELD_S` after the last sign of life; on a display of this computer never."""

    ran_out = Signal()

    def __init__(self, parent):
        super().__init__(parent)
        #: as :func:`mhri.base.remote_display.remote_kind` has it
        self.remote = ''
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setTimerType(Qt.PreciseTimer)
        self._timer.setInterval(round(1000 * HELD_S))
        self._timer.timeout.connect(self.ran_out)

    def renew(self):
        """Take in a sign of life of what is held."""
        if self.remote:
            self._timer.start()

    def end(self):
        """Take in that nothing is held."""
        self._timer.stop()
