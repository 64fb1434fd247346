# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Asks over the foot of the screen what a mark is about; nobody has to answer."""
from python_qt_binding.QtCore import Qt, QTimer, Signal
from python_qt_binding.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QSizePolicy, QWidget

from mhri.gui.screen import theme

# It goes away by itself where nobody types.
SHOWN_MS = 20000
LONGEST = 500


class NoteBar(QWidget):
    """Hidden until :meth:`ask`; Return keeps what is typed, Escape leaves the mark as it is."""

    #: the mark's name and what was typed
    noted = Signal(str, str)
    #: it had the keyboard, and has gone
    left = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._mark = ''
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.edit = QLineEdit(self)
        self.edit.setObjectName('note_edit')
        self.edit.setMaxLength(LONGEST)
        self.edit.setAccessibleName('Note to the mark')
        self.edit.setToolTip('Return keeps what you type, Esc leaves the mark without words')
        self.keep_button = QPushButton('Keep', self)
        self.keep_button.setObjectName('note_button')
        self.keep_button.setFocusPolicy(Qt.TabFocus)
        side = theme.touch_size(self)
        for part in (self.edit, self.keep_button):
            part.setMinimumHeight(side)
        row = QHBoxLayout(self)
        row.setContentsMargins(2, 0, 2, 0)
        row.addWidget(self.edit, 1)
        row.addWidget(self.keep_button)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(SHOWN_MS)
        self.hide()

    def _connect(self):
        """Wire the parts."""
        self.edit.returnPressed.connect(self._keep)
        self.edit.textEdited.connect(lambda _: self._timer.stop())
        self.keep_button.clicked.connect(self._keep)
        self._timer.timeout.connect(self._leave)

    def ask(self, mark, take_keyboard):
        """Ask about a mark, such as "m3".

        What is half typed to the mark before is kept with that one.

        :param take_keyboard: let it be typed at once; else after a click or F6
        """
        if self.edit.text().strip():
            self.noted.emit(self._mark, self.edit.text().strip())
        self._mark = mark
        self.edit.clear()
        self.edit.setPlaceholderText('mark {} kept: what is here?'.format(mark[1:]))
        self.show()
        self._timer.start()
        if take_keyboard:
            self.edit.setFocus(Qt.OtherFocusReason)

    def keyPressEvent(self, event):  # noqa: N802
        """Close with Escape."""
        if event.key() == Qt.Key_Escape:
            self.edit.clear()
            self._leave()
        else:
            super().keyPressEvent(event)

    def _keep(self):
        """Keep what is typed, if anything is."""
        text = self.edit.text().strip()
        if text:
            self.noted.emit(self._mark, text)
        self.edit.clear()
        self._leave()

    def _leave(self):
        """Go, and give the keyboard back."""
        self._timer.stop()
        had_keyboard = self.edit.hasFocus() or self.keep_button.hasFocus()
        self.hide()
        if had_keyboard:
            self.left.emit()
