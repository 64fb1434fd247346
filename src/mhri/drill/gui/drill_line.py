# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line over the bottom line that says how a drill goes; not there without one."""
from python_qt_binding.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.labels import plain_tip, Sign, TextLine


class DrillLine(QWidget):
    """Its tool tip is what is to be done; its words stand over those of the bottom line."""

    #: height that it needs beside the pictures, in heights of a line of text
    UNITS = 3.5

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self._line = TextLine(self)
        self._sign = Sign(self)
        row = QHBoxLayout(self)
        row.setContentsMargins(2, 2, 2, 2)
        row.addWidget(self._sign)
        row.addWidget(self._line, 1)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)

    def _connect(self):
        """Nothing of it can be used."""

    def _restore(self):
        """Begin without a drill."""
        self.show_drill(())

    def show_wrapped(self, wrapped):
        """Write on as many lines as it needs, or on one."""
        self._line.set_wrapped(wrapped)

    def show_drill(self, texts, about='', silent=False):
        """Show the longest of some texts that fits; none hides the line.

        :param about: what is to be done, a sentence or two
        :param silent: nobody referees it any more
        """
        if texts:
            self._line.show_text(texts[0], theme.TEXT, texts[1:])
            self._sign.show_sign((theme.TRIANGLE, theme.ATTENTION) if silent else None)
            self.setToolTip(plain_tip(about))
        self.setVisible(bool(texts))

    def text(self):
        """Return what it says, whether or not all of it fits."""
        return self._line.text()
