# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one line at the bottom that says what matters now."""
from python_qt_binding.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.labels import Sign, TextLine

_SIGNS = {'calm': None, 'attention': (theme.TRIANGLE, theme.ATTENTION),
          'stopped': (theme.OCTAGON, theme.STOP)}
_BETWEEN = '  \u2013  '


class StatusLine(QWidget):
    """A sentence and, where it asks for attention, a shape in front of it."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._sign = Sign(self)
        self._line = TextLine(self)
        self._line.setObjectName('status_label')
        row = QHBoxLayout(self)
        row.setContentsMargins(2, 2, 2, 2)
        row.addWidget(self._sign)
        row.addWidget(self._line, 1)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)

    def show_wrapped(self, wrapped):
        """Write the sentence on as many lines as it needs, or on one."""
        self._line.set_wrapped(wrapped)

    def show_status(self, text, level):
        """Show a sentence; the level is 'calm', 'attention' or 'stopped'."""
        self._sign.show_sign(_SIGNS[level])
        parts = text.split(_BETWEEN)
        # Who drives by what can be seen elsewhere: what happens comes last and stays longest.
        self._line.show_text(text, shorter=(
            *(_BETWEEN.join(parts[begin:]) for begin in range(1, len(parts))),
            *words.beginnings(text, ('; ', ': check ', ': look '))))
