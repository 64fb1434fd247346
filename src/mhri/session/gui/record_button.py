# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One button that records the whole session, and says for how long it has."""
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QPushButton, QSizePolicy

from mhri.base.gui import theme
from mhri.base.gui.labels import plain_tip
from mhri.session.view import button_texts, SessionView, tip_text

_WIDEST = ('not recorded !', 'REC 88:88:88 !')


class RecordButton(QPushButton):
    """Shows a :class:`mhri.session.view.SessionView`; the host hears its clicks."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Keep the room of the longest words: nothing beside it jumps."""
        self.setObjectName('session_button')
        self.setCheckable(True)
        self.setFocusPolicy(Qt.TabFocus)
        self.setAutoDefault(False)
        touch = theme.touch_size(self)
        self.setMinimumHeight(touch)
        self.setMinimumWidth(touch // 2 + max(
            theme.text_width(self.font(), text) for text in _WIDEST))
        self.setSizePolicy(QSizePolicy.Minimum, QSizePolicy.Fixed)

    def _connect(self):
        """Show what is so, not what was clicked."""
        self.clicked.connect(lambda: self.setChecked(self._view.on))

    def _restore(self):
        """Begin with nothing heard."""
        self._view = None
        self.show_session(SessionView())

    def show_session(self, view):
        """Show it; the same again costs nothing."""
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
