# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A sign, words and two buttons in a line, where others ask in a dialog."""
from python_qt_binding.QtWidgets import QBoxLayout, QHBoxLayout, QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.labels import Sign, TextLine


class AskingBar(QWidget):
    """What the bars that ask have in common."""

    def _build(self, name, *buttons):
        """Make and place the parts; return the buttons.

        :param name: that of the words
        :param buttons: arguments of :func:`mhri.base.gui.theme.finger_button` for each
        """
        self._line, sign = TextLine(self), Sign(self)
        self._line.setObjectName(name)
        sign.show_sign((theme.TRIANGLE, theme.ATTENTION))
        row = self._row = QBoxLayout(QBoxLayout.LeftToRight, self)
        row.setContentsMargins(2, 0, 2, 0)
        told = QHBoxLayout()
        told.addWidget(sign)
        told.addWidget(self._line, 1)
        row.addLayout(told, 1)
        made = [theme.finger_button(self, *words) for words in buttons]
        for button in made:
            row.addWidget(button)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        return made

    def show_narrow(self, narrow):
        """Have the buttons below the words, where there is little width."""
        self._row.setDirection(QBoxLayout.TopToBottom if narrow else QBoxLayout.LeftToRight)
