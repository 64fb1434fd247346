# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line over the bottom line that says how a drill goes; not there without one."""
from mhri.gui.screen import theme
from mhri.gui.screen.labels import plain_tip, TextLine


class DrillLine(TextLine):
    """Its tool tip is what is to be done."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._about = ''
        self.hide()

    def show_drill(self, texts, about=''):
        """Show the longest of some texts that fits; none hides the line.

        :param about: what is to be done, a sentence or two
        """
        self._about = about
        if texts:
            self.show_text(texts[0], theme.TEXT, texts[1:])
        self.setVisible(bool(texts))

    def _hint(self):
        return plain_tip(self._about)
