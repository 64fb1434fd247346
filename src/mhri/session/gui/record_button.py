# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The button that records the session, with the duration of the recording."""
from python_qt_binding.QtWidgets import QSizePolicy

from mhri.base.gui import theme
from mhri.base.gui.controls import Button
from mhri.base.gui.labels import plain_tip
from mhri.session.view import button_texts, SessionView, tip_text

_WIDEST = ('not recorded !', 'REC 88:88:88 !')


class RecordButton(Button):
    """Shows a :class:`mhri.session.view.SessionView`; the presenter handles its clicks."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Reserve the width of the longest text, so that nothing beside it moves."""
        theme.for_fingers(self, 'session_button')
        self.setCheckable(True)
        self.setMinimumWidth(theme.touch_size(self) // 2 + max(
            theme.text_width(self.font(), text) for text in _WIDEST))
        self.setSizePolicy(QSizePolicy.Minimum, QSizePolicy.Fixed)

    def _connect(self):
        """Show the actual state, not the click."""
        self.clicked.connect(lambda: self.setChecked(self._view.on))

    def _restore(self):
        """Start without a state."""
        self._view = None
        self.show_session(SessionView())

    def show_session(self, view):
        """Show a view; return early if unchanged."""
        if view == self._view:
            return
        self._view = view
        self.setChecked(view.on)
        text, = button_texts(view)
        if text != self.text():
            self.setText(text)
        tip = plain_tip(tip_text(view))
        if tip != self.toolTip():
            self.setToolTip(tip)
