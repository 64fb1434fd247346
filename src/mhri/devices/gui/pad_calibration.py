# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page for calibrating a pad: a live picture of the pad, and a question for each step."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QScrollArea

from mhri.base.gui import theme
from mhri.base.gui.controls import Button
from mhri.base.gui.labels import plain_label, SignedText, TextLine
from mhri.base.gui.layouts import add_parts, in_row
from mhri.base.gui.page import Page
from mhri.devices.calibration_page import CalibrationView
from mhri.devices.gui.pad_picture import PadPicture

NO_PAD = 'No pad'
# Minimum height of the picture [line heights].
_PICTURE_UNITS = 10
# Lines reserved for the question, so that nothing below it jumps.
_PROMPT_LINES = 3


class PadCalibration(Page):
    """A page beside the tiles; takes values and emits presses. Enter is the large button."""

    #: the large button: begin, "Next", "None", "Save"
    confirmed = Signal()
    #: "Start again"
    restart_requested = Signal()

    def __init__(self, parent=None):
        super().__init__('pad_page', parent)
        self._view = None
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the widgets."""
        self.title = TextLine(self)
        self.title.setFont(theme.larger(self.font(), theme.HEAD, bold=True))
        self.progress = TextLine(self)
        self.prompt = plain_label(self)
        self.prompt.setMinimumHeight(_PROMPT_LINES * self.fontMetrics().lineSpacing())
        self.problem = SignedText(self)
        # A label needs slightly more height than its lines.
        self.problem.label.setMinimumHeight(2 * self.fontMetrics().lineSpacing() + 2)
        for label in (self.prompt, self.problem.label):
            label.setAlignment(Qt.AlignLeft | Qt.AlignTop)
        self.action_button = theme.for_fingers(Button(self), 'pad_action')
        self.again_button = theme.for_fingers(Button('Start again', self), 'pad_again')
        self.picture = PadPicture(self)
        scroll = QScrollArea(self)
        scroll.setWidget(self.picture)
        scroll.setWidgetResizable(True)
        scroll.setFocusPolicy(Qt.NoFocus)
        scroll.setMinimumHeight(_PICTURE_UNITS * self.fontMetrics().height())
        buttons = in_row((self.action_button, 2), (self.again_button, 1))
        add_parts(self.column, self.title, self.progress, self.prompt, self.problem, buttons,
                  (scroll, 1))

    def _connect(self):
        """Connect the buttons."""
        self.action_button.clicked.connect(self.confirmed)
        self.again_button.clicked.connect(self.restart_requested)

    def _restore(self):
        """Set the initial state, without a pad."""
        self.show_calibration(CalibrationView())

    def show_calibration(self, view):
        """Show a :class:`mhri.devices.calibration_page.CalibrationView`."""
        if view == self._view:
            return
        self._view = view
        self.title.show_text(view.pad or NO_PAD)
        self.progress.show_text('{} of {}'.format(view.step, view.steps) if view.step else '',
                                theme.MUTED)
        if view.prompt != self.prompt.text():
            self.prompt.setText(view.prompt)
        self.problem.show_text(view.problem, bool(view.problem))
        self._show_buttons(view)
        self.picture.show_pad(view.axes, view.buttons, view.axis_words, view.button_words)

    def _show_buttons(self, view):
        """Show the buttons; the focus stays on the large one, so that Enter presses it."""
        held = self.action_button.hasFocus() or self.again_button.hasFocus()
        self.action_button.setText(view.action)
        self.action_button.setEnabled(bool(view.action))
        self.again_button.setEnabled(view.can_restart)
        if view.action and (held or self.hasFocus()):
            self.action_button.setFocus()
        elif held:
            # A disabled button passes the focus on to the next widget, which Enter would press.
            self.setFocus()

    def showEvent(self, event):  # noqa: N802
        """Report that the page is visible, and take the keyboard focus for Enter."""
        super().showEvent(event)
        (self.action_button if self.action_button.isEnabled() else self).setFocus()

    def keyPressEvent(self, event):  # noqa: N802
        """Consume Enter even if no button is enabled: it must not drive a robot."""
        if event.key() not in (Qt.Key_Return, Qt.Key_Enter):
            super().keyPressEvent(event)
