# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Two steps to take control, while another operator has it."""
from python_qt_binding.QtCore import QTimer, Signal
from python_qt_binding.QtWidgets import QSizePolicy

from mhri.base.views import ControlView
from mhri.driving.gui.asking_bar import AskingBar

CONFIRM_WITHIN_S = 5.0
TAKE = 'Take control'
SURE = 'Their robots stop; nothing moves until you centre the stick.'
SURE_IN_SHORT = 'Robots stop until you centre the stick.'


class ControlBar(AskingBar):
    """Hidden while this screen drives.

    "Take control" shows a confirmation button beside it and turns into "Cancel" itself, so that a
    double click has no effect. The bar shows the state of the view, not of the clicks.
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
            'control_label', ('take_confirm_button', 'Take it'), ('take_button', TAKE))
        self._line.set_wrapped(True, lines=2)
        self._countdown = QTimer(self, singleShot=True, interval=round(CONFIRM_WITHIN_S * 1000))

    def _connect(self):
        """Connect buttons and timer."""
        self.take_button.clicked.connect(self._ask)
        self.confirm_button.clicked.connect(self._confirm)
        self._countdown.timeout.connect(self._show)

    @property
    def asking(self):
        """Whether it asks for the second step, which takes more room."""
        return self._countdown.isActive()

    def show_control(self, control):
        """Show a :class:`mhri.base.views.ControlView`."""
        if control != self._control:
            self._control = control
            if control.ours:
                self._countdown.stop()
            self._show()

    def _ask(self):
        """Handle the first step, or cancel it."""
        if self._countdown.isActive():
            self._countdown.stop()
        else:
            self._countdown.start()
        self._show()

    def _confirm(self):
        """Handle the second step."""
        self._countdown.stop()
        self._show()
        self.take_requested.emit()

    def _show(self):
        """Show the current state."""
        asking = self.asking
        who = self._control.words
        for part in (self._line, self._sign):
            part.setVisible(asking)
        question = 'Take control from {}?'.format(who)
        self._line.show_text('{} {}'.format(question, SURE), shorter=(
            '{} {}'.format(question, SURE_IN_SHORT), 'Take control? ' + SURE_IN_SHORT,
            SURE_IN_SHORT, 'Take it? Robots stop.', 'Robots stop.'))
        self.confirm_button.setVisible(asking)
        self.take_button.setText('Cancel' if asking else TAKE)
        # Only the question needs more than its buttons.
        self.setSizePolicy(QSizePolicy.Expanding if asking else QSizePolicy.Maximum,
                           QSizePolicy.Fixed)
        self.setVisible(not self._control.ours)
