# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A line with a sign, a text and two buttons, in place of a dialog."""
from python_qt_binding.QtWidgets import QBoxLayout, QHBoxLayout, QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.labels import Sign, TextLine


class AskingBar(QWidget):
    """Base of the bars that ask for a confirmation."""

    def _build(self, name, *buttons):
        """Make and place the parts; return the buttons.

        :param name: object name of the text
        :param buttons: arguments of :func:`mhri.base.gui.theme.finger_button` for each
        """
        self._line, self._sign = TextLine(self), Sign(self)
        self._line.setObjectName(name)
        self._sign.show_sign(theme.WARNING)
        row = self._row = QBoxLayout(QBoxLayout.LeftToRight, self)
        row.setContentsMargins(2, 0, 2, 0)
        words_row = QHBoxLayout()
        words_row.addWidget(self._sign)
        words_row.addWidget(self._line, 1)
        row.addLayout(words_row, 1)
        made = [theme.finger_button(self, *words) for words in buttons]
        for button in made:
            row.addWidget(button)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        return made

    def show_narrow(self, narrow):
        """Place the buttons below the text if the width is small."""
        self._row.setDirection(QBoxLayout.TopToBottom if narrow else QBoxLayout.LeftToRight)
