# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An optional note on a mark, entered above the foot of the screen."""
from python_qt_binding.QtCore import Qt, QTimer, Signal
from python_qt_binding.QtWidgets import QBoxLayout, QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.controls import Button, FittingButton, LineField

# Closes by itself if nothing is typed for this long [ms].
SHOWN_MS = 20000
LONGEST = 500


class AskedMark:
    """A requested mark: its name ('' until known) and the note waiting for it."""

    def __init__(self):
        self.name = self.text = ''
        self.refused = False


def note_button(parent):
    """Return the button of the foot that does what key N does."""
    button = theme.for_fingers(FittingButton(parent), 'mark_button', 'Mark this moment',
                               'keeps this moment, with a note if you type one')
    button.set_icon('flag').show_texts('Note (N)', '')
    return button


class NoteBar(QWidget):
    """A line to type a note, hidden until needed; Return saves it, Escape discards it."""

    #: (name of the mark, note)
    noted = Signal(str, str)
    #: note on a mark that was refused
    unmarked = Signal(str)
    #: closed while it had the keyboard focus
    left = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._mark = AskedMark()
        self._problem = ''
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.edit = LineField(
            self, objectName='note_edit', accessibleName='Note to the mark', maxLength=LONGEST,
            toolTip='Return keeps what you type, Esc leaves the mark without words')
        self.keep_button = theme.for_fingers(Button('Keep', self), 'note_button')
        self.edit.setMinimumHeight(theme.touch_size(self))
        row = self._row = QBoxLayout(QBoxLayout.LeftToRight, self)
        row.setContentsMargins(2, 0, 2, 0)
        row.addWidget(self.edit, 1)
        row.addWidget(self.keep_button)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self._timer = QTimer(self, singleShot=True, interval=SHOWN_MS, timeout=self._leave)
        self.hide()

    def _connect(self):
        """Wire the parts."""
        self.edit.returnPressed.connect(self._keep)
        self.edit.textEdited.connect(lambda _: self._timer.stop())
        self.keep_button.clicked.connect(self._keep)

    @property
    def has_keyboard(self):
        """Whether it has the keyboard focus."""
        return self.edit.hasFocus() or self.keep_button.hasFocus()

    def ask(self, take_keyboard):
        """Ask for a note on a pending mark; a half-typed one is saved with the previous mark.

        :param take_keyboard: take the focus at once, so that keys typed from now on are words and
            no commands; else after N, a click or F6
        :returns: handle for :meth:`settle`
        """
        self._finish()
        self._mark, self._problem = AskedMark(), ''
        self.show()
        self._timer.start()
        if take_keyboard:
            self.take_keyboard()
        else:
            self._show_words()
        return self._mark

    def settle(self, mark, name, problem=''):
        """Handle the name of a mark, or the reason for its refusal; the note is kept either way."""
        mark.name, mark.refused = name, not name
        if mark.text:
            self._emit_note(mark, mark.text)
        if mark is self._mark:
            self._problem = problem
            self._show_words()

    def take_keyboard(self):
        """Take the keyboard focus, and keep it: keys typed after it closed would be commands."""
        self._timer.stop()
        self.edit.setFocus(Qt.OtherFocusReason)
        self._show_words()

    def show_narrow(self, narrow):
        """Put the button below the field if narrow, else beside it."""
        self._row.setDirection(QBoxLayout.TopToBottom if narrow else QBoxLayout.LeftToRight)

    def _show_words(self):
        """Show the longest placeholder that fits the field."""
        saved = 'Mark {} saved. '.format(self._mark.name[1:]) if self._mark.name else ''
        texts = ('Add a note?',) if self.has_keyboard else (
            'N again, or a click, to add a note', 'N again to add a note')
        metrics = self.edit.fontMetrics()
        self.edit.setPlaceholderText(self._problem or theme.fitting_text(
            metrics, (saved + texts[0], *texts), self.edit.width() - metrics.height()))

    def resizeEvent(self, event):  # noqa: N802
        """Fit the placeholder to the width."""
        super().resizeEvent(event)
        self._show_words()

    def _finish(self):
        """Save the text, if there is any."""
        text = self.edit.text().strip()
        if text:
            self._emit_note(self._mark, text)
        self.edit.clear()

    def _emit_note(self, mark, text):
        """Emit a note, now or once its mark has a name."""
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
        """Save the text and close."""
        self._finish()
        self._leave()

    def _leave(self):
        """Close, and give up the keyboard focus."""
        self._timer.stop()
        had_keyboard = self.has_keyboard
        self.hide()
        if had_keyboard:
            self.left.emit()
