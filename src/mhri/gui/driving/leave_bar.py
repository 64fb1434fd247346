# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Asks over the foot of the screen, and never in a dialog, whether it is to be closed."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QBoxLayout, QHBoxLayout, QPushButton, QSizePolicy, QWidget

from mhri.gui.screen import theme, words
from mhri.gui.screen.labels import Sign, TextLine


class LeaveBar(QWidget):
    """Hidden until :meth:`ask`; "Stay" has the keyboard then, so that Return closes nothing."""

    close_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self._sign, self._line = Sign(self), TextLine(self)
        self._sign.show_sign((theme.TRIANGLE, theme.ATTENTION))
        self._line.setObjectName('leave_label')
        self._line.set_wrapped(True)
        self.close_button = self._button('leave_button', 'Close')
        self.stay_button = self._button('stay_button', 'Stay')
        row = self._row = QBoxLayout(QBoxLayout.LeftToRight, self)
        row.setContentsMargins(2, 0, 2, 0)
        told = QHBoxLayout()
        told.addWidget(self._sign)
        told.addWidget(self._line, 1)
        row.addLayout(told, 1)
        row.addWidget(self.close_button)
        row.addWidget(self.stay_button)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self.hide()

    def show_narrow(self, narrow):
        """Have the buttons below the words, where there is little width."""
        self._row.setDirection(QBoxLayout.TopToBottom if narrow else QBoxLayout.LeftToRight)

    def _button(self, name, text):
        """Make a button for fingers."""
        button = QPushButton(text, self)
        button.setObjectName(name)
        button.setFocusPolicy(Qt.TabFocus)
        side = theme.touch_size(self)
        button.setMinimumSize(theme.text_width(button.font(), text) + side, side)
        return button

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
