# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who drives, where it is not this screen: one line, and two steps to take control."""
from python_qt_binding.QtCore import QTimer, Signal

from mhri.base.views import ControlView
from mhri.driving.gui.asking_bar import AskingBar

CONFIRM_WITHIN_S = 5.0
TAKE = 'Take control'
SURE = 'Their robots stop, and nothing moves before your stick is centred.'


class ControlBar(AskingBar):
    """Hidden while this screen drives.

    "Take control" asks for a second step beside it; where it was, there is "Cancel" then, so that a
    double click takes nothing. What is on show follows the view, not the clicks.
    """

    take_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._control = ControlView()
        self._build()
        self._connect()
        self._show()

    def _build(self):
        """Make and place the parts."""
        self.confirm_button, self.take_button = super()._build(
            'control_label', ('take_confirm_button', 'Take it', '', TAKE), ('take_button', TAKE))
        self._countdown = QTimer(self)
        self._countdown.setSingleShot(True)
        self._countdown.setInterval(round(CONFIRM_WITHIN_S * 1000))

    def show_narrow(self, narrow):
        """Have the buttons below the words, where there is little width."""
        super().show_narrow(narrow)
        self._line.set_wrapped(narrow)

    def _connect(self):
        """Wire buttons and timer."""
        self.take_button.clicked.connect(self._ask)
        self.confirm_button.clicked.connect(self._confirm)
        self._countdown.timeout.connect(self._show)

    def show_control(self, control):
        """Show a :class:`mhri.base.views.ControlView`."""
        if control != self._control:
            self._control = control
            if control.ours:
                self._countdown.stop()
            self._show()

    def _ask(self):
        """First step, or back from it."""
        if self._countdown.isActive():
            self._countdown.stop()
        else:
            self._countdown.start()
        self._show()

    def _confirm(self):
        """Second step."""
        self._countdown.stop()
        self._show()
        self.take_requested.emit()

    def _show(self):
        """Show the state as it is known."""
        asking = self._countdown.isActive()
        who = self._control.who or 'somebody else'
        self._line.show_text(
            'Take control from {}? {}'.format(who, SURE) if asking else 'Drives: ' + who,
            shorter=('Take control from {}?'.format(who), 'Take control?') if asking else (who,))
        self.confirm_button.setVisible(asking)
        self.take_button.setText('Cancel' if asking else TAKE)
        self.setVisible(not self._control.ours)
