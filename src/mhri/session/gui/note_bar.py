# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Asks over the foot of the screen what a mark is about; nobody has to answer."""
from python_qt_binding.QtCore import Qt, QTimer, Signal
from python_qt_binding.QtWidgets import QBoxLayout, QLineEdit, QPushButton, QSizePolicy, QWidget

from mhri.base.gui import theme

# It goes away by itself where nobody types.
SHOWN_MS = 20000
LONGEST = 500


class AskedMark:
    """A mark that was asked for: its name, once it has one, and what is to be noted with it."""

    def __init__(self, name=''):
        self.name = name
        self.text = ''
        self.refused = False


class NoteBar(QWidget):
    """Hidden until it is asked; Return keeps what is typed, Escape leaves the mark as it is."""

    #: the mark's name and what was typed
    noted = Signal(str, str)
    #: what was typed to a mark that was refused
    unmarked = Signal(str)
    #: it had the keyboard, and has gone
    left = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._mark = AskedMark()
        self._problem = ''
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
        row = self._row = QBoxLayout(QBoxLayout.LeftToRight, self)
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

    @property
    def has_keyboard(self):
        """Whether keys are typed here."""
        return self.edit.hasFocus() or self.keep_button.hasFocus()

    def ask(self, mark, take_keyboard):
        """Ask about a mark that has its name, such as "m3".

        What is half typed to the mark before is kept with that one.

        :param take_keyboard: let it be typed at once; else after N, a click or F6
        """
        self._ask(AskedMark(mark), take_keyboard)

    def ask_first(self, take_keyboard):
        """Ask about a mark that is on its way: what is typed by then must not be commands.

        :returns: what :meth:`settle` needs once it is known what has become of the mark
        """
        self._ask(AskedMark(), take_keyboard)
        if take_keyboard:
            # Whoever asked for it may think: words that come later are no commands, either.
            self._timer.stop()
        return self._mark

    def settle(self, mark, name, problem=''):
        """Take in the name of a mark, or why there is none; what was typed is kept either way."""
        mark.name, mark.refused = name, not name
        if mark.text:
            self._tell(mark, mark.text)
        if mark is self._mark:
            self._problem = problem
            self._show_words()

    def take_keyboard(self):
        """Let it be typed from now on."""
        self._timer.stop()
        self.edit.setFocus(Qt.OtherFocusReason)
        self._show_words()

    def show_narrow(self, narrow):
        """Have the button below the field, or beside it."""
        self._row.setDirection(QBoxLayout.TopToBottom if narrow else QBoxLayout.LeftToRight)

    def _ask(self, mark, take_keyboard):
        """Begin anew."""
        self._finish()
        self._mark = mark
        self.show()
        self._timer.start()
        if take_keyboard:
            self.edit.setFocus(Qt.OtherFocusReason)
        self._problem = ''
        self._show_words()

    def _show_words(self):
        """Ask in the field, in as many words as it has room for."""
        saved = 'Mark {} saved. '.format(self._mark.name[1:]) if self._mark.name else ''
        texts = ('Add a note?',) if self.has_keyboard else (
            'N again, or a click, to add a note', 'N again to add a note')
        metrics = self.edit.fontMetrics()
        self.edit.setPlaceholderText(self._problem or theme.fitting_text(
            metrics, (saved + texts[0], *texts), self.edit.width() - metrics.height()))

    def resizeEvent(self, event):  # noqa: N802
        """Fit the width."""
        super().resizeEvent(event)
        self._show_words()

    def _finish(self):
        """Keep what is typed, if anything is."""
        text = self.edit.text().strip()
        if text:
            self._tell(self._mark, text)
        self.edit.clear()

    def _tell(self, mark, text):
        """Tell of a note, now or once its mark has a name."""
        if mark.name:
            self.noted.emit(mark.name, text)
        elif mark.refused:
            self.unmarked.emit(text)
        else:
            mark.text = text

    def keyPressEvent(self, event):  # noqa: N802
        """Close with Escape."""
        if event.key() == Qt.Key_Escape:
            self.edit.clear()
            self._leave()
        else:
            super().keyPressEvent(event)

    def _keep(self):
        """Keep what is typed, and go."""
        self._finish()
        self._leave()

    def _leave(self):
        """Go, and give the keyboard back."""
        self._timer.stop()
        had_keyboard = self.has_keyboard
        self.hide()
        if had_keyboard:
            self.left.emit()
