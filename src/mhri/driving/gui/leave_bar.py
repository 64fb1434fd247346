# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Asks whether to close the screen, above its foot instead of in a dialog."""
from python_qt_binding.QtCore import Qt, Signal

from mhri.base.gui import words
from mhri.driving.gui.asking_bar import AskingBar


class LeaveBar(AskingBar):
    """Hidden until :meth:`ask`; then "Stay" has the focus, so that Return closes nothing."""

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
        """Connect the buttons."""
        self.stay_button.clicked.connect(self.hide)
        self.close_button.clicked.connect(self.close_requested)

    @property
    def question(self):
        """The displayed question, '' for none."""
        return self._line.text() if self.isVisible() else ''

    def ask(self, question):
        """Show a question, e.g. "bot1 is driven: close anyway?"."""
        self._line.show_text(question, shorter=words.beginnings(question))
        self.show()
        self.stay_button.setFocus(Qt.OtherFocusReason)
