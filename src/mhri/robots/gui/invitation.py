# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What stands where pictures will be while there is no robot: what to do, and a button for it."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from mhri.base.gui import theme

HEAD = 'No robots yet'
FIRST = 'Switch a robot on, then let mhri look for it.'
LOOK = 'Look for Connected Bots'
ELSE = 'Or type its name in the panel at the left and press "Add Bot". F2 opens the panel.'

# How many robots that are awaited have their names said.
MOST_NAMES = 3


class Invitation(QWidget):
    """Three lines and a large button."""

    #: the button was pressed
    look_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('invitation')
        font = theme.base_font(self.font())
        self._labels = [QLabel(text, self) for text in (HEAD, FIRST, ELSE)]
        for label, factor in zip(self._labels, (2.0, 1.2, 1.0)):
            label.setFont(theme.larger(font, factor, bold=factor > 1.5))
            label.setAlignment(Qt.AlignCenter)
            label.setWordWrap(True)
            label.setTextFormat(Qt.PlainText)
        self._result = QLabel(self)
        self._result.setFont(theme.larger(font, 1.1))
        self._result.setAlignment(Qt.AlignCenter)
        self._result.setWordWrap(True)
        self._result.setTextFormat(Qt.PlainText)
        self.look_button = QPushButton(LOOK, self)
        self.look_button.setObjectName('invitation_look_button')
        self.look_button.setFocusPolicy(Qt.TabFocus)
        touch = theme.touch_size(self)
        self.look_button.setMinimumHeight(round(1.5 * touch))
        column = QVBoxLayout(self)
        column.setSpacing(touch // 2)
        column.addStretch(1)
        for widget in self._labels[:2]:
            column.addWidget(widget)
        column.addWidget(self.look_button, 0, Qt.AlignHCenter)
        column.addWidget(self._result)
        column.addWidget(self._labels[2])
        column.addStretch(1)

    def resizeEvent(self, event):  # noqa: N802
        """Write the button as large as the width allows."""
        super().resizeEvent(event)
        font, touch = theme.base_font(self.font()), theme.touch_size(self)
        for size, space in ((1.2, 2 * touch), (1.0, touch // 2)):
            self.look_button.setFont(theme.larger(font, size, bold=True))
            width = theme.text_width(self.look_button.font(), LOOK) + space
            if width <= self.width() - touch:
                break
        self.look_button.setMinimumWidth(width)

    def show_awaited(self, names):
        """Say which robots are in the list and have not been heard yet."""
        self._labels[0].setText('Waiting for {}'.format(', '.join(names[:MOST_NAMES]) + (
            ' and {} more'.format(len(names) - MOST_NAMES) if len(names) > MOST_NAMES else '')
        ) if names else HEAD)

    def show_result(self, text, busy):
        """Say what came of looking; ``busy`` while it looks."""
        self._result.setText(text)
        self.look_button.setEnabled(not busy)

    def _connect(self):
        """Wire the button."""
        self.look_button.clicked.connect(self.look_requested)
