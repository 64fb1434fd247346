# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The placeholder of the tiles while there is no robot: instructions, and a button to look."""
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme
from mhri.base.gui.controls import Button
from mhri.base.gui.labels import plain_label
from mhri.base.gui.layouts import in_column
from mhri.base.text import listed

HEAD = 'No robots yet'
FIRST = 'Switch a robot on, then let mhri look for it.'
LOOK = 'Look for Connected Bots'
ELSE = 'Or type its name in the drawer at the left and press "Add Bot". F2 opens the drawer.'

# At most this many awaited robots are named.
MAX_NAMES = 3


class Invitation(QWidget):
    """Three lines and a large button."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('invitation')
        self.setFont(theme.base_font(self.font()))
        self._labels = [plain_label(self, text, factor, bold=factor > theme.LARGE)
                        for text, factor in (
                            (HEAD, theme.HUGE), (FIRST, theme.HEAD), (ELSE, theme.BODY))]
        self._result = plain_label(self, '', theme.HEAD)
        for label in (*self._labels, self._result):
            label.setAlignment(Qt.AlignCenter)
        self.look_button = theme.for_fingers(Button(LOOK, self), 'invitation_look_button')
        touch = theme.touch_size(self)
        self.look_button.setMinimumHeight(round(1.5 * touch))
        in_column(1, *self._labels[:2], (self.look_button, 0, Qt.AlignHCenter), self._result,
                  self._labels[2], 1, of=self, gap=touch // 2)

    def resizeEvent(self, event):  # noqa: N802
        """Make the text of the button as large as the width allows."""
        super().resizeEvent(event)
        font, touch = theme.base_font(self.font()), theme.touch_size(self)
        for size, space in ((theme.HEAD, 2 * touch), (theme.BODY, touch // 2)):
            self.look_button.setFont(theme.larger(font, size, bold=True))
            width = theme.text_width(self.look_button.font(), LOOK) + space
            if width <= self.width() - touch:
                break
        self.look_button.setMinimumWidth(width)

    def show_awaited(self, names):
        """Name the robots in the list that have not sent anything yet."""
        self._labels[0].setText(
            'Waiting for ' + listed(names, MAX_NAMES) if names else HEAD)

    def show_result(self, text, busy):
        """Show the result of looking for robots; ``busy`` while that runs."""
        self._result.setText(text)
        self.look_button.setEnabled(not busy)
