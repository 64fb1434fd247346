# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page on which a pad is calibrated: a live picture of it, and one question after the other."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import (
    QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.labels import Sign, TextLine
from mhri.devices.calibration_page import CalibrationView
from mhri.devices.gui.pad_picture import PadPicture

NO_PAD = 'No pad'
# So many lines are kept free for what is asked, so that nothing below it jumps.
_PROMPT_LINES = 3


class PadCalibration(QWidget):
    """A page beside the pictures; values in, presses out. Enter is the large button."""

    #: the large button: begin, "Next", "None", "Save"
    confirmed = Signal()
    #: "Start again"
    restart_requested = Signal()
    #: the page came into sight, or is there no more
    shown = Signal(bool)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._view = None
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('pad_page')
        self.setFont(theme.base_font(self.font()))
        self.title = TextLine(self)
        self.title.setFont(theme.larger(self.font(), 1.2, bold=True))
        self.progress = TextLine(self)
        self.prompt = self._wrapped()
        self.prompt.setMinimumHeight(_PROMPT_LINES * self.fontMetrics().lineSpacing())
        self.problem_sign = Sign(self)
        self.problem = self._wrapped()
        # A label wants a pixel more than its lines.
        self.problem.setMinimumHeight(2 * self.fontMetrics().lineSpacing() + 2)
        self.action_button = QPushButton(self)
        self.action_button.setObjectName('pad_action')
        self.again_button = QPushButton('Start again', self)
        self.again_button.setObjectName('pad_again')
        for button in (self.action_button, self.again_button):
            button.setMinimumHeight(theme.touch_size(self))
            button.setFocusPolicy(Qt.TabFocus)
        self.picture = PadPicture(self)
        scroll = QScrollArea(self)
        scroll.setWidget(self.picture)
        scroll.setWidgetResizable(True)
        scroll.setFocusPolicy(Qt.NoFocus)
        trouble, buttons = QHBoxLayout(), QHBoxLayout()
        trouble.addWidget(self.problem_sign, 0, Qt.AlignTop)
        trouble.addWidget(self.problem, 1)
        buttons.addWidget(self.action_button, 2)
        buttons.addWidget(self.again_button, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        for part in (self.title, self.progress, self.prompt, trouble, buttons):
            (column.addLayout if isinstance(part, QHBoxLayout) else column.addWidget)(part)
        column.addWidget(scroll, 1)

    def _wrapped(self):
        """Return a label of several lines."""
        label = QLabel(self)
        label.setTextFormat(Qt.PlainText)
        label.setWordWrap(True)
        label.setAlignment(Qt.AlignLeft | Qt.AlignTop)
        return label

    def _connect(self):
        """Wire the buttons."""
        self.action_button.clicked.connect(self.confirmed)
        self.again_button.clicked.connect(self.restart_requested)

    def _restore(self):
        """Begin without a pad."""
        self.show_calibration(CalibrationView())

    def show_calibration(self, view):
        """Show a :class:`mhri.devices.calibration_page.CalibrationView`."""
        if view == self._view:
            return
        self._view = view
        self.title.show_text(view.pad or NO_PAD)
        self.progress.show_text('{} of {}'.format(view.step, view.steps) if view.step else '',
                                theme.MUTED)
        for label, text in ((self.prompt, view.prompt), (self.problem, view.problem)):
            if label.text() != text:
                label.setText(text)
        self.problem_sign.show_sign((theme.TRIANGLE, theme.ATTENTION) if view.problem else None)
        self._show_buttons(view)
        self.picture.show_pad(view.axes, view.buttons, view.axis_words, view.button_words)

    def _show_buttons(self, view):
        """Say what can be pressed; the keyboard stays with the large button, so Enter is it."""
        held = self.action_button.hasFocus() or self.again_button.hasFocus()
        self.action_button.setText(view.action)
        self.action_button.setEnabled(bool(view.action))
        self.again_button.setEnabled(view.can_restart)
        if view.action and (held or self.hasFocus()):
            self.action_button.setFocus()
        elif held:
            # Disabled, a button gives the focus to whatever comes next, which Enter would press.
            self.setFocus()

    def showEvent(self, event):  # noqa: N802
        """Tell that it is on show, and take the keyboard for Enter."""
        super().showEvent(event)
        self.shown.emit(True)
        (self.action_button if self.action_button.isEnabled() else self).setFocus()

    def hideEvent(self, event):  # noqa: N802
        """Tell that it is not."""
        super().hideEvent(event)
        self.shown.emit(False)

    def keyPressEvent(self, event):  # noqa: N802
        """Take Enter while nothing has to be pressed: it must not drive a robot."""
        if event.key() not in (Qt.Key_Return, Qt.Key_Enter):
            super().keyPressEvent(event)
