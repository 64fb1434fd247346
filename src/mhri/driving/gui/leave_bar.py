# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Asks over the foot of the screen, and never in a dialog, whether it is to be closed."""
from python_qt_binding.QtCore import Qt, Signal

from mhri.base.gui import words
from mhri.driving.gui.asking_bar import AskingBar


class LeaveBar(AskingBar):
    """Hidden until :meth:`ask`; "Stay" has the keyboard then, so that Return closes nothing."""

    close_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.close_button, self.stay_button = super()._build(
            'leave_label', ('leave_button', 'Close'), ('stay_button', 'Stay'))
        self._line.set_wrapped(True)
        self.hide()

    def _connect(self):
        """Wire the buttons."""
        self.stay_button.clicked.connect(self.hide)
        self.close_button.clicked.connect(self.close_requested)

    @property
    def question(self):
        """The question on show, '' for none."""
        return self._line.text() if self.isVisible() else ''

    def ask(self, question):
        """Show a question, e.g. "bot1 is driven: close anyway?"."""
        self._line.show_text(question, shorter=words.beginnings(question))
        self.show()
        self.stay_button.setFocus(Qt.OtherFocusReason)
